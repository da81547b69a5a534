//! What this renderer does not simulate, found by looking at the scene: nothing is left out silently.

use crate::upload::tables::ModelTables;
use kajo_scene::{AlphaMode, Ignored, Material, Scene, Snapshot};

/// The list for a scene seen by one of its cameras.
pub(crate) fn find(scene: &Scene, snapshot: &Snapshot, tables: &ModelTables, camera: usize, direct_blend: bool) -> Vec<Ignored> {
    let mut list = Vec::new();
    let mut say = |place: String, feature: &str, consequence: &str| {
        list.push(Ignored { file: scene.name.clone(), place, feature: feature.into(), consequence: consequence.into() });
    };
    for (index, material) in scene.materials.iter().enumerate() {
        let used = snapshot.instances.iter().any(|instance| snapshot.meshes[instance.mesh].material == index);
        if !used {
            continue;
        }
        let place = || format!("material {index} \"{}\"", material.name);
        if transmits(material) {
            say(place(), "KHR_materials_transmission", "real-time: light does not pass the surface, what lies behind is not seen");
        }
        if let Some(model) = &material.model
            && let Some(table) = tables.of(model)
        {
            let grid = table.grid;
            let consequence = format!(
                "real-time: read from a table of {} × {} × {} × {} nodes (θ_h, φ_h, φ_d, θ_d), which is {:.2} % off (root mean square of f cos θ_i)",
                grid.theta_h,
                grid.phi_h,
                grid.phi_d,
                grid.theta_d,
                100.0 * table.deviation
            );
            say(place(), model.entry.title, &consequence);
        }
        if material.alpha_mode == AlphaMode::Blend {
            let consequence = "real-time: blended surfaces are lit without shadows, and sorted by mesh only";
            let missing = "real-time: this adapter cannot blend 32-bit floats, blended surfaces are not drawn";
            say(place(), "alpha mode BLEND", if direct_blend { consequence } else { missing });
        }
    }
    if scene.environment.is_some() {
        say(
            String::new(),
            "environment as a light",
            "real-time: it lights diffuse lobes by its irradiance times the share of the hemisphere that the role ambient-visibility finds open, and is reflected by techniques of the role specular-indirect",
        );
    }
    let placed = &snapshot.cameras[camera].camera;
    if placed.lens_radius.0 > 0.0 {
        say(format!("camera \"{}\"", placed.name), "thin lens", "real-time: everything is in focus");
    }
    list
}

fn transmits(material: &Material) -> bool {
    material.transmission > 0.0
}
