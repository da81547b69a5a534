//! How the viewer starts.

use crate::Error;
use crate::reference::TracedBy;
use crate::script::{Step, parse};
use glam::UVec2;
use std::path::PathBuf;

/// How the viewer starts.
#[derive(Clone, Debug)]
pub struct Options {
    /// A scene file, or `builtin:NAME`.
    pub scene: Option<String>,
    /// Replaces the scene's environment.
    pub environment: Option<PathBuf>,
    /// Of the window, px.
    pub size: UVec2,
    /// Samples per pixel of the reference.
    pub spp: u32,
    /// Who traces it.
    pub traced_by: TracedBy,
    /// Steps to carry out instead of a person; the window closes after the last.
    pub script: Option<PathBuf>,
    /// Close after so many frames, and after the first picture.
    pub frames: Option<u32>,
    /// Write the window as it is seen when it closes.
    pub screenshot: Option<PathBuf>,
    /// Carry out the script without a window.
    pub offscreen: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            scene: None,
            environment: None,
            size: UVec2::new(1280, 720),
            spp: 256,
            traced_by: TracedBy::default(),
            script: None,
            frames: None,
            screenshot: None,
            offscreen: false,
        }
    }
}

/// The name of a script and its steps, with the number of each line.
type Steps = (String, Vec<(usize, Step)>);

impl Options {
    /// What to do instead of a person; `None` for a person.
    ///
    /// # Errors
    /// A script that cannot be read.
    pub(crate) fn steps(&self) -> Result<Option<Steps>, Error> {
        let mut steps = Vec::new();
        let mut name = String::new();
        if let Some(path) = &self.script {
            name = path.display().to_string();
            let text = std::fs::read_to_string(path).map_err(|reason| Error::Read { file: name.clone(), reason })?;
            steps = parse(&name, &text)?;
        }
        let asked = self.frames.is_some() || self.screenshot.is_some() || self.offscreen;
        if asked {
            let last = [Some(Step::Picture), self.frames.map(Step::Frames), self.screenshot.clone().map(Step::Screenshot)];
            // Line 0: of no file.
            steps.extend(last.into_iter().flatten().map(|step| (0, step)));
        }
        Ok((asked || self.script.is_some()).then_some((name, steps)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_and_screenshot_are_a_short_script() {
        let options = Options { frames: Some(3), screenshot: Some("a.png".into()), ..Options::default() };
        let (_, steps) = options.steps().unwrap().unwrap();
        assert_eq!(steps, [(0, Step::Picture), (0, Step::Frames(3)), (0, Step::Screenshot("a.png".into()))]);
        assert!(Options::default().steps().unwrap().is_none());
    }

    #[test]
    fn a_script_that_is_not_there_is_named() {
        let error = Options { script: Some("/no/such/script".into()), ..Options::default() }.steps().unwrap_err();
        assert!(error.to_string().starts_with("cannot read /no/such/script: "), "{error}");
    }
}
