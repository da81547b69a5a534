/* Rays through Embree 4: single and in packets of 8 and 16, without and with the flag for coherent rays. See embree_rays.py.
 *
 *     embree_rays TRIANGLES RAYS ANY_HIT REPEAT THREADS [HITS]
 *
 * Each thread traces an equal run of neighbouring rays.
 *
 * Prints JSON; times are the least of the repeats. HITS gets (t, primitive, u, v) of each ray as f32, primitive -1 for none.
 * The declarations are those parts of rtcore.h of version 4.4 that are used, since the package brings no headers. */
#define _GNU_SOURCE
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct RTCDeviceTy *RTCDevice;
typedef struct RTCSceneTy *RTCScene;
typedef struct RTCGeometryTy *RTCGeometry;
enum { TRIANGLES = 0, INDEX = 0, VERTEX = 1, UINT3 = 0x5003, FLOAT3 = 0x9003, COHERENT = 1 << 16 };
typedef struct {
    unsigned flags, features;
    void *context, *filter, *trace;
    float min_width;
} Arguments;

RTCDevice rtcNewDevice(const char *);
RTCScene rtcNewScene(RTCDevice);
RTCGeometry rtcNewGeometry(RTCDevice, int);
void *rtcSetNewGeometryBuffer(RTCGeometry, int type, unsigned slot, int format, size_t stride, size_t count);
void rtcCommitGeometry(RTCGeometry);
unsigned rtcAttachGeometry(RTCScene, RTCGeometry);
void rtcCommitScene(RTCScene);
void rtcReleaseScene(RTCScene);
int rtcGetDeviceError(RTCDevice);
void rtcIntersect1(RTCScene, void *, Arguments *);
void rtcOccluded1(RTCScene, void *, Arguments *);
void rtcIntersect8(const int *, RTCScene, void *, Arguments *);
void rtcOccluded8(const int *, RTCScene, void *, Arguments *);
void rtcIntersect16(const int *, RTCScene, void *, Arguments *);
void rtcOccluded16(const int *, RTCScene, void *, Arguments *);

/* What a thread works on. */
static __thread const float *rays;
static __thread size_t ray_count;
static __thread float *kept;
static int any_hit;

static void keep(size_t i, float t, unsigned primitive, float u, float v) {
    if (kept)
        memcpy(kept + 4 * i, (float[4]){t, primitive == ~0u ? -1.0f : (float)primitive, u, v}, 16);
}

/* One function for each width N: loads N rays, traces them, counts hits. */
#define TRACE(N, INTERSECT, OCCLUDED)                                                                                              \
    static size_t trace##N(RTCScene scene, Arguments *arguments) {                                                                 \
        struct __attribute__((aligned(64))) {                                                                                      \
            float ox[N], oy[N], oz[N], tnear[N], dx[N], dy[N], dz[N], time[N], tfar[N];                                            \
            unsigned mask[N], id[N], flags[N];                                                                                     \
            float ngx[N], ngy[N], ngz[N], u[N], v[N];                                                                              \
            unsigned primitive[N], geometry[N], instance[N], instance_primitive[N], padding[N];                                    \
        } r;                                                                                                                       \
        int valid[N] __attribute__((aligned(64)));                                                                                 \
        size_t hits = 0;                                                                                                           \
        for (size_t i = 0; i < ray_count; i += N) {                                                                                \
            for (int k = 0; k < N; k++) {                                                                                          \
                size_t j = i + k < ray_count ? i + k : ray_count - 1;                                                              \
                const float *q = rays + 8 * j;                                                                                     \
                valid[k] = i + k < ray_count ? -1 : 0;                                                                             \
                r.ox[k] = q[0], r.oy[k] = q[1], r.oz[k] = q[2], r.dx[k] = q[3], r.dy[k] = q[4], r.dz[k] = q[5];                    \
                r.tnear[k] = q[6], r.tfar[k] = q[7], r.time[k] = 0, r.mask[k] = ~0u, r.id[k] = 0, r.flags[k] = 0;                  \
                r.geometry[k] = r.instance[k] = r.instance_primitive[k] = r.primitive[k] = ~0u;                                    \
            }                                                                                                                      \
            if (any_hit) {                                                                                                         \
                OCCLUDED;                                                                                                          \
            } else {                                                                                                               \
                INTERSECT;                                                                                                         \
            }                                                                                                                      \
            for (int k = 0; k < N; k++) {                                                                                          \
                if (!valid[k])                                                                                                     \
                    continue;                                                                                                      \
                hits += any_hit ? r.tfar[k] < 0 : r.geometry[k] != ~0u;                                                            \
                keep(i + k, r.tfar[k], r.geometry[k] == ~0u ? ~0u : r.primitive[k], r.u[k], r.v[k]);                               \
            }                                                                                                                      \
        }                                                                                                                          \
        return hits;                                                                                                               \
    }
TRACE(1, rtcIntersect1(scene, &r, arguments), rtcOccluded1(scene, &r, arguments))
TRACE(8, rtcIntersect8(valid, scene, &r, arguments), rtcOccluded8(valid, scene, &r, arguments))
TRACE(16, rtcIntersect16(valid, scene, &r, arguments), rtcOccluded16(valid, scene, &r, arguments))

typedef struct {
    pthread_t thread;
    const float *rays;
    size_t count, hits;
    float *kept;
    size_t (*trace)(RTCScene, Arguments *);
    RTCScene scene;
    Arguments *how;
} Share;

static void *work(void *given) {
    Share *share = given;
    rays = share->rays, ray_count = share->count, kept = share->kept;
    share->hits = share->trace(share->scene, share->how);
    return NULL;
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + t.tv_nsec * 1e-9;
}

static float *read_floats(const char *path, size_t *count) {
    FILE *file = fopen(path, "rb");
    if (!file || fseek(file, 0, SEEK_END))
        exit(1);
    *count = ftell(file) / 4;
    rewind(file);
    float *numbers = malloc(*count * 4);
    if (fread(numbers, 4, *count, file) != *count)
        exit(1);
    fclose(file);
    return numbers;
}

int main(int count, char **arguments) {
    size_t triangle_count;
    float *triangles = read_floats(arguments[1], &triangle_count);
    triangle_count /= 9;
    size_t total;
    const float *all = read_floats(arguments[2], &total);
    total /= 8;
    any_hit = atoi(arguments[3]);
    int repeat = atoi(arguments[4]), threads = atoi(arguments[5]);
    float *hits_of_all = count > 6 && *arguments[6] ? malloc(16 * total) : NULL;
    Share *shares = malloc(threads * sizeof(Share));

    char configuration[64];
    snprintf(configuration, sizeof configuration, "threads=%d,set_affinity=0", threads);
    RTCDevice device = rtcNewDevice(configuration);
    RTCScene scene = NULL;
    double build = 1e9;
    for (int k = 0; k < repeat; k++) {
        if (scene)
            rtcReleaseScene(scene);
        scene = rtcNewScene(device);
        RTCGeometry geometry = rtcNewGeometry(device, TRIANGLES);
        float *vertices = rtcSetNewGeometryBuffer(geometry, VERTEX, 0, FLOAT3, 12, triangle_count * 3);
        unsigned *indices = rtcSetNewGeometryBuffer(geometry, INDEX, 0, UINT3, 12, triangle_count);
        memcpy(vertices, triangles, triangle_count * 36);
        for (size_t i = 0; i < triangle_count * 3; i++)
            indices[i] = i;
        double start = now();
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene, geometry);
        rtcCommitScene(scene);
        double seconds = now() - start;
        build = seconds < build ? seconds : build;
    }

    size_t (*const trace[3])(RTCScene, Arguments *) = {trace1, trace8, trace16};
    const int width[3] = {1, 8, 16};
    printf("{\"build_ms\": %f, \"modes\": [", build * 1e3);
    for (int mode = 0; mode < 6; mode++) {
        Arguments how = {mode / 3 ? COHERENT : 0, ~0u, NULL, NULL, NULL, 0};
        double least = 1e9;
        size_t hits = 0;
        for (int k = 0; k < repeat; k++) {
            double start = now();
            hits = 0;
            for (int i = 0; i < threads; i++) {
                size_t first = total * i / threads, end = total * (i + 1) / threads;
                shares[i] = (Share){.rays = all + 8 * first, .count = end - first, .kept = hits_of_all ? hits_of_all + 4 * first : NULL,
                                    .trace = trace[mode % 3], .scene = scene, .how = &how};
                if (i && pthread_create(&shares[i].thread, NULL, work, &shares[i]))
                    return 1;
            }
            work(&shares[0]);
            for (int i = 0; i < threads; i++) {
                if (i)
                    pthread_join(shares[i].thread, NULL);
                hits += shares[i].hits;
            }
            double seconds = now() - start;
            least = seconds < least ? seconds : least;
        }
        printf("%s{\"width\": %d, \"coherent\": %s, \"mrays_per_s\": %f, \"hits\": %zu}", mode ? ", " : "", width[mode % 3],
               mode / 3 ? "true" : "false", total / least / 1e6, hits);
    }
    printf("]}\n");
    if (hits_of_all) {
        FILE *file = fopen(arguments[6], "wb");
        if (!file || fwrite(hits_of_all, 16, total, file) != total || fclose(file))
            return 1;
    }
    return rtcGetDeviceError(device) != 0;
}
