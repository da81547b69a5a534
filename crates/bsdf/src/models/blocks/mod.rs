//! What models are built from: parts that stand on their own and can be exchanged.

pub mod highlight;
pub mod highlight_shading;
pub mod survey_pdfs;
