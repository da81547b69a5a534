#!/usr/bin/env python3
"""Traces the same triangles and rays with Kajo and with every mode of Embree 4, in turns.

Embree comes inside the PyPI package `embreex`; a small C program (embree_rays.c) calls it with single rays and with packets of 8 and 16, each
without and with the flag for coherent rays, and needs the compiler `cc`. Without files of rays it makes its own, of a terrain or of a glTF file without
compressed meshes: camera rays, one ray in a cosine distribution from each hit, and one shadow ray from each hit to a point of light.

    python3 -m venv venv && venv/bin/pip install embreex numpy pillow
    venv/bin/python bench/peers/embree_rays.py --kajo target/release/kajo [--threads N]
        [--triangles T --rays R [--any-hit] | --cells N | --gltf FILE --eye X Y Z --target X Y Z --light X Y Z]

Prints Mrays/s of each and Kajo's ratio to Embree's single rays and to its best mode. Exit code 1 if the counts of hits differ by more than one in
ten thousand (Embree's default mode is not watertight).
"""

import argparse
import importlib.util
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from gltf import Gltf

SIDE = 512


def terrain(cells=400):
    """Two triangles a cell of a bumpy square of 2 x 2."""
    x = np.linspace(-1, 1, cells + 1)
    gx, gy = np.meshgrid(x, x, indexing="ij")
    height = 0.1 * np.sin(7 * gx) * np.cos(5 * gy) + 0.02 * np.sin(41 * gx + 3 * gy) * np.sin(37 * gy)
    points = np.stack([gx, height, gy], -1)
    a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
    return np.concatenate([np.stack([a, b, c], 2), np.stack([a, c, d], 2)]).reshape(-1, 9).astype("<f4")


def placed(path):
    """The triangles of a glTF file, in metres of the world."""
    return np.concatenate([positions[indices] for indices, positions, *_ in Gltf(path).primitives()]).reshape(-1, 9).astype("<f4")


def camera_rays(eye, target):
    """Rays of a perspective camera, row by row."""
    eye = np.array(eye)
    forward = np.array(target) - eye
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0, 1, 0])
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    s = (np.arange(SIDE) + 0.5) / SIDE - 0.5
    direction = forward + 0.9 * (s[None, :, None] * right - s[:, None, None] * up)
    direction /= np.linalg.norm(direction, axis=-1, keepdims=True)
    return rays(np.broadcast_to(eye, direction.shape), direction, 0.0, 1e30)


def rays(origin, direction, t_min, t_max):
    bounds = np.broadcast_to([t_min, t_max], (*direction.shape[:-1], 2))
    return np.concatenate([origin, direction, bounds], -1).reshape(-1, 8).astype("<f4")


def secondary_rays(distance, normal, primary, light):
    """From each hit: one ray in a cosine distribution, and one to the point `light`."""
    rng = np.random.default_rng(1)
    hit = np.isfinite(distance)
    origin = (primary[:, :3] + distance[:, None] * primary[:, 3:6])[hit].astype("f8")
    n = normal[hit]
    n *= np.where((n * primary[hit, 3:6]).sum(-1) > 0, -1, 1)[:, None]
    sphere = rng.normal(size=n.shape)
    sphere /= np.linalg.norm(sphere, axis=-1, keepdims=True)
    start = origin + 1e-4 * distance[hit, None] * n
    diffuse = n + 0.999 * sphere
    diffuse /= np.linalg.norm(diffuse, axis=-1, keepdims=True)
    return rays(start, diffuse, 0.0, 1e30), rays(start, np.array(light) - start, 0.0, 1.0)


def build_embree(folder):
    """The C program, linked with the library of the package."""
    package = pathlib.Path(importlib.util.find_spec("embreex").origin).parent.parent
    library = next(iter(sorted((package / "embreex.libs").glob("libembree4*"))))
    source = pathlib.Path(__file__).with_name("embree_rays.c")
    program = pathlib.Path(folder, "embree_rays")
    paths = [f"-Wl,-rpath,{library.parent}", f"-Wl,-rpath-link,{library.parent}", "-pthread"]
    subprocess.run(["cc", "-O2", "-march=native", str(source), "-o", str(program), str(library), *paths], check=True)
    return program


def embree(program, triangles, rays_file, any_hit, repeat, threads, hits=""):
    """`{(width, coherent): (Mrays/s, hits)}`."""
    command = [program, triangles, rays_file, str(int(any_hit)), str(repeat), str(threads), str(hits)]
    out = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return {(mode["width"], mode["coherent"]): (mode["mrays_per_s"], mode["hits"]) for mode in out["modes"]}, out["build_ms"]


def kajo(arguments, triangles, rays_file, any_hit, alone):
    flags = (["--any-hit"] if any_hit else []) + (["--one-at-a-time"] if alone else [])
    numbers = ["--threads", str(arguments.threads), "--repeat", str(arguments.repeat)]
    base = [arguments.kajo, "bench", "rays", "--triangles", triangles, "--rays", rays_file, *numbers, "--json"]
    return json.loads(subprocess.run([*base, *flags], check=True, capture_output=True, text=True).stdout)


def compare(name, program, arguments, triangles, rays_file, any_hit):
    best, modes, builds = {}, {}, []
    for _ in range(arguments.turns):
        for alone in (True, False):
            report = kajo(arguments, triangles, rays_file, any_hit, alone)
            best[alone] = max(best.get(alone, 0), report["mrays_per_s"])
            builds.append(report["build_ms"])
        found, embree_build = embree(program, triangles, rays_file, any_hit, arguments.repeat, arguments.threads)
        modes = {mode: (max(rate, modes.get(mode, (0, 0))[0]), hits) for mode, (rate, hits) in found.items()}
    single = modes[1, False][0]
    fastest = max(modes, key=lambda mode: modes[mode][0])
    print(f"\n{name}: {report['rays']} rays, {report['triangles']} triangles; build {min(builds):.1f} ms, Embree {embree_build:.1f} ms")
    for (width, coherent), (rate, _) in sorted(modes.items()):
        print(f"  Embree, {width:2} at a time{', coherent' if coherent else '':10} {rate:8.2f} Mrays/s")
    print(f"  Kajo, one at a time           {best[True]:8.2f} Mrays/s   {best[True] / single:.2f} x Embree's single rays")
    print(f"  Kajo, many at once            {best[False]:8.2f} Mrays/s   {best[False] / modes[fastest][0]:.2f} x Embree's best mode")
    return abs(report["hits"] - modes[1, False][1]) <= 1e-4 * report["rays"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kajo", default="kajo")
    parser.add_argument("--triangles")
    parser.add_argument("--rays")
    parser.add_argument("--any-hit", action="store_true")
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--cells", type=int, default=400, help="cells along a side of the terrain; 1000 make two million triangles")
    parser.add_argument("--gltf", help="a scene in the place of the terrain")
    parser.add_argument("--eye", type=float, nargs=3, default=[1.3, 0.9, 1.5])
    parser.add_argument("--target", type=float, nargs=3, default=[0.0, 0.0, 0.0])
    parser.add_argument("--light", type=float, nargs=3, default=[0.5, 1.2, -0.7])
    parser.add_argument("--threads", type=int, default=1)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        program = build_embree(folder)
        if arguments.triangles and arguments.rays:
            agree = compare("given rays", program, arguments, arguments.triangles, arguments.rays, arguments.any_hit)
            sys.exit(0 if agree else 1)
        path = {name: pathlib.Path(folder, name) for name in ("triangles", "camera", "diffuse", "shadow", "hits")}
        triangles = placed(arguments.gltf) if arguments.gltf else terrain(arguments.cells)
        camera = camera_rays(arguments.eye, arguments.target)
        triangles.tofile(path["triangles"])
        camera.tofile(path["camera"])
        embree(program, path["triangles"], path["camera"], False, 1, 1, path["hits"])
        hits = np.fromfile(path["hits"], "<f4").reshape(-1, 4)
        corners = triangles.reshape(-1, 3, 3).astype("f8")
        distance = np.where(hits[:, 1] >= 0, hits[:, 0], np.inf)
        diffuse, shadow = secondary_rays(distance, normals(corners, hits[:, 1]), camera, arguments.light)
        diffuse.tofile(path["diffuse"])
        shadow.tofile(path["shadow"])
        agree = [compare(name, program, arguments, path["triangles"], path[name], name == "shadow") for name in ("camera", "diffuse", "shadow")]
        sys.exit(0 if all(agree) else 1)


def normals(corners, primitive):
    a, b, c = (corners[np.maximum(primitive, 0).astype(int), i] for i in range(3))
    n = np.cross(b - a, c - a)
    return n / np.linalg.norm(n, axis=-1, keepdims=True)


if __name__ == "__main__":
    main()
