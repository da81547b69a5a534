//! Techniques of the role direct visibility: which share of each light a point sees.

pub mod cascades;
pub mod contact;
pub mod contact_rays;
pub mod depth_map;
pub mod evsm;
pub mod hard;
mod hybrid;
pub mod light_space_perspective;
pub mod map;
mod moments;
pub mod msm;
pub mod multi_sample;
pub mod near_rays;
pub mod none;
pub mod pcss;
pub mod penumbra_rays;
pub mod ray_traced;
mod volume;
pub mod volume_zfail;
pub mod volume_zpass;
pub mod vsm;
pub mod wedges;

use crate::Technique;

/// In the order of every list.
pub const ALL: &[&Technique] = &[
    &none::TECHNIQUE,
    &map::TECHNIQUE,
    &cascades::TECHNIQUE,
    &light_space_perspective::TECHNIQUE,
    &vsm::TECHNIQUE,
    &evsm::TECHNIQUE,
    &msm::TECHNIQUE,
    &pcss::TECHNIQUE,
    &contact::TECHNIQUE,
    &volume_zpass::TECHNIQUE,
    &volume_zfail::TECHNIQUE,
    &wedges::TECHNIQUE,
    &multi_sample::TECHNIQUE,
    &contact_rays::TECHNIQUE,
    &near_rays::TECHNIQUE,
    &penumbra_rays::TECHNIQUE,
    &ray_traced::TECHNIQUE,
];
