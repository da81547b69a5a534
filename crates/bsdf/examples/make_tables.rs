//! Remakes the directional-albedo tables in `src/tables`: `cargo run --release -p kajo-bsdf --example make_tables`.

use kajo_bsdf::tables::quadrature;
use std::{fs, io, path::Path};

const SAMPLES: u32 = 1 << 14;

fn write(name: &str, values: impl IntoIterator<Item = f32>) -> io::Result<()> {
    let bytes: Vec<u8> = values.into_iter().flat_map(|v| ((v.clamp(0.0, 1.0) * 65535.0).round() as u16).to_le_bytes()).collect();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/tables").join(name);
    fs::write(&path, &bytes)?;
    println!("{}: {} bytes", path.display(), bytes.len());
    Ok(())
}

fn main() -> io::Result<()> {
    let ggx = quadrature::make_ggx_albedo(SAMPLES);
    write("ggx_albedo_average.bin", quadrature::make_ggx_albedo_average(&ggx).into_iter().flatten())?;
    write("ggx_albedo.bin", ggx.into_iter().flatten())?;
    let aniso = quadrature::make_ggx_aniso_albedo(SAMPLES / 2);
    write("ggx_aniso_albedo_average.bin", quadrature::make_ggx_aniso_albedo_average(&aniso, 64))?;
    write("ggx_aniso_albedo.bin", aniso)?;
    write("sheen_albedo.bin", quadrature::make_sheen_albedo(256))?;
    write("ggx_hat_albedo.bin", quadrature::make_ggx_hat_albedo(SAMPLES))?;
    write("glass_albedo.bin", quadrature::make_glass_albedo(SAMPLES))
}
