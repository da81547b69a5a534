//! From the scene to the device: geometry, materials, textures, lights, and what rays are traced through.

pub(crate) mod environment;
pub(crate) mod geometry;
pub(crate) mod lights;
pub(crate) mod materials;
pub(crate) mod scene;
pub(crate) mod tables;
pub(crate) mod textures;
pub(crate) mod trace;
