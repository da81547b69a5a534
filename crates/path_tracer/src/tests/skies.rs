//! Environments for tests.

use kajo_scene::{Environment, Texels, TextureImage, load_environment};
use kajo_units::{LinearRgb, Radians};
use std::path::Path;
use std::sync::Arc;

/// Blue above, brown below, clouds, and a sun of a few texels that gives about half of the light.
pub(crate) fn sky(width: u32, height: u32) -> Environment {
    let texel = |x: u32, y: u32| {
        let (u, v) = ((x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32);
        let clouds = 1.0 + 0.5 * (u * 44.0).sin() * (v * 37.0).cos();
        let base = if v < 0.5 { [0.3 * clouds, 0.5 * clouds, 0.9] } else { [0.25, 0.18, 0.1] };
        let sun = 3e3 * (-((u - 0.3).powi(2) * 4.0 + (v - 0.25).powi(2)) * 1.2e4).exp();
        [base[0] + sun, base[1] + 0.9 * sun, base[2] + 0.7 * sun]
    };
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| texel(x, y))).collect();
    let image = TextureImage { name: "sky".into(), width, height, texels: Texels::Rgb32F(texels) };
    Environment { image: Some(Arc::new(image)), scale: LinearRgb::WHITE, rotation: Radians(0.4) }
}

/// A photographed sky of the test assets, which are `$KAJO_ASSETS` or a folder beside the workspace; says so when it is not there.
pub(crate) fn photographed() -> Option<Environment> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let assets = std::env::var_os("KAJO_ASSETS").map_or_else(|| root.join("../shared/assets"), Into::into);
    let path = assets.join("env/spiaggia_di_mondello_1k.hdr");
    if !path.exists() {
        eprintln!("skipped: there is no {}; set KAJO_ASSETS", path.display());
        return None;
    }
    Some(load_environment(&path).expect("a sound environment").0)
}
