//! What the path tracer on the device does not simulate as the CPU's does.

use glam::Vec3;
use kajo_scene::{ColorSpace, Environment, Ignored, Scene, Snapshot};

/// Largest radiance that the environment's texture holds, W/(m² sr).
const BRIGHTEST: f32 = 65504.0;

/// Everything in the scene, seen through one of the snapshot's cameras, that makes its pictures differ from the CPU path tracer's by more than noise. Empty where they
/// are judges as good as those.
///
/// One difference is in no list: rays start at the triangles of smooth meshes, as without \[Hanika21], so coarse meshes shadow themselves near the terminator.
pub fn not_path_traced(scene: &Scene, snapshot: &Snapshot, camera: usize) -> Vec<Ignored> {
    let mut list = Vec::new();
    let mut say = |place: String, feature: &str, consequence: &str| {
        let consequence = format!("path tracer on the device: {consequence}");
        list.push(Ignored { file: scene.name.clone(), place, feature: feature.into(), consequence });
    };
    for (index, material) in scene.materials.iter().enumerate() {
        if !snapshot.instances.iter().any(|instance| snapshot.meshes[instance.mesh].material == index) {
            continue;
        }
        let place = || format!("material {index} \"{}\"", material.name);
        if material.transmission > 0.0 {
            say(place(), "KHR_materials_transmission", "light does not pass the surface");
        }
        if material.iridescence > 0.0 {
            say(place(), "KHR_materials_iridescence", "the thickness of the film is rounded to 8 nm");
        }
        if let Some(model) = material.model.as_ref().filter(|model| model.entry.wesl.is_none()) {
            say(place(), model.entry.title, "read from a table that approximates it");
        }
    }
    if scene.environment.as_ref().is_some_and(is_too_bright) {
        say(String::new(), "environment", "radiance above 65504 W/(m² sr) is cut off");
    }
    if let Some(placed) = snapshot.cameras.get(camera)
        && placed.camera.lens_radius.0 > 0.0
    {
        say(format!("camera \"{}\"", placed.camera.name), "thin lens", "everything is in focus");
    }
    list
}

fn is_too_bright(environment: &Environment) -> bool {
    let Some(image) = &environment.image else { return false };
    let texel = |x, y| image.texel(x, y, ColorSpace::Linear).truncate();
    (0..image.height).any(|y| (0..image.width).any(|x| Vec3::max_element(texel(x, y)) > BRIGHTEST))
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_scene::builtin;
    use kajo_units::{LinearRgb, Meters, Seconds};

    #[test]
    fn glass_films_lenses_and_suns_are_listed_and_nothing_else() {
        let scene = builtin::load("cornell").unwrap();
        let found = |scene: &Scene| not_path_traced(scene, &Snapshot::new(scene, Seconds(0.0)), 0).len();
        assert_eq!(found(&scene), 0);
        let mut all = scene.clone();
        all.materials[0].transmission = 0.5;
        all.materials[1].iridescence = 0.5;
        all.cameras[0].lens_radius = Meters(0.1);
        assert_eq!(found(&all), 3);
        let sun = |radiance: f32| {
            let texels = kajo_scene::Texels::Rgb32F(vec![[1.0, 1.0, radiance], [1.0; 3]]);
            let image = kajo_scene::TextureImage { name: String::new(), width: 2, height: 1, texels };
            let environment = Environment { image: Some(image.into()), ..Environment::uniform(LinearRgb::WHITE) };
            found(&Scene { environment: Some(environment), ..scene.clone() })
        };
        assert_eq!((sun(65504.0), sun(7e4)), (0, 1));
    }
}
