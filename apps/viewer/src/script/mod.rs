//! A script instead of a person: what to do, line by line, and what must then be true.
//!
//! ```text
//! open builtin:shadows            # a scene, or several words for a path with spaces
//! wait                            # until pictures and reference are finished
//! technique shadow/map:bias=0     # for its role
//! rival shadow/pcss               # side B
//! judge diffuse-indirect          # another role
//! reference gpu                   # who traces it: auto, cpu, gpu
//! window A | B | reference
//! expect error below 0.1
//! screenshot out.png
//! ```
//!
//! The steps are in [`parse`]; [`run`] carries them out frame by frame.

mod parse;
mod run;

pub(crate) use parse::{Step, parse};
pub(crate) use run::{Next, Runner};
