//! Whole frames, against the path tracer and against closed forms.

mod accumulation;
mod ambient;
mod anti_alias;
mod changes;
mod culling;
mod display;
mod emissive;
mod environment;
mod gbuffer;
mod hit;
mod hybrids;
mod indirect;
mod lighting;
mod map_family;
mod model_twins;
mod models;
mod progressive;
mod reflections;
mod scenes;
mod shadow_volumes;
mod shadows;
mod soft_shadows;
mod textures;
mod tracing;
mod wedges;
