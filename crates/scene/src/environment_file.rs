//! Environments from files.

use crate::{Environment, Ignored, ImportLimits, MAX_IMAGE_PIXELS, SceneError, Texels, TextureImage};
use kajo_image::decode_image_within;
use kajo_units::{LinearRgb, Radians};
use std::path::Path;
use std::sync::Arc;

/// An environment, and what was replaced in its file.
pub type LoadedEnvironment = (Environment, Vec<Ignored>);

/// Memory of one pixel while a file becomes an environment: its floats twice, as an OpenEXR file stores channels apart. (A Radiance file needs
/// them once; later the table that the environment is sampled by takes the place of the second.)
const PEAK_BYTES_PER_PIXEL: u64 = 24;

/// Loads a latitude-longitude environment from an HDR, EXR, PNG, JPEG or WebP file; the orientation stands in docs/conventions.md.
///
/// Values become radiance, W/(m² sr), as they are; 8- and 16-bit files are decoded from sRGB and have no light brighter than 1. Values that no
/// radiance can have are replaced, and say so in the second part of the result: NaN and negative ones by 0, infinite ones by the largest finite
/// value of the file.
///
/// # Errors
/// A missing or malformed file, a format that is none of the five, a size of 0 or beyond [`kajo_image::MAX_SIDE`] and
/// [`MAX_IMAGE_PIXELS`] (checked before memory is taken), a file without a finite value.
pub fn load_environment(path: &Path) -> Result<LoadedEnvironment, SceneError> {
    let file = path.display().to_string();
    let bytes = kajo_image::read_file(path).map_err(|source| SceneError::Read { file, source })?;
    decode_environment(path, &bytes, ImportLimits::default())
}

/// [`load_environment`] of bytes in memory, within `limits`; `path` only names them in messages.
///
/// # Errors
/// Those of [`load_environment`].
pub fn decode_environment(path: &Path, bytes: &[u8], limits: ImportLimits) -> Result<LoadedEnvironment, SceneError> {
    let file = path.display().to_string();
    let image = decode_image_within(path, bytes, MAX_IMAGE_PIXELS.min(limits.bytes / PEAK_BYTES_PER_PIXEL))?;
    let (width, height) = (image.width(), image.height());
    let mut texels: Vec<[f32; 3]> = bytemuck::cast_vec(image.into_pixels());
    let ignored = clean(&file, &mut texels)?;
    let name = path.file_name().map_or_else(|| file.clone(), |n| n.to_string_lossy().into_owned());
    let image = TextureImage { name, width, height, texels: Texels::Rgb32F(texels) };
    Ok((Environment { image: Some(Arc::new(image)), scale: LinearRgb::WHITE, rotation: Radians(0.0) }, ignored))
}

/// Replaces what no radiance can be; returns one note for each kind that occurs.
fn clean(file: &str, texels: &mut [[f32; 3]]) -> Result<Vec<Ignored>, SceneError> {
    let largest = texels.as_flattened().iter().copied().filter(|c| c.is_finite()).fold(f32::NEG_INFINITY, f32::max);
    if largest == f32::NEG_INFINITY {
        return Err(SceneError::invalid(file, "image", "every value is NaN or infinite; export the environment again"));
    }
    let [mut not_a_number, mut negative, mut infinite] = [0usize; 3];
    for c in texels.as_flattened_mut() {
        if c.is_nan() {
            not_a_number += 1;
            *c = 0.0;
        } else if *c < 0.0 {
            negative += 1;
            *c = 0.0;
        } else if c.is_infinite() {
            infinite += 1;
            *c = largest.max(0.0);
        }
    }
    let note = |count: usize, what: &str, consequence: String| {
        (count > 0).then(|| Ignored { file: file.into(), place: "image".into(), feature: format!("{count} {what} values"), consequence })
    };
    Ok([
        note(not_a_number, "NaN", "replaced by 0".into()),
        note(negative, "negative", "replaced by 0".into()),
        note(infinite, "infinite", format!("replaced by the largest finite value, {largest}")),
    ]
    .into_iter()
    .flatten()
    .collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{UVec2, Vec2};
    use kajo_image::{ExrFile, Image, Layer};

    fn exr(size: UVec2, pixel: impl FnMut(u32, u32) -> LinearRgb) -> Vec<u8> {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("environment.exr");
        let mut file = ExrFile::new(size);
        file.layers.push(Layer::color("", &Image::from_fn(size, pixel)));
        file.write(&path).unwrap();
        std::fs::read(path).unwrap()
    }

    #[test]
    fn values_that_no_radiance_can_have_are_replaced_and_noted() {
        let values = [f32::NAN, -3.0, f32::INFINITY, 7.0];
        let bytes = exr(UVec2::new(4, 1), |x, _| LinearRgb::splat(values[x as usize]));
        let (environment, ignored) = decode_environment(Path::new("bad.exr"), &bytes, ImportLimits::default()).unwrap();
        let Texels::Rgb32F(texels) = &environment.image.as_ref().unwrap().texels else { panic!("floats") };
        assert_eq!(texels.iter().map(|t| t[0]).collect::<Vec<_>>(), [0.0, 0.0, 7.0, 7.0]);
        let features: Vec<_> = ignored.iter().map(|i| i.feature.as_str()).collect();
        assert_eq!(features, ["3 NaN values", "3 negative values", "3 infinite values"]);
    }

    #[test]
    fn a_clean_file_has_no_notes_and_a_hopeless_one_is_refused() {
        let clean = exr(UVec2::new(2, 1), |x, _| LinearRgb::splat(x as f32));
        assert!(decode_environment(Path::new("a.exr"), &clean, ImportLimits::default()).unwrap().1.is_empty());
        let hopeless = exr(UVec2::new(2, 1), |_, _| LinearRgb::splat(f32::NAN));
        assert!(
            decode_environment(Path::new("a.exr"), &hopeless, ImportLimits::default())
                .unwrap_err()
                .to_string()
                .contains("every value is NaN")
        );
    }

    #[test]
    fn limits_hold_before_memory_is_taken() {
        let bytes = exr(UVec2::new(64, 32), |_, _| LinearRgb::WHITE);
        let limits = |bytes| ImportLimits { bytes, ..ImportLimits::default() };
        assert!(decode_environment(Path::new("a.exr"), &bytes, limits(64 * 32 * PEAK_BYTES_PER_PIXEL)).is_ok());
        let refused = decode_environment(Path::new("a.exr"), &bytes, limits(64 * 32 * PEAK_BYTES_PER_PIXEL - 1));
        assert!(refused.unwrap_err().to_string().contains("2047 px in all"));
    }

    #[test]
    fn missing_malformed_and_oversized_files_are_one_sentence() {
        let missing = load_environment(Path::new("/no/such/sky.hdr")).unwrap_err().to_string();
        assert!(missing.starts_with("cannot read `/no/such/sky.hdr`"), "{missing}");
        let size = |x: u32, y: u32| format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {y} +X {x}\n");
        let huge =
            decode_environment(Path::new("huge.hdr"), size(100_000, 100_000).as_bytes(), ImportLimits::default()).unwrap_err().to_string();
        assert!(huge.contains("huge.hdr declares 100000x100000 px") && huge.contains("65536"), "{huge}");
        let empty = decode_environment(Path::new("empty.hdr"), size(0, 0).as_bytes(), ImportLimits::default()).unwrap_err().to_string();
        assert!(empty.contains("0x0"), "{empty}");
        let truncated = decode_environment(Path::new("cut.hdr"), size(64, 32).as_bytes(), ImportLimits::default()).unwrap_err().to_string();
        assert!(truncated.contains("cut.hdr"), "{truncated}");
        let text = decode_environment(Path::new("notes.txt"), b"hello", ImportLimits::default()).unwrap_err().to_string();
        assert!(text.contains("unknown image format"), "{text}");
    }

    #[test]
    fn real_environment_has_its_sun_above_the_horizon() {
        let Some(assets) = crate::test_assets::directory() else { return };
        let (environment, ignored) = load_environment(&assets.join("env/spiaggia_di_mondello_1k.hdr")).unwrap();
        assert!(ignored.is_empty());
        let image = environment.image.as_ref().unwrap();
        assert_eq!((image.width, image.height), (1024, 512));
        let luminance = |index: u32| {
            let (x, y) = (index % 1024, index / 1024);
            environment.radiance(environment.direction((Vec2::new(x as f32, y as f32) + 0.5) / Vec2::new(1024.0, 512.0))).luminance()
        };
        let brightest = (0..1024 * 512).max_by(|&a, &b| luminance(a).total_cmp(&luminance(b))).unwrap();
        assert!(brightest / 1024 < 256 && luminance(brightest) > 10.0, "row {}: {}", brightest / 1024, luminance(brightest));
    }
}
