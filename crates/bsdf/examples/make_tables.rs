//! Remakes the directional-albedo tables in `src/tables`: `cargo run --release -p kajo-bsdf --example make_tables`, and with the
//! argument `iso` or `aniso` those of isotropic or anisotropic facets alone. The latter take minutes.

use kajo_bsdf::tables::quadrature;
use std::{env, fs, io, path::Path};

const SAMPLES: u32 = 1 << 14;

fn write(name: &str, values: impl IntoIterator<Item = f32>) -> io::Result<()> {
    let bytes: Vec<u8> = values.into_iter().flat_map(|v| ((v.clamp(0.0, 1.0) * 65535.0).round() as u16).to_le_bytes()).collect();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/tables").join(name);
    fs::write(&path, &bytes)?;
    println!("{}: {} bytes", path.display(), bytes.len());
    Ok(())
}

fn isotropic() -> io::Result<()> {
    let ggx = quadrature::make_ggx_albedo(SAMPLES);
    write("ggx_albedo_average.bin", quadrature::make_ggx_albedo_average(&ggx).into_iter().flatten())?;
    write("ggx_albedo.bin", ggx.into_iter().flatten())?;
    write("sheen_albedo.bin", quadrature::make_sheen_albedo(256))?;
    write("ggx_hat_albedo.bin", quadrature::make_ggx_hat_albedo(SAMPLES))?;
    write("glass_albedo.bin", quadrature::make_glass_albedo(SAMPLES))
}

fn anisotropic() -> io::Result<()> {
    let white = quadrature::make_aniso_white(SAMPLES / 8);
    let mean_cos = quadrature::make_aniso_mean_cos(SAMPLES / 8);
    write("aniso_average.bin", quadrature::make_aniso_average(&white, &mean_cos, 96))?;
    write("aniso_white.bin", white)?;
    write("aniso_mean_cos.bin", mean_cos)?;
    write("aniso_glass.bin", quadrature::make_aniso_glass(SAMPLES / 16))
}

fn main() -> io::Result<()> {
    let which = env::args().nth(1);
    let wanted = |name| which.as_deref().is_none_or(|which| which == name);
    if wanted("iso") {
        isotropic()?;
    }
    if wanted("aniso") {
        anisotropic()?;
    }
    Ok(())
}
