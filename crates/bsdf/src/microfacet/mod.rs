//! Microfacet theory with the GGX distribution: facets, masking, sampling, and the energy that single scattering loses.

mod energy;
mod ggx;

pub(crate) use energy::aniso_albedo_of;
pub use energy::{
    GgxAlbedo, ggx_albedo, ggx_albedo_aniso, ggx_albedo_aniso_average, ggx_albedo_average, ggx_multiple_scattering_color, glass_albedo,
    glass_albedo_aniso,
};
pub(crate) use ggx::stretched_length;
pub use ggx::{
    MIN_ALPHA, ggx_cap_bound, ggx_d, ggx_d_aniso, ggx_g1, ggx_g1_aniso, ggx_g2, ggx_g2_aniso, ggx_lambda_aniso, ggx_reflection_pdf,
    ggx_sample_normal, ggx_sample_reflection, ggx_sample_vndf, ggx_visibility, ggx_visibility_aniso, ggx_vndf_pdf,
};
