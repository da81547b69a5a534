//! What models are built from.

pub mod survey_pdfs;
