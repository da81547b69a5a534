//! What the program holds: to see that nothing is held for ever.

use crate::app::App;
use crate::paint::Brush;

/// Growth of the resident memory between two looks that is none: allocators keep pages, and caches of glyphs fill.
const SLACK: u64 = 24 << 20;

/// Memory and resources at one time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Usage {
    /// Of scenes and pictures on the rendering device, bytes.
    device_bytes: u64,
    /// Textures of the window.
    textures: usize,
    /// Buffers, textures, views, bind groups and encoders of the painting device.
    painted: usize,
    /// Resident memory of the program, bytes; 0 where the system does not say.
    resident: u64,
}

impl Usage {
    /// Looks.
    pub fn of(app: &App, brush: &Brush) -> Self {
        let frame = app.model.frames.as_ref().and_then(|frames| frames.sides.first()?.as_ref().ok());
        // What was let go on the painting device is freed when it is asked.
        let _ = brush.device.poll(egui_wgpu::wgpu::PollType::wait_indefinitely());
        let painted = brush.instance.generate_report().map_or(0, |report| {
            let hub = report.hub_report();
            let lists = [&hub.buffers, &hub.textures, &hub.texture_views, &hub.bind_groups, &hub.command_encoders, &hub.command_buffers];
            lists.iter().map(|list| list.num_allocated + list.num_kept_from_user).sum()
        });
        Self {
            device_bytes: frame.map_or(0, |frame| frame.memory_bytes),
            textures: app.context.tex_manager().read().num_allocated(),
            painted,
            resident: resident(),
        }
    }

    /// Compares with a later look.
    ///
    /// # Errors
    /// What has grown.
    pub fn check(&self, later: &Self) -> Result<(), String> {
        let mut grown = Vec::new();
        let mut look = |what: &str, before: u64, after: u64, slack: u64| {
            if after > before + slack {
                grown.push(format!("{what} grew from {before} to {after}"));
            }
        };
        look("memory of the device", self.device_bytes, later.device_bytes, 0);
        look("the number of textures", self.textures as u64, later.textures as u64, 0);
        look("the number of painting resources", self.painted as u64, later.painted as u64, 0);
        look("resident memory", self.resident, later.resident, SLACK);
        if grown.is_empty() { Ok(()) } else { Err(grown.join("; ")) }
    }
}

/// From `/proc`, where there is one.
fn resident() -> u64 {
    const PAGE: u64 = 4096;
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    text.split_whitespace().nth(1).and_then(|pages| pages.parse::<u64>().ok()).map_or(0, |pages| pages * PAGE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planted_growth_is_told_and_slack_is_not() {
        let before = Usage { device_bytes: 100, textures: 3, painted: 9, resident: 1 << 30 };
        assert!(before.check(&before).is_ok());
        assert!(before.check(&Usage { resident: before.resident + SLACK, ..before }).is_ok());
        for grown in [
            Usage { device_bytes: 101, ..before },
            Usage { textures: 4, ..before },
            Usage { painted: 10, ..before },
            Usage { resident: before.resident + SLACK + 1, ..before },
        ] {
            assert!(before.check(&grown).unwrap_err().contains("grew from"), "{grown:?}");
        }
    }
}
