//! One sphere for each layer and extension of the glTF material, on three steps under two soft boxes.

use super::BuiltinScene;
use super::stage::{Stage, at, lambert, looking, metal, plastic};
use crate::{AlphaMode, LightShape, Material, Scene, shapes};
use glam::Vec3;
use kajo_units::{LinearRgb, Meters, Radians};

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "spheres",
    description: "18 spheres, one for each layer and extension of the glTF material, under two soft boxes",
    count: None,
    make,
};

const RADIUS: f32 = 0.45;
const SPACING: f32 = 1.12;
const COLUMNS: usize = 6;
/// Height of a step, m.
const RISE: f32 = 0.55;

fn make(_: u32) -> Scene {
    let mut stage = Stage::new(0.0);
    let tiles = stage.texture("tiles", 2, 1.0, |x, y| if (x + y) % 2 == 0 { [205, 203, 200, 255] } else { [165, 163, 162, 255] });
    let ground = stage.material("ground", Material { base_color_texture: Some(tiles), ..lambert(LinearRgb::WHITE) });
    stage.place("ground", shapes::floor(24.0, 24.0, 24.0), ground, at(0.0, 0.0, 0.0));
    let stone = stage.material("step", lambert(LinearRgb::new(0.5, 0.49, 0.47)));
    for row in 0..2 {
        let half = Vec3::new(3.6, RISE * (2.0 - row as f32) / 2.0, SPACING / 2.0);
        let step = shapes::rounded_cuboid(half, 0.02, 3);
        stage.place(&format!("step {row}"), step, stone, at(0.0, half.y, (row as f32 - 1.0) * SPACING));
    }

    let sphere = shapes::sphere(RADIUS, 96);
    for (index, (name, material)) in materials(&mut stage).into_iter().enumerate() {
        let (row, column) = (index / COLUMNS, index % COLUMNS);
        let material = stage.material(name, material);
        let x = (column as f32 - (COLUMNS as f32 - 1.0) / 2.0) * SPACING;
        stage.place(name, sphere.clone(), material, at(x, RADIUS + RISE * (2 - row) as f32, (row as f32 - 1.0) * SPACING));
    }

    let soft_box = |width, height| LightShape::Rectangle { width: Meters(width), height: Meters(height) };
    let target = Vec3::new(0.0, 0.8, 0.0);
    stage.light("key", soft_box(3.0, 2.0), LinearRgb::new(13.0, 12.4, 11.4), looking(Vec3::new(-4.0, 5.0, 3.0), target));
    stage.light("rim", soft_box(4.0, 0.8), LinearRgb::new(8.0, 9.0, 10.4), looking(Vec3::new(3.5, 4.2, -4.0), target));
    stage.environment(LinearRgb::new(0.3, 0.32, 0.36));
    stage.camera("camera", Vec3::new(0.0, 3.0, 8.9), Vec3::new(0.0, 0.8, 0.0), 27.5, Some(16.0 / 9.0));
    stage.finish()
}

/// Names and materials, back row first.
fn materials(stage: &mut Stage) -> [(&'static str, Material); 3 * COLUMNS] {
    let rgb = LinearRgb::new;
    let holes = stage.texture("holes", 16, 8.0, |x, y| {
        let open = (x as f32 - 7.5).hypot(y as f32 - 7.5) < 5.0;
        [255, 255, 255, if open { 0 } else { 255 }]
    });
    let glass = Material { transmission: 1.0, thickness: 2.0 * RADIUS, roughness: 0.0, metallic: 0.0, ..Material::default() };
    [
        ("lambert", lambert(rgb(0.6, 0.35, 0.25))),
        ("plastic", plastic(rgb(0.05, 0.2, 0.55), 0.08)),
        ("rough plastic", plastic(rgb(0.1, 0.42, 0.18), 0.55)),
        ("gold", metal(rgb(1.0, 0.766, 0.336), 0.12)),
        ("brushed steel (anisotropy)", Material { anisotropy: 0.9, ..metal(rgb(0.56, 0.57, 0.58), 0.4) }),
        ("rough copper", metal(rgb(0.955, 0.638, 0.538), 0.5)),
        ("car paint (clearcoat)", Material { clearcoat: 1.0, clearcoat_roughness: 0.03, ..metal(rgb(0.55, 0.02, 0.03), 0.5) }),
        ("velvet (sheen)", Material { sheen_color: rgb(0.6, 0.25, 0.5), sheen_roughness: 0.35, ..plastic(rgb(0.12, 0.01, 0.08), 0.9) }),
        (
            "film (iridescence)",
            Material {
                iridescence: 1.0,
                iridescence_ior: 1.4,
                iridescence_thickness: [100.0, 420.0],
                ..plastic(rgb(0.015, 0.015, 0.02), 0.05)
            },
        ),
        ("glass (transmission, volume)", glass.clone()),
        ("frosted glass", Material { roughness: 0.35, ..glass.clone() }),
        (
            "amber (attenuation)",
            Material { attenuation_color: rgb(0.95, 0.4, 0.06), attenuation_distance: 0.5, ior: 1.54, ..glass.clone() },
        ),
        ("thin glass", Material { thickness: 0.0, base_color: rgb(0.6, 0.85, 0.7), ..glass.clone() }),
        ("diamond (ior, dispersion)", Material { ior: 2.42, dispersion: 0.36, ..glass }),
        ("tinted (specular)", Material { specular_color: rgb(1.0, 0.45, 0.1), ior: 1.8, ..plastic(rgb(0.04, 0.035, 0.03), 0.2) }),
        (
            "cut out (alpha mask)",
            Material {
                base_color_texture: Some(holes),
                alpha_mode: AlphaMode::Mask(0.5),
                double_sided: true,
                ..plastic(rgb(0.75, 0.7, 0.2), 0.4)
            },
        ),
        ("lamp (emissive)", Material { emission: rgb(2.6, 1.7, 0.8), ..lambert(rgb(0.8, 0.8, 0.8)) }),
        (
            "brushed and turned (anisotropy)",
            Material { anisotropy: 0.8, anisotropy_rotation: Radians::from_degrees(90.0), ..metal(rgb(0.91, 0.78, 0.42), 0.35) },
        ),
    ]
}
