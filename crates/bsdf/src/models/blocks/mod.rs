//! What models are built from, each part exchangeable by name: highlights, distributions D of facets, their attenuation G, Fresnel's reflectance F.

pub mod colorimetry;
pub mod distribution;
pub mod fresnel;
pub mod half_vectors;
pub mod highlight;
pub mod highlight_shading;
pub mod masking;
pub mod metals;
pub mod microfacet;
pub mod survey_pdfs;
