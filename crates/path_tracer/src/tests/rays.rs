//! Single rays: primary visibility, mirrors, glass, recursion.

use super::scenes::{Stage, at, cornell, film_at, glowing, lambert, mirror, render_at, sized, tracer};
use crate::camera::CameraView;
use crate::surface::Surface;
use crate::world::World;
use crate::{Filter, Integrator, RussianRoulette, Settings, Tracer};
use glam::{DVec3, UVec2, Vec2, Vec3};
use kajo_bvh::Ray;
use kajo_scene::{Material, shapes};

/// The nearest triangle of a whole scene by testing every one in double precision \[Moeller97]: instance and distance.
fn nearest_by_force(world: &World, origin: Vec3, direction: Vec3) -> Option<(u32, f64)> {
    let (o, d) = (origin.as_dvec3(), direction.as_dvec3());
    let mut nearest: Option<(u32, f64)> = None;
    for (instance, placed) in (0u32..).zip(&world.instances) {
        for triangle in 0..placed.mesh.indices.len() as u32 {
            let [a, b, c] = placed.triangle(triangle).map(|p| placed.world_from_object.transform_point3(p).as_dvec3());
            let (e1, e2): (DVec3, DVec3) = (b - a, c - a);
            let p = d.cross(e2);
            let inverse = 1.0 / e1.dot(p);
            let s = o - a;
            let (u, q) = (s.dot(p) * inverse, s.cross(e1));
            let (v, t) = (d.dot(q) * inverse, e2.dot(q) * inverse);
            if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 1e-3 && nearest.is_none_or(|(_, best)| t < best) {
                nearest = Some((instance, t));
            }
        }
    }
    nearest
}

/// Row T-06 on the CPU: ids and depths of primary rays are those of a loop over all triangles on at least 99.9 % of pixels.
#[test]
fn primary_rays_see_what_a_loop_over_all_triangles_sees() {
    let shadows = kajo_scene::load("builtin:chair-room", &Default::default()).unwrap();
    for scene in [cornell(), shadows] {
        // Not square: rays through the diagonals of a square picture of the box run along its edges.
        let size = UVec2::new(40, 37);
        let aovs = ["instance-id", "depth"].map(|name| name.parse().unwrap()).into();
        let frame = render_at(&scene, &Settings { aovs, filter: Filter::Center, max_depth: 0, ..sized(size.x, size.y) }, 1);
        let tracer = tracer(&scene);
        let view = CameraView::new(&tracer.snapshot().cameras[0], size);
        let mut wrong = 0;
        for y in 0..size.y {
            for x in 0..size.x {
                let ray = view.ray(Vec2::new(x as f32 + 0.5, y as f32 + 0.5), Vec2::ZERO);
                let expected = nearest_by_force(&tracer.world, ray.origin, ray.direction);
                let get = |name: &str| frame.image(name).unwrap().pixels.get(x, y).x;
                let same = match expected {
                    None => get("instance-id") == -1.0,
                    Some((instance, t)) => {
                        let depth = view.depth(ray.origin + t as f32 * ray.direction);
                        get("instance-id") == instance as f32 && (get("depth") - depth).abs() < 1e-4 * depth
                    }
                };
                wrong += u32::from(!same);
            }
        }
        assert!(f64::from(wrong) <= 0.001 * f64::from(size.x * size.y), "{}: {wrong} pixels", scene.name);
    }
}

/// Follows delta lobes from a ray until a surface of material index `until` or nothing is hit; `lobe` chooses among them.
fn follow(tracer: &Tracer, origin: Vec3, direction: Vec3, lobe: f32, until: u32) -> (Vec<Vec3>, Vec3) {
    let (mut ray, mut leaving, mut points) = (Ray::new(origin, direction), None, Vec::new());
    while let Some(hit) = tracer.world.closest(&ray, leaving, 0) {
        let mut room = None;
        let surface = Surface::new(&tracer.world, &hit, -ray.direction, false, &mut room).expect("a surface with area");
        points.push(surface.point.position);
        if surface.material_index == until {
            break;
        }
        let bsdf = surface.bsdf(None);
        let sample = bsdf.view(surface.frame.to_local(-ray.direction)).sample(lobe, Vec2::splat(0.5)).expect("a smooth lobe");
        let wi = surface.direction_of(&sample).expect("a direction on the right side");
        ray = Ray::new(surface.origin_towards(&tracer.world, wi), wi);
        leaving = Some(surface.primitive);
    }
    (points, ray.direction)
}

/// Row T-07: a ray mirrored at a finely tessellated sphere meets the floor where the analytic one does, within 1e-4.
#[test]
fn mirror_sphere_sends_rays_where_the_analytic_sphere_does() {
    let center = Vec3::new(0.0, 1.0, 0.0);
    let scene =
        Stage::default().mesh(super::scenes::floor(), lambert(0.5), at(Vec3::ZERO)).mesh(shapes::sphere(0.5, 512), mirror(), at(center)).0;
    let tracer = tracer(&scene);
    for target in [Vec3::new(0.1, 0.8, 0.0), Vec3::new(-0.2, 0.75, 0.1), Vec3::new(0.0, 0.7, -0.15)] {
        let origin = Vec3::new(0.3, 1.2, 4.0);
        let direction = (target - origin).normalize();
        let (d, m) = (direction.as_dvec3(), (origin - center).as_dvec3());
        let t = -m.dot(d) - (m.dot(d).powi(2) - m.length_squared() + 0.25).sqrt();
        let point = m + t * d;
        let normal = point / 0.5;
        let mirrored = d - 2.0 * d.dot(normal) * normal;
        let point = point + center.as_dvec3();
        let expected = (point - mirrored * (point.y / mirrored.y)).as_vec3();
        let (points, _) = follow(&tracer, origin, direction, 0.5, 0);
        assert_eq!(points.len(), 2);
        assert!(points[1].distance(expected) < 1e-4, "{points:?} {expected}");
    }
}

/// Row T-08: between two mirrors a path has as many bounces as the limit allows, one ray each.
#[test]
fn mirror_corridor_bounces_up_to_the_limit() {
    let facing = glam::Quat::from_rotation_y(std::f32::consts::PI);
    let turned = kajo_scene::Transform::Trs { translation: Vec3::Z, rotation: facing, scale: Vec3::ONE };
    let scene = Stage::default()
        .mesh(shapes::rectangle(50.0, 50.0), mirror(), at(Vec3::NEG_Z))
        .mesh(shapes::rectangle(50.0, 50.0), mirror(), turned)
        .environment(1.0)
        .orthographic(Vec3::Z * 0.5, Vec3::NEG_Z, 0.5)
        .0;
    for integrator in [Integrator::Path, Integrator::BsdfOnly] {
        for limit in [0u32, 1, 2, 5, 20] {
            let settings = Settings { integrator, max_depth: limit, russian_roulette: RussianRoulette::Off, ..sized(4, 4) };
            let film = film_at(&scene, &settings, 2);
            // BSDF sampling alone does not know that no ray beyond the limit counts.
            let extra = u64::from(integrator == Integrator::BsdfOnly);
            // A path of one bounce a pixel looks for highlights.
            let looking = if integrator == Integrator::Path { 4 * 4 * (1 + u64::from(limit.min(1))) } else { 0 };
            assert_eq!(film.rays(), looking + (1 + u64::from(limit) + extra) * film.samples(), "{integrator:?}, limit {limit}");
        }
    }
}

/// Row T-08: a slab and a sphere of glass bend rays as Snell's law says (row L-02).
#[test]
fn glass_bends_rays_by_snells_law() {
    let glass = |ior| Material { transmission: 1.0, thickness: 1.0, roughness: 0.0, metallic: 0.0, ior, ..Material::default() };
    // Through a slab of thickness 1 at 60°: parallel, displaced by tan θ_t. 1.5 bends 60° to 35.264°.
    let slab = tracer(&Stage::default().mesh(shapes::cuboid(Vec3::new(20.0, 0.5, 20.0)), glass(1.5), at(Vec3::ZERO)).0);
    let (sin, cos) = 60f32.to_radians().sin_cos();
    let direction = Vec3::new(sin, -cos, 0.0);
    let (points, out) = follow(&slab, Vec3::new(0.0, 0.5, 0.0) - direction, direction, 0.999, u32::MAX);
    let bent = (sin / 1.5).asin();
    assert_eq!(points.len(), 2);
    assert!((points[1].x - points[0].x - bent.tan()).abs() < 1e-4, "{points:?}");
    assert!((bent.to_degrees() - 35.264).abs() < 1e-3 && out.abs_diff_eq(direction, 1e-5));
    // Through a sphere of radius 1 with impact parameter b: turned by 2 (θ_i − θ_t), sin θ_i = b.
    let sphere = tracer(&Stage::default().mesh(shapes::sphere(1.0, 512), glass(1.33), at(Vec3::ZERO)).0);
    for b in [0.1f32, 0.5, 0.8] {
        let (points, out) = follow(&sphere, Vec3::new(b, 0.0, 3.0), Vec3::NEG_Z, 0.999, u32::MAX);
        let turn = 2.0 * (b.asin() - (b / 1.33).asin());
        assert_eq!(points.len(), 2);
        assert!((out.dot(Vec3::NEG_Z).acos() - turn).abs() < 2e-3 && out.x < 0.0, "b = {b}: {out}");
    }
}

/// A volume absorbs by the length of the way through it: exp(−σ d), with the Fresnel share of both surfaces.
#[test]
fn volumes_absorb_by_the_beer_lambert_law() {
    let glass = |color: f32| Material {
        transmission: 1.0,
        thickness: 1.0,
        roughness: 0.0,
        metallic: 0.0,
        ior: 1.0,
        specular: 0.0,
        attenuation_color: kajo_units::LinearRgb::splat(color),
        attenuation_distance: 0.5,
        ..Material::default()
    };
    let scene = |color| {
        Stage::default()
            .mesh(shapes::cuboid(Vec3::new(2.0, 2.0, 0.5)), glass(color), at(Vec3::ZERO))
            .mesh(shapes::rectangle(9.0, 9.0), glowing(1.0, 0.0), at(Vec3::NEG_Z * 3.0))
            .orthographic(Vec3::Z * 2.0, Vec3::ZERO, 0.5)
            .0
    };
    for color in [1.0f32, 0.7, 0.2] {
        for integrator in [Integrator::Path, Integrator::BsdfOnly] {
            let frame = render_at(&scene(color), &Settings { integrator, ..sized(2, 2) }, 16);
            let got = frame.beauty().get(0, 0)[0];
            assert!((got - color * color).abs() < 1e-3, "{integrator:?}: {got} after 1 m of a glass that keeps {color} in 0.5 m");
        }
    }
}

/// The near plane hides what a rasteriser would not show.
#[test]
fn nothing_before_the_near_plane_is_seen() {
    let mut scene = Stage::default()
        .mesh(shapes::rectangle(1.0, 1.0), glowing(1.0, 0.0), at(Vec3::Z * 0.5))
        .mesh(shapes::rectangle(9.0, 9.0), glowing(0.25, 0.0), at(Vec3::ZERO))
        .perspective(Vec3::Z, Vec3::ZERO, 40.0)
        .0;
    assert_eq!(render_at(&scene, &sized(2, 2), 1).beauty().get(0, 0)[0], 1.0);
    scene.cameras[0].near = kajo_units::Meters(0.6);
    assert_eq!(render_at(&scene, &sized(2, 2), 1).beauty().get(0, 0)[0], 0.25);
}
