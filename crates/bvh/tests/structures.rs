//! shapes beside triangles, build flags, compaction, updates, limits.

mod common;

use common::*;
use glam::{Affine3A, Quat, Vec3};
use kajo_bvh::triangle::Crossing;
use kajo_bvh::{
    Aabb, Blas, BuildFlags, BuildOptions, BuildQuality, BvhError, BvhInstance, Counters, Features, Filter, Geometry, Limits, Procedural,
    Ray, Tlas, gpu::FlatBvh,
};
use std::sync::Arc;

/// Spheres by centre and radius.
#[derive(Debug)]
struct Spheres(Vec<(Vec3, f32)>);

impl Procedural for Spheres {
    fn count(&self) -> usize {
        self.0.len()
    }

    fn bounds(&self, shape: usize) -> Aabb {
        let (center, radius) = self.0[shape];
        Aabb { min: center - radius, max: center + radius }
    }

    fn intersect(&self, shape: usize, ray: &Ray) -> Option<Crossing> {
        let (center, radius) = self.0[shape];
        sphere_crossings(center, radius, ray).into_iter().find(|&t| t >= ray.t_min && t <= ray.t_max).map(|t| Crossing {
            t,
            u: 0.25,
            v: 0.5,
        })
    }
}

/// Both roots of |o + t d − c| = r, the smaller first; none for a miss. In double precision.
fn sphere_crossings(center: Vec3, radius: f32, ray: &Ray) -> Vec<f32> {
    let (o, d) = ((ray.origin - center).as_dvec3(), ray.direction.as_dvec3());
    let (a, b, c) = (d.length_squared(), o.dot(d), o.length_squared() - f64::from(radius).powi(2));
    let discriminant = b * b - a * c;
    if discriminant < 0.0 {
        return Vec::new();
    }
    [-1.0, 1.0].map(|sign| ((-b + sign * discriminant.sqrt()) / a) as f32).to_vec()
}

/// A few hundred triangles and spheres in one mesh.
fn mixed(seed: u64) -> (TestMesh, Arc<Spheres>) {
    let mut random = Random::new(seed);
    let spheres = (0..200).map(|_| (random.cube(), 0.02 + 0.1 * random.unit())).collect();
    (soup(300, 0.3, seed), Arc::new(Spheres(spheres)))
}

fn build_mixed((mesh, spheres): &(TestMesh, Arc<Spheres>), options: &BuildOptions) -> Result<Blas, BvhError> {
    Blas::build_geometry(&Geometry::triangles(&mesh.positions, &mesh.indices).with_shapes(spheres.clone()), options)
}

#[test]
fn a_triangle_and_a_sphere_of_one_mesh_are_both_hit_where_algebra_puts_them() {
    // A triangle in the plane z = −1 and a unit sphere at the origin, side by side and one behind the other.
    let positions = [Vec3::new(-9.0, -9.0, -1.0), Vec3::new(9.0, -9.0, -1.0), Vec3::new(0.0, 9.0, -1.0)];
    let geometry = Geometry::triangles(&positions, &[[0, 1, 2]]).with_shapes(Arc::new(Spheres(vec![(Vec3::ZERO, 1.0)])));
    for quality in BuildQuality::ALL {
        let tlas = Tlas::single(Blas::build_geometry(&geometry, &BuildOptions::of(quality)).unwrap());
        tlas.validate().unwrap();
        for backend in backends() {
            let tlas = tlas.clone().with_backend(backend);
            let mut seen = [0; 2];
            let rays: Vec<Ray> = (0..256)
                .map(|i| Ray::new(Vec3::new((i % 16) as f32 * 0.2 - 1.5, (i / 16) as f32 * 0.2 - 1.5, 5.0), Vec3::new(0.0, 0.0, -0.5)))
                .collect();
            let mut many = vec![None; rays.len()];
            tlas.closest_hits(&rays, Filter::ALL, |_, _| true, &mut many);
            let mut any = vec![false; rays.len()];
            tlas.any_hits(&rays, Filter::ALL, |_, _| true, &mut any);
            for (i, ray) in rays.iter().enumerate() {
                let r2 = ray.origin.x * ray.origin.x + ray.origin.y * ray.origin.y;
                let expected = if r2 < 1.0 { (1, (5.0 - (1.0 - r2).sqrt()) / 0.5) } else { (0, 6.0 / 0.5) };
                for hit in [tlas.closest_hit_opaque(ray, Filter::ALL), many[i]] {
                    let hit = hit.unwrap();
                    assert_eq!(hit.primitive, expected.0, "{ray:?}");
                    assert!((hit.t - expected.1).abs() < 1e-4, "{hit:?} {expected:?}");
                }
                assert!(any[i] && tlas.any_hit_opaque(ray, Filter::ALL));
                seen[expected.0 as usize] += 1;
            }
            assert!(seen.iter().all(|&n| n > 50), "{seen:?}");
        }
    }
}

#[test]
fn shapes_equal_brute_force_placed_filtered_and_confirmed() {
    let mesh = mixed(1);
    let blas = Arc::new(build_mixed(&mesh, &BuildOptions::default()).unwrap());
    let plain = Arc::new(mesh.0.blas());
    let turn = Affine3A::from_scale_rotation_translation(Vec3::new(1.0, -2.0, 0.5), Quat::from_rotation_y(0.7), Vec3::new(0.5, 0.0, 1.0));
    let instances = vec![
        BvhInstance::new(0, Affine3A::IDENTITY),
        BvhInstance { opaque: false, mask: 2, ..BvhInstance::new(0, turn) },
        BvhInstance::new(1, Affine3A::from_translation(Vec3::X)),
    ];
    let tlas = Tlas::build(vec![blas, plain], instances).unwrap();
    tlas.validate().unwrap();
    let accept = |hit: &kajo_bvh::Hit| !hit.primitive.is_multiple_of(3);
    for backend in backends() {
        let tlas = tlas.clone().with_backend(backend);
        let rays = rays(4_000, 2);
        let mut many = vec![None; rays.len()];
        tlas.closest_hits(&rays, Filter::ALL, |_, hit| accept(hit), &mut many);
        let (mut on_spheres, mut on_triangles) = (0, 0);
        for (ray, many) in rays.iter().zip(many) {
            let expected = tlas.closest_hit_brute_force(ray, Filter::ALL, accept);
            same(expected, tlas.closest_hit(ray, Filter::ALL, accept)).unwrap();
            same(expected, many).unwrap();
            assert_eq!(expected.is_some(), tlas.any_hit(ray, Filter::ALL, accept));
            let Some(hit) = expected else { continue };
            if hit.primitive >= 300 {
                on_spheres += 1
            } else {
                on_triangles += 1
            }
            for filter in [Filter::leaving(&hit), Filter { mask: 2, ..Filter::ALL }] {
                same(tlas.closest_hit_brute_force(ray, filter, accept), tlas.closest_hit(ray, filter, accept)).unwrap();
            }
        }
        assert!(on_spheres > 500 && on_triangles > 500, "{on_spheres} {on_triangles}");
    }
}

#[test]
fn the_interval_of_shapes_is_closed_and_that_of_triangles_open() {
    let positions = [Vec3::new(-9.0, -9.0, -3.0), Vec3::new(9.0, -9.0, -3.0), Vec3::new(0.0, 9.0, -3.0)];
    let geometry = Geometry::triangles(&positions, &[[0, 1, 2]]).with_shapes(Arc::new(Spheres(vec![(Vec3::ZERO, 1.0)])));
    let tlas = Tlas::single(Blas::build_geometry(&geometry, &BuildOptions::default()).unwrap());
    // The sphere is met at t = 4 and 6, the triangle at t = 8.
    let ray = |t_min, t_max| Ray { t_min, t_max, ..Ray::new(Vec3::new(0.0, 0.0, 5.0), Vec3::NEG_Z) };
    let hit = |t_min: f32, t_max: f32| {
        let (one, rays) = (ray(t_min, t_max), [ray(t_min, t_max); 16]);
        let mut many = [None; 16];
        tlas.closest_hits(&rays, Filter::ALL, |_, _| true, &mut many);
        let answer = tlas.closest_hit_opaque(&one, Filter::ALL);
        assert_eq!(answer.is_some(), tlas.any_hit_opaque(&one, Filter::ALL));
        same(answer, many[7]).unwrap();
        same(tlas.closest_hit_brute_force(&one, Filter::ALL, |_| true), answer).unwrap();
        answer.map(|hit| (hit.t, hit.primitive))
    };
    assert_eq!(hit(0.0, 4.0), Some((4.0, 1)));
    assert_eq!(hit(0.0, 4.0f32.next_down()), None);
    assert_eq!(hit(4.0, 9.0), Some((4.0, 1)));
    assert_eq!(hit(4.5, 6.0), Some((6.0, 1)));
    assert_eq!(hit(6.5, 8.0), None);
    assert_eq!(hit(8.0, 9.0), None);
    assert_eq!(hit(6.5, 9.0), Some((8.0, 0)));
}

#[test]
fn boxes_of_shapes_that_are_none_are_refused_and_gpu_arrays_say_what_they_leave_out() {
    for (center, radius) in [(Vec3::ZERO, -1.0), (Vec3::splat(f32::NAN), 1.0), (Vec3::ZERO, f32::INFINITY), (Vec3::X * 2e18, 1.0)] {
        let shapes = Arc::new(Spheres(vec![(Vec3::ONE, 1.0), (center, radius)]));
        let error = Blas::build_geometry(&Geometry::shapes(shapes), &BuildOptions::default()).unwrap_err();
        assert!(matches!(error, BvhError::Shape { shape: 1, .. }), "{error}");
    }
    let mesh = mixed(3);
    let tlas = Tlas::single(build_mixed(&mesh, &BuildOptions::default()).unwrap());
    let flat = FlatBvh::new(&tlas);
    assert_eq!((flat.shapes_left_out, flat.triangles.len()), (200, 300));
    let only = Tlas::single(Blas::build_geometry(&Geometry::shapes(mesh.1.clone()), &BuildOptions::default()).unwrap());
    let flat = FlatBvh::new(&only);
    assert!(flat.is_empty() && flat.shapes_left_out == 200);
    assert!(rays(100, 1).iter().any(|ray| only.closest_hit_opaque(ray, Filter::ALL).is_some()));
}

/// The five flags, one at a time.
fn each_flag() -> [BuildFlags; 5] {
    let none = BuildFlags::default();
    [
        BuildFlags { allow_update: true, ..none },
        BuildFlags { allow_compaction: true, ..none },
        BuildFlags { prefer_fast_trace: true, ..none },
        BuildFlags { prefer_fast_build: true, ..none },
        BuildFlags { low_memory: true, ..none },
    ]
}

#[test]
fn all_32_sets_of_flags_build_or_are_refused_and_give_the_same_hits() {
    let mesh = soup(3_000, 0.15, 4);
    let rays = rays(2_000, 5);
    let expected = Tlas::single(mesh.blas());
    let expected: Vec<_> = rays.iter().map(|ray| expected.closest_hit_opaque(ray, Filter::ALL)).collect();
    for set in 0..32 {
        let bit = |i: u32| set >> i & 1 == 1;
        let flags = BuildFlags {
            allow_update: bit(0),
            allow_compaction: bit(1),
            prefer_fast_trace: bit(2),
            prefer_fast_build: bit(3),
            low_memory: bit(4),
        };
        let options = BuildOptions::try_from(flags);
        if bit(2) && bit(3) {
            assert_eq!(options, Err(BvhError::BothPreferences));
            continue;
        }
        let options = options.unwrap();
        assert_eq!((options.allow_update, options.allow_compaction, options.low_memory), (bit(0), bit(1), bit(4)));
        let quality = [BuildQuality::Balanced, BuildQuality::High, BuildQuality::Fast][set as usize >> 2 & 3];
        assert_eq!(options.quality, quality);
        let blas = Blas::build(&mesh.positions, &mesh.indices, &options).unwrap();
        blas.validate().unwrap_or_else(|fault| panic!("{flags:?}: {fault}"));
        let tlas = Tlas::single(blas);
        for (ray, &expected) in rays.iter().zip(&expected) {
            same(expected, tlas.closest_hit_opaque(ray, Filter::ALL)).unwrap();
        }
    }
}

#[test]
fn fast_trace_costs_rays_no_more_than_fast_build_and_low_memory_takes_less() {
    // Not a subdivided octahedron: for its symmetry the curve's halves are the best there are, by 0.3 %.
    for (name, mesh) in [("soup", soup(20_000, 0.05, 6)), ("torus", torus(60, 150)), ("needles", needles(5_000, 7))] {
        let build = |flags: BuildFlags| {
            let start = std::time::Instant::now();
            let blas = Blas::build(&mesh.positions, &mesh.indices, &flags.try_into().unwrap()).unwrap();
            (blas, start.elapsed())
        };
        let [_, _, fast_trace, fast_build, low_memory] = each_flag().map(build);
        let plain = build(BuildFlags::default());
        for (flags, (blas, time)) in [("none", &plain), ("trace", &fast_trace), ("build", &fast_build), ("memory", &low_memory)] {
            println!("{name}, {flags}: {time:?}, SAH cost {}, {} bytes", blas.sah_cost(1.0), blas.memory());
        }
        assert!(fast_trace.0.sah_cost(1.0) <= fast_build.0.sah_cost(1.0), "{name}");
        assert!(fast_trace.0.sah_cost(1.0) <= 1.005 * plain.0.sah_cost(1.0), "{name}");
        assert!(low_memory.0.memory() < plain.0.memory(), "{name}");
        let short_of_it = build(BuildFlags { low_memory: true, prefer_fast_trace: true, ..BuildFlags::default() });
        assert!(short_of_it.0.memory() < plain.0.memory(), "{name}: triangles are not cut where memory is short");
    }
}

/// Long thin triangles in all directions.
fn needles(count: u32, seed: u64) -> TestMesh {
    let mut random = Random::new(seed);
    let mut mesh = TestMesh::default();
    for i in 0..count {
        let (from, to) = (random.cube(), random.cube());
        mesh.positions.extend([from, to, to + random.cube() * 0.01]);
        mesh.indices.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    mesh
}

#[test]
fn cut_needles_equal_brute_force_and_take_less_work() {
    let mesh = needles(1_500, 8);
    let of = |quality| {
        let blas = Arc::new(Blas::build(&mesh.positions, &mesh.indices, &BuildOptions::of(quality)).unwrap());
        Tlas::build(vec![blas], vec![BvhInstance { opaque: false, ..BvhInstance::new(0, Affine3A::IDENTITY) }]).unwrap()
    };
    let (balanced, high) = (of(BuildQuality::Balanced), of(BuildQuality::High));
    high.validate().unwrap();
    let mut triangles: Vec<u32> = high.blases()[0].triangles().map(|(number, _)| number).collect();
    triangles.sort_unstable();
    assert_eq!(triangles, (0..1_500).collect::<Vec<u32>>());
    assert!(high.memory() > balanced.memory(), "nothing was cut");
    let (mut least, mut most, mut hits) = (Counters::default(), Counters::default(), 0);
    let accept = |hit: &kajo_bvh::Hit| hit.primitive.is_multiple_of(2);
    let rays = rays(4_000, 9);
    let mut many = vec![None; rays.len()];
    high.closest_hits(&rays, Filter::ALL, |_, _| true, &mut many);
    for (ray, many) in rays.iter().zip(many) {
        let expected = high.closest_hit_brute_force(ray, Filter::ALL, |_| true);
        same(expected, high.closest_hit_counted(ray, Filter::ALL, |_| true, &mut least)).unwrap();
        same(expected, balanced.closest_hit_counted(ray, Filter::ALL, |_| true, &mut most)).unwrap();
        same(expected, many).unwrap();
        assert_eq!(expected.is_some(), high.any_hit_opaque(ray, Filter::ALL));
        same(balanced.closest_hit(ray, Filter::ALL, accept), high.closest_hit(ray, Filter::ALL, accept)).unwrap();
        assert_eq!(high.all_hits_brute_force(ray, Filter::ALL), balanced.all_hits_brute_force(ray, Filter::ALL));
        hits += usize::from(expected.is_some());
    }
    assert!(hits > 1_000 && least.nodes < most.nodes && least.triangles < most.triangles, "{hits} {least:?} {most:?}");
}

#[test]
fn compaction_needs_its_flag_and_changes_no_hit() {
    let mesh = soup(10_000, 0.1, 1);
    let build = |allow_compaction| {
        let options = BuildOptions { allow_compaction, ..BuildOptions::default() };
        Blas::build(&mesh.positions, &mesh.indices, &options).unwrap()
    };
    let (without, with) = (build(false), build(true));
    assert_eq!(without.compacted_memory(), Err(BvhError::NotCompactable));
    assert_eq!(without.compacted().unwrap_err(), BvhError::NotCompactable);
    let compacted = with.compacted().unwrap();
    assert_eq!(compacted.memory(), with.compacted_memory().unwrap());
    assert!(compacted.memory() < with.memory(), "{} {}", compacted.memory(), with.memory());
    compacted.validate().unwrap();
    println!("{} bytes after the build, {} compacted", with.memory(), compacted.memory());
    let (before, after) = (Tlas::single(with), Tlas::single(compacted));
    for ray in rays(100_000, 10) {
        same(before.closest_hit_opaque(&ray, Filter::ALL), after.closest_hit_opaque(&ray, Filter::ALL)).unwrap();
    }
}

fn placements(count: usize, motion: f32) -> Vec<BvhInstance> {
    let mut random = Random::new(11);
    (0..count)
        .map(|i| {
            let place = Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, (i / 100) as f32) * 3.0 + random.cube() * motion;
            let turn = Quat::from_axis_angle(random.sphere(), random.unit() * motion);
            BvhInstance::new(i % 2, Affine3A::from_rotation_translation(turn, place))
        })
        .collect()
}

#[test]
fn an_updated_world_hits_what_a_new_one_does_and_tells_how_much_dearer_it_is() {
    let meshes = || vec![Arc::new(soup(40, 0.5, 12).blas()), Arc::new(sphere(2).blas())];
    let options = BuildOptions { allow_update: true, ..BuildOptions::default() };
    let mut updated = Tlas::build_with(meshes(), &placements(500, 0.0), &options).unwrap();
    let mut degradations = Vec::new();
    let mut visits = Vec::new();
    for motion in [0.0, 0.5, 30.0] {
        let instances = placements(500, motion);
        let report = updated.update(meshes(), &instances).unwrap();
        updated.validate().unwrap();
        let rebuilt = Tlas::build(meshes(), instances).unwrap();
        let mut random = Random::new(13);
        let (mut old, mut new, mut hits) = (Counters::default(), Counters::default(), 0);
        for _ in 0..5_000 {
            let (from, to) = (random.cube() * 50.0, Vec3::splat(12.0) + random.cube() * 20.0);
            let ray = Ray::new(from, to - from);
            let expected = rebuilt.closest_hit_counted(&ray, Filter::ALL, |_| true, &mut new);
            same(expected, updated.closest_hit_counted(&ray, Filter::ALL, |_| true, &mut old)).unwrap();
            assert_eq!(expected.is_some(), updated.any_hit_opaque(&ray, Filter::ALL));
            hits += usize::from(expected.is_some());
        }
        assert!(hits > 500, "{hits}");
        println!("motion {motion}: {report:?}, node visits {} updated, {} rebuilt", old.nodes, new.nodes);
        degradations.push(report.degradation());
        visits.push(old.nodes as f64 / new.nodes as f64);
    }
    assert_eq!(degradations[0], 1.0);
    assert!(degradations[2] > 1.5 && degradations[2] > degradations[1], "{degradations:?}");
    assert!((visits[0] - 1.0).abs() < 0.01 && visits[2] > 1.5, "{visits:?}");
    assert!(updated.update(meshes(), &placements(500, 30.0)).unwrap().suggests_rebuild());
    assert!(!updated.update(meshes(), &placements(500, 0.0)).unwrap().suggests_rebuild());
}

#[test]
fn an_updated_mesh_hits_what_a_new_one_does() {
    let mesh = mixed(14);
    let options = BuildOptions { allow_update: true, quality: BuildQuality::High, ..BuildOptions::default() };
    let mut blas = build_mixed(&mesh, &options).unwrap();
    for wave in [0.0, 0.2, 3.0] {
        let bend = |p: Vec3| p + Vec3::new(0.0, wave * (3.0 * p.x).sin(), wave * p.y * p.y);
        let moved = mesh.0.map(bend);
        let spheres = Arc::new(Spheres(mesh.1.0.iter().map(|&(c, r)| (bend(c), r * (1.0 + wave))).collect()));
        let geometry = Geometry::triangles(&moved.positions, &moved.indices).with_shapes(spheres);
        let report = blas.update(&geometry).unwrap();
        blas.validate().unwrap();
        println!("wave {wave}: {report:?}");
        assert!(if wave == 0.0 { report.degradation() == 1.0 } else { report.cost > 0.0 });
        let (updated, rebuilt) = (Tlas::single(blas.clone()), Tlas::single(Blas::build_geometry(&geometry, &options).unwrap()));
        let mut hits = 0;
        for ray in rays(5_000, 15) {
            let expected = rebuilt.closest_hit_opaque(&ray, Filter::ALL);
            same(expected, updated.closest_hit_opaque(&ray, Filter::ALL)).unwrap();
            assert_eq!(expected.is_some(), updated.any_hit_opaque(&ray, Filter::ALL));
            hits += usize::from(expected.is_some());
        }
        assert!(hits > 500, "{hits}");
    }
}

#[test]
fn an_updated_mesh_of_a_single_leaf_is_hit_where_it_is() {
    let options = BuildOptions { allow_update: true, ..BuildOptions::default() };
    let (here, there) = ([Vec3::ZERO, Vec3::X, Vec3::Y], [Vec3::Z * 5.0, Vec3::X + Vec3::Z * 5.0, Vec3::Y + Vec3::Z * 5.0]);
    let mut blas = Blas::build(&here, &[[0, 1, 2]], &options).unwrap();
    blas.update(&Geometry::triangles(&there, &[[0, 1, 2]])).unwrap();
    assert_eq!(blas.bounds(), Aabb::of_points(there));
    blas.validate().unwrap();
    let placed = BvhInstance::new(0, Affine3A::from_translation(Vec3::X * 3.0));
    let tlas = Tlas::build(vec![Arc::new(blas)], vec![BvhInstance::new(0, Affine3A::IDENTITY), placed]).unwrap();
    let hit =
        |x: f32| tlas.closest_hit_opaque(&Ray::new(Vec3::new(x, 0.25, 9.0), Vec3::NEG_Z), Filter::ALL).map(|hit| (hit.t, hit.instance));
    assert_eq!([hit(0.25), hit(3.25), hit(1.5)], [Some((4.0, 0)), Some((4.0, 1)), None]);
}

#[test]
fn a_mesh_that_grows_out_of_a_point_should_be_built_anew() {
    let options = BuildOptions { allow_update: true, ..BuildOptions::default() };
    let mesh = soup(200, 0.3, 30);
    let point = mesh.map(|_| Vec3::ONE);
    let mut blas = Blas::build(&point.positions, &point.indices, &options).unwrap();
    let at_rest = blas.update(&Geometry::triangles(&point.positions, &point.indices)).unwrap();
    assert!(at_rest.degradation() == 1.0 && !at_rest.suggests_rebuild());
    let grown = blas.update(&Geometry::triangles(&mesh.positions, &mesh.indices)).unwrap();
    assert!(grown.suggests_rebuild(), "{grown:?}");
    // Half as much work again is the limit.
    let by = |cost| kajo_bvh::UpdateReport { built_cost: 2.0, cost };
    assert!(!by(3.0).suggests_rebuild() && by(3.01).suggests_rebuild() && by(1.0).degradation() == 0.5);
}

#[test]
fn an_update_after_a_mesh_moved_finds_it_where_it_is() {
    let mesh = soup(200, 0.3, 16);
    let options = BuildOptions { allow_update: true, ..BuildOptions::default() };
    let mut blas = Blas::build(&mesh.positions, &mesh.indices, &options).unwrap();
    let instances = placements(2, 1.0).into_iter().map(|i| BvhInstance { blas: 0, ..i }).collect::<Vec<_>>();
    let mut tlas = Tlas::build_with(vec![Arc::new(blas.clone())], &instances, &options).unwrap();
    let moved = mesh.map(|p| p * 2.0 + Vec3::Y);
    blas.update(&Geometry::triangles(&moved.positions, &moved.indices)).unwrap();
    tlas.update(vec![Arc::new(blas)], &instances).unwrap();
    tlas.validate().unwrap();
    let rebuilt = Tlas::build(vec![Arc::new(moved.blas())], instances).unwrap();
    for ray in rays(2_000, 17) {
        same(rebuilt.closest_hit_opaque(&ray, Filter::ALL), tlas.closest_hit_opaque(&ray, Filter::ALL)).unwrap();
    }
}

#[test]
fn updates_without_the_flag_or_of_other_counts_are_errors_and_change_nothing() {
    let mesh = soup(100, 0.3, 18);
    let allowed = BuildOptions { allow_update: true, ..BuildOptions::default() };
    let geometry = Geometry::triangles(&mesh.positions, &mesh.indices);
    assert_eq!(mesh.blas().update(&geometry), Err(BvhError::NotUpdatable { what: "mesh" }));

    let mut blas = Blas::build_geometry(&geometry, &allowed).unwrap();
    let before = format!("{blas:?}");
    let fewer = Geometry::triangles(&mesh.positions, &mesh.indices[1..]);
    assert_eq!(blas.update(&fewer), Err(BvhError::CountChanged { what: "triangles", got: 99, expected: 100 }));
    let with_shape = geometry.clone().with_shapes(Arc::new(Spheres(vec![(Vec3::ZERO, 1.0)])));
    assert_eq!(blas.update(&with_shape), Err(BvhError::CountChanged { what: "shapes", got: 1, expected: 0 }));
    let broken = mesh.map(|p| if p == mesh.positions[150] { Vec3::NAN } else { p });
    assert!(matches!(blas.update(&Geometry::triangles(&broken.positions, &mesh.indices)), Err(BvhError::Position { vertex: 150, .. })));
    assert_eq!(format!("{blas:?}"), before);

    let meshes = || vec![Arc::new(mesh.blas()), Arc::new(Blas::build(&[], &[], &BuildOptions::default()).unwrap())];
    let instances = placements(10, 0.0).into_iter().map(|i| BvhInstance { blas: 0, ..i }).collect::<Vec<_>>();
    let mut fixed = Tlas::build(meshes(), instances.clone()).unwrap();
    assert_eq!(fixed.update(meshes(), &instances), Err(BvhError::NotUpdatable { what: "world" }));
    let mut world = Tlas::build_with(meshes(), &instances, &allowed).unwrap();
    let before = format!("{world:?}");
    assert_eq!(world.update(meshes(), &instances[1..]), Err(BvhError::CountChanged { what: "instances", got: 9, expected: 10 }));
    let with = |change: &dyn Fn(&mut BvhInstance)| {
        let mut changed = instances.clone();
        change(&mut changed[3]);
        changed
    };
    let flat = with(&|i| i.world_from_object = Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0)));
    assert_eq!(world.update(meshes(), &flat), Err(BvhError::Activity { instance: 3, change: "would vanish" }));
    let empty = with(&|i| i.blas = 1);
    assert_eq!(world.update(meshes(), &empty), Err(BvhError::Activity { instance: 3, change: "would vanish" }));
    let missing = with(&|i| i.blas = 2);
    assert_eq!(world.update(meshes(), &missing), Err(BvhError::Blas { instance: 3, blas: 2, blases: 2 }));
    assert_eq!(format!("{world:?}"), before);
    let mut with_gap = Tlas::build_with(meshes(), &flat, &allowed).unwrap();
    assert_eq!(with_gap.singular_instances(), [3]);
    assert_eq!(with_gap.update(meshes(), &instances), Err(BvhError::Activity { instance: 3, change: "would appear" }));
    assert!(with_gap.update(meshes(), &flat).is_ok() && with_gap.singular_instances() == [3]);
}

#[test]
fn every_field_of_the_tables_is_there_and_limits_are_errors() {
    // Literals name every field.
    let features = Features {
        acceleration_structure: true,
        acceleration_structure_capture_replay: false,
        acceleration_structure_indirect_build: false,
        acceleration_structure_host_commands: true,
        descriptor_binding_acceleration_structure_update_after_bind: true,
        ray_query: true,
        ray_tracing_pipeline: false,
        ray_tracing_pipeline_shader_group_handle_capture_replay: false,
        ray_tracing_pipeline_shader_group_handle_capture_replay_mixed: false,
        ray_tracing_pipeline_trace_rays_indirect: false,
        ray_traversal_primitive_culling: false,
    };
    assert_eq!(Features::HERE, features);
    let limits = Limits {
        max_geometry_count: 2,
        max_instance_count: (1 << 28) - 1,
        max_primitive_count: (1 << 27) - 1,
        max_per_stage_descriptor_acceleration_structures: usize::MAX,
        max_per_stage_descriptor_update_after_bind_acceleration_structures: usize::MAX,
        max_descriptor_set_acceleration_structures: usize::MAX,
        max_descriptor_set_update_after_bind_acceleration_structures: usize::MAX,
        min_acceleration_structure_scratch_offset_alignment: 1,
        shader_group_handle_size: 0,
        max_ray_recursion_depth: 0,
        max_shader_group_stride: 0,
        shader_group_base_alignment: 0,
        shader_group_handle_capture_replay_size: 0,
        max_ray_dispatch_invocation_count: 0,
        shader_group_handle_alignment: 0,
        max_ray_hit_attribute_size: 8,
    };
    assert_eq!(Limits::HERE, limits);

    // A list of zeros that is never read takes no memory.
    let (max_primitive_count, max_instance_count) = (limits.max_primitive_count, limits.max_instance_count);
    let too_many = vec![[0u32; 3]; max_primitive_count + 1];
    let error = Blas::build(&[Vec3::ZERO], &too_many, &BuildOptions::default()).unwrap_err();
    assert_eq!(error, BvhError::TooMany { what: "triangles and shapes", got: max_primitive_count + 1, max: max_primitive_count });
    assert!(Limits::HERE.check_instances(max_instance_count).is_ok());
    let error = Limits::HERE.check_instances(max_instance_count + 1).unwrap_err();
    assert!(error.to_string().contains("split the input"), "{error}");
}

/// Triangles without area, thin as a hair, on top of each other or around one centre, a few sound ones among them.
fn degenerate(seed: u64) -> TestMesh {
    let mut random = Random::new(seed);
    let mut mesh = TestMesh::default();
    for i in 0..400u32 {
        let (a, b, c) = (random.cube(), random.cube(), random.cube());
        mesh.positions.extend(match i % 8 {
            0 => [a, a, a],
            1 => [a, b, a + (b - a) * 0.5],
            2 => [a, b, b + random.cube() * 1e-6],
            3 => [Vec3::splat(0.25), Vec3::splat(0.25) + Vec3::X, Vec3::splat(0.25) + Vec3::Y],
            4 => [a, b, -a - b],
            5 => [a * Vec3::new(1.0, 0.0, 1.0), b * Vec3::new(1.0, 0.0, 1.0), c * Vec3::new(1.0, 0.0, 1.0)],
            6 => [a * 1e-12, b * 1e-12, c],
            _ => [a, b, c],
        });
        mesh.indices.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    mesh
}

#[test]
fn degenerate_soups_of_any_scale_equal_brute_force_however_they_are_built() {
    for scale in [1e-20f32, 1e-10, 1.0, 1e10, 1e17] {
        let mesh = degenerate(20).map(|p| p * scale);
        for quality in BuildQuality::ALL {
            for (allow_update, low_memory) in [(false, false), (true, false), (false, true)] {
                let options = BuildOptions { quality, allow_update, low_memory, ..BuildOptions::default() };
                let tlas = Tlas::single(Blas::build(&mesh.positions, &mesh.indices, &options).unwrap());
                tlas.validate().unwrap_or_else(|fault| panic!("{scale} {options:?}: {fault}"));
                let mut hits = 0;
                for ray in rays(300, 21) {
                    let ray = Ray { origin: ray.origin * scale, direction: ray.direction * scale, ..ray };
                    let expected = tlas.closest_hit_brute_force(&ray, Filter::ALL, |_| true);
                    same(expected, tlas.closest_hit_opaque(&ray, Filter::ALL)).unwrap();
                    assert_eq!(expected.is_some(), tlas.any_hit_opaque(&ray, Filter::ALL));
                    hits += usize::from(expected.is_some());
                }
                assert!(hits > 50 || scale < 1e-19, "{scale} {options:?}: {hits}");
            }
        }
    }
    for broken in [f32::NAN, f32::INFINITY, 1e20] {
        for quality in BuildQuality::ALL {
            let mut mesh = degenerate(22);
            mesh.positions[700].y = broken;
            let error = Blas::build(&mesh.positions, &mesh.indices, &BuildOptions::of(quality)).unwrap_err();
            assert!(matches!(error, BvhError::Position { vertex: 700, .. }), "{error}");
        }
    }
}
