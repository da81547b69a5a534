//! Techniques: each a folder that fills a [`Role`], and the registry of all of them.
//!
//! Command line, viewer, lab and documents iterate over [`all`] and know no technique by name. A technique is data ([`Technique`]) and what it
//! does once it is made for a scene ([`Effect`]): passes that read the G-buffer's slots and write the role's.

pub mod aa;
pub mod ao;
mod edge_avoiding;
mod error;
mod frame;
pub mod gi;
mod insight;
mod needs;
mod ray_count;
pub mod reflection;
mod role;
pub mod shaders;
pub mod shadow;
mod still_life;
mod technique;
#[cfg(test)]
mod tests;
pub mod tone;
mod view;

pub use error::Error;
pub use frame::{Coverage, Draw, FrameContext, FrameLight, MakeContext, TraceBackend};
pub use insight::{DebugPixels, DebugView, Statistic};
pub use needs::Needs;
pub use role::Role;
pub use technique::{Effect, Make, Technique};
pub use view::View;

use kajo_names::UnknownName;
use kajo_params::ParamValues;

/// Every technique, in the order of every list.
pub fn all() -> impl Iterator<Item = &'static Technique> {
    shadow::ALL.iter().chain(ao::ALL).chain(gi::ALL).chain(reflection::ALL).chain(aa::ALL).chain(tone::ALL).copied()
}

/// The techniques of one role.
pub fn of_role(role: Role) -> impl Iterator<Item = &'static Technique> {
    all().filter(move |technique| technique.role == role)
}

/// The technique called `id`.
///
/// # Errors
/// [`Error::UnknownName`] with the nearest id.
pub fn find(id: &str) -> Result<&'static Technique, Error> {
    all().find(|technique| technique.id == id).ok_or_else(|| {
        let known: Vec<&str> = all().map(|technique| technique.id).collect();
        UnknownName::new("technique", id, &known).into()
    })
}

/// Reads `ID[:param=value,…]`; parameters that are not given keep their defaults.
///
/// # Errors
/// Those of [`find`] and [`Technique::parse_params`].
pub fn parse(text: &str) -> Result<(&'static Technique, ParamValues), Error> {
    let (id, params) = text.split_once(':').unwrap_or((text, ""));
    let technique = find(id)?;
    let pairs = params.split(',').filter(|pair| !pair.is_empty()).map(|pair| pair.split_once('=').unwrap_or((pair, "")));
    Ok((technique, technique.parse_params(&pairs.collect::<Vec<_>>())?))
}

/// Takes a list `ID[:param=value,…],ID…` apart: techniques and parameters are parted by commas alike, and an id is what has a slash before any `=`.
pub fn split_list(text: &str) -> Vec<&str> {
    let is_id = |piece: &str| piece.split(['=', ':']).next().is_some_and(|name| name.contains('/'));
    let commas = text.match_indices(',').map(|(at, _)| at);
    let ends: Vec<usize> = commas.filter(|at| is_id(text[at + 1..].split(',').next().unwrap_or_default())).collect();
    let starts = std::iter::once(0).chain(ends.iter().map(|end| end + 1));
    starts.zip(ends.iter().copied().chain([text.len()])).map(|(start, end)| &text[start..end]).collect()
}

/// What a role gets where nobody chooses.
pub fn default_of(role: Role) -> Option<&'static Technique> {
    let preferred = match role {
        Role::DirectVisibility => "shadow/ray-traced",
        _ => return of_role(role).next(),
    };
    find(preferred).ok()
}
