//! Measured BRDFs: whatever the bytes are, a table of finite values and densities or one error.
#![no_main]

use glam::DVec3;
use kajo_bsdf::models::Reflectance;
use kajo_bsdf::models::rgl::{Rgl, Table};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let Ok(table) = Table::from_bytes(data) else { return };
    let model = Rgl::new(table);
    let directions = [DVec3::Z, DVec3::new(0.6, 0.0, 0.8), DVec3::new(-0.48, 0.6, 0.64), DVec3::new(0.0, -1.0, 1e-6).normalize()];
    for wo in directions {
        for wi in directions {
            let (value, density) = (model.value_f32(wi.as_vec3(), wo.as_vec3()), model.pdf_f32(wi.as_vec3(), wo.as_vec3()));
            assert!(value.is_finite() && value.min_element() >= 0.0, "{value} at {wi} {wo}");
            assert!(density.is_finite() && density > 0.0, "{density} at {wi} {wo}");
        }
        for u in [[0.05, 0.3, 0.7], [0.9, 0.0, 0.5], [0.5, 0.999, 0.999]] {
            assert!(model.sample(wo, u).is_none_or(|wi| wi.is_normalized() && wi.z > 0.0), "{wo} {u:?}");
        }
    }
});
