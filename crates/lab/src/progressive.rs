//! Judges from the path tracer on the device, for roles whose images it gives.

use crate::Pictured;
use crate::judge::{Judge, Kind, Part};
use kajo_image::Image;
use kajo_renderer::{Estimate, Radiances};
use kajo_techniques::Role;
use kajo_units::LinearRgb;

/// Whether the path tracer on the device can judge a role: those of light. Visibilities are the CPU's, which has an image of them for each light.
pub fn is_judged_progressively(role: Role) -> bool {
    matches!(role, Role::DiffuseIndirect | Role::SpecularIndirect | Role::LightSampling | Role::AntiAlias)
}

/// Side of the square about each pixel's centre that the samples which judge a role lie in, px: as [`crate::ReferencePlan`] has it.
pub fn spread_of(role: Role) -> f32 {
    if role == Role::AntiAlias { 1.0 } else { 0.0 }
}

/// Most surface bounces of the paths that a role's judge and a picture of this light are made of, of `most` in all: as [`crate::ReferencePlan`] has it.
pub fn depth_of(role: Role, light: Pictured, most: u32) -> u32 {
    let bounces = light == Pictured::Whole || matches!(role, Role::DiffuseIndirect | Role::SpecularIndirect);
    if bounces { most } else { most.min(1) }
}

/// The judge of a role; `None` where it is not judged so, or its image was not asked for.
pub fn progressive_judge(role: Role, found: &Radiances) -> Option<Judge> {
    let part = |name: &str, image: &Estimate| {
        let variance = (found.samples > 1).then(|| image.variance.clone());
        Part { name: name.to_owned(), image: image.mean.clone(), variance, settled: None }
    };
    let part = match role {
        Role::DiffuseIndirect => part("diffuse-indirect", found.diffuse_indirect.as_ref()?),
        Role::SpecularIndirect => part("specular-indirect", &found.specular_indirect),
        Role::LightSampling => part("direct", &found.direct),
        // Without what the real-time renderer does not simulate.
        Role::AntiAlias => {
            let whole = part("beauty", &found.beauty);
            let left = |(all, other): (&LinearRgb, &LinearRgb)| LinearRgb((*all - *other).0.max(glam::Vec3::ZERO));
            let pixels = whole.image.pixels().iter().zip(found.direct_by_others.mean.pixels()).map(left).collect();
            Part { image: Image::from_pixels(whole.image.size(), pixels), ..whole }
        }
        _ => return None,
    };
    Some(Judge { parts: vec![part], mask: None, kind: Kind::Light, composed: None })
}

/// The picture with this light.
pub fn progressive_picture(light: Pictured, found: &Radiances) -> Image<LinearRgb> {
    match light {
        Pictured::Whole => found.beauty.mean.clone(),
        Pictured::Direct => {
            let sum = found.emission.mean.pixels().iter().zip(found.direct.mean.pixels()).map(|(a, b)| *a + *b);
            Image::from_pixels(found.emission.mean.size(), sum.collect())
        }
    }
}
