//! Steps of a script, from text.

use crate::Error;
use crate::layout::{PRESETS, Preset};
use crate::reference::TracedBy;
use crate::selection::{Choice, judged_roles};
use glam::{UVec2, Vec2, Vec3};
use kajo_techniques::Role;
use std::path::PathBuf;

/// One line of a script.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Step {
    /// Loads a scene.
    Open(String),
    /// Drops a file on the window.
    Drop(PathBuf),
    /// Waits until everything is finished, the reference too.
    Wait,
    /// Waits until the frame of what is seen has been rendered.
    Picture,
    /// Paints so many frames of the window.
    Frames(u32),
    /// Moves the camera and waits for the picture, so many times.
    Spin(u32),
    /// Gives the window another size, px.
    Size(UVec2),
    /// Chooses a technique for its role.
    Technique(Choice),
    /// Chooses side B.
    Rival(Choice),
    /// Chooses the strips.
    Window(Preset),
    /// Chooses the picture, by the words of the list.
    Show(Vec<String>),
    /// Turns around the scene by a drag, points.
    Orbit(Vec2),
    /// Flies in a direction, for a second.
    Fly(Vec3),
    /// Looks from a place at another.
    Look(Vec3, Vec3),
    /// Pixels of the screen for one that is rendered.
    Coarseness(u32),
    /// Samples of the reference.
    Samples(u32),
    /// Who traces the reference.
    TracedBy(TracedBy),
    /// Judges another role.
    Judge(Role),
    /// Stops; `None` lets it follow what is seen.
    Exposure(Option<f32>),
    /// Switches a light on or off, by index.
    Light(usize, bool),
    /// Takes the rendering device away.
    LoseDevice,
    /// Writes the window as it is seen.
    Screenshot(PathBuf),
    /// Writes the picture of A: `.png` as shown, `.exr` with its numbers.
    Save(PathBuf),
    /// A message must stand in the window that contains this.
    ExpectMessage(String),
    /// No message may stand in the window.
    ExpectQuiet,
    /// A picture must be there, of what is seen.
    ExpectPicture,
    /// The RMSE of A must be below this.
    ExpectErrorBelow(f64),
    /// The reference must have been traced by the device, or by the CPU.
    ExpectTracedBy(TracedBy),
    /// Memory and resources must be as they were at the last `mark`.
    ExpectSteady,
    /// Remembers memory and resources.
    Mark,
}

/// Reads a script; `file` names it in errors.
///
/// # Errors
/// The first line that is no step.
pub(crate) fn parse(file: &str, text: &str) -> Result<Vec<(usize, Step)>, Error> {
    let lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.split('#').next().unwrap_or("").trim()));
    let steps = lines.filter(|(_, line)| !line.is_empty()).map(|(number, line)| {
        let step = step(line).map_err(|reason| Error::Script { file: file.to_owned(), line: number, reason })?;
        Ok((number, step))
    });
    steps.collect()
}

fn step(line: &str) -> Result<Step, String> {
    let (verb, rest) = line.split_once(char::is_whitespace).map_or((line, ""), |(verb, rest)| (verb, rest.trim()));
    let words: Vec<&str> = rest.split_whitespace().collect();
    let choice = || {
        let (technique, params) = kajo_techniques::parse(rest).map_err(|error| error.to_string())?;
        Ok::<_, String>(Choice { technique, params })
    };
    let path = || if rest.is_empty() { Err(format!("`{verb}` needs a file")) } else { Ok(PathBuf::from(rest)) };
    Ok(match (verb, words.as_slice()) {
        ("open", [_, ..]) => Step::Open(rest.to_owned()),
        ("drop", _) => Step::Drop(path()?),
        ("wait", []) => Step::Wait,
        ("picture", []) => Step::Picture,
        ("frames", [count]) => Step::Frames(number(count)?),
        ("spin", [count]) => Step::Spin(number(count)?),
        ("size", [size]) => {
            let (x, y) = size.split_once('x').ok_or("`size` needs WIDTHxHEIGHT")?;
            Step::Size(UVec2::new(number(x)?, number(y)?))
        }
        ("technique", [_, ..]) => Step::Technique(choice()?),
        ("rival", [_, ..]) => Step::Rival(choice()?),
        ("window", [_, ..]) => {
            let names = || PRESETS.map(|preset| preset.name).join(", ");
            let found = PRESETS.into_iter().find(|preset| preset.name.eq_ignore_ascii_case(&words.join(" ")));
            Step::Window(found.ok_or_else(|| format!("no window is called `{rest}`; there are: {}", names()))?)
        }
        ("show", [_, ..]) => Step::Show(words.iter().map(|word| (*word).to_owned()).collect()),
        ("orbit", [x, y]) => Step::Orbit(Vec2::new(number(x)?, number(y)?)),
        ("fly", [direction]) => Step::Fly(point(direction)?),
        ("look", [from, at]) => Step::Look(point(from)?, point(at)?),
        ("coarseness", [side]) => Step::Coarseness(number::<u32>(side)?.max(1)),
        ("samples", [count]) => Step::Samples(number::<u32>(count)?.max(1)),
        ("reference", [by]) => Step::TracedBy(traced_by(by)?),
        ("judge", [role]) => {
            let role = role.parse::<Role>().map_err(|error| error.to_string())?;
            let known = || judged_roles().map(Role::id).collect::<Vec<_>>().join(", ");
            Step::Judge(judged_roles().find(|known| *known == role).ok_or_else(|| format!("{role} is not judged; these are: {}", known()))?)
        }
        ("exposure", ["auto"]) => Step::Exposure(None),
        ("exposure", [stops]) => Step::Exposure(Some(number(stops)?)),
        ("light", [index, "on"]) => Step::Light(number(index)?, true),
        ("light", [index, "off"]) => Step::Light(number(index)?, false),
        ("lose-device", []) => Step::LoseDevice,
        ("screenshot", _) => Step::Screenshot(path()?),
        ("save", _) => Step::Save(path()?),
        ("expect", ["message", ..]) => Step::ExpectMessage(words[1..].join(" ")),
        ("expect", ["quiet"]) => Step::ExpectQuiet,
        ("expect", ["picture"]) => Step::ExpectPicture,
        ("expect", ["error", "below", limit]) => Step::ExpectErrorBelow(number(limit)?),
        ("expect", ["reference", by]) => Step::ExpectTracedBy(traced_by(by)?),
        ("expect", ["steady"]) => Step::ExpectSteady,
        ("mark", []) => Step::Mark,
        _ => return Err(format!("`{line}` is no step")),
    })
}

fn traced_by(word: &str) -> Result<TracedBy, String> {
    let found = TracedBy::ALL.into_iter().find(|(name, _)| *name == word).map(|(_, by)| by);
    found.ok_or_else(|| format!("no tracer is called `{word}`; there are: {}", TracedBy::ALL.map(|(name, _)| name).join(", ")))
}

fn number<T: std::str::FromStr>(word: &str) -> Result<T, String> {
    word.parse().map_err(|_| format!("`{word}` is not the number that is needed here"))
}

fn point(word: &str) -> Result<Vec3, String> {
    let numbers = word.split(',').map(number).collect::<Result<Vec<f32>, _>>()?;
    <[f32; 3]>::try_from(numbers).map(Vec3::from).map_err(|_| format!("`{word}` is not X,Y,Z"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_read_and_comments_are_not() {
        let steps = parse("a", "# nothing\n\nopen my scene.glb\nwindow a | b   # both\nlook 1,2,3 0,0,-1\nexpect error below 0.5").unwrap();
        assert_eq!(steps[0], (3, Step::Open("my scene.glb".into())));
        assert_eq!(steps[1], (4, Step::Window(PRESETS[2])));
        assert_eq!(steps[2], (5, Step::Look(Vec3::new(1.0, 2.0, 3.0), Vec3::NEG_Z)));
        assert_eq!(steps[3], (6, Step::ExpectErrorBelow(0.5)));
    }

    #[test]
    fn what_is_no_step_is_told_with_its_line() {
        for wrong in [
            "jump",
            "size 3",
            "size 3xb",
            "technique shadow/nothing",
            "technique shadow/map:bias=x",
            "window C",
            "look 1,2 0,0,0",
            "drop",
            "wait 3",
            "reference nobody",
            "judge tone-map",
            "judge nothing",
        ] {
            let error = parse("s.txt", &format!("wait\n{wrong}")).unwrap_err().to_string();
            assert!(error.starts_with("s.txt: line 2: "), "{error}");
        }
    }
}
