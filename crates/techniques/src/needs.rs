//! What a technique needs from the device, checked before it is made.

use kajo_render_graph::Device;
use kajo_render_graph::wgpu::Features;

/// Features and limits; a device that lacks one makes the technique *skipped*, with the reason shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Needs {
    /// Features of the device.
    pub features: Features,
    /// Storage textures a stage may use.
    pub storage_textures: u32,
}

impl Needs {
    /// Whatever every adapter has.
    pub const NONE: Self = Self { features: Features::empty(), storage_textures: 0 };

    /// These features.
    pub const fn features(features: Features) -> Self {
        Self { features, storage_textures: 0 }
    }

    /// What `device` lacks, in words; `None` when it has everything.
    pub fn missing(&self, device: &Device) -> Option<String> {
        let mut missing: Vec<String> = (self.features - device.features()).iter_names().map(|(name, _)| name.to_lowercase()).collect();
        let limit = device.wgpu.limits().max_storage_textures_per_shader_stage;
        if self.storage_textures > limit {
            missing.push(format!("{} storage textures ({limit} here)", self.storage_textures));
        }
        (!missing.is_empty()).then(|| missing.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_is_named() {
        let device = Device::new().unwrap();
        assert_eq!(Needs::NONE.missing(&device), None);
        let never = Needs { features: Features::empty(), storage_textures: u32::MAX };
        assert!(never.missing(&device).unwrap().contains("storage textures"));
    }
}
