//! Carries out the steps of a script, one window frame after the other.

use super::Step;
use crate::Error;
use crate::app::App;
use crate::camera::Rig;
use crate::layout::Layout;
use crate::metering::Metering;
use crate::model::Model;
use crate::reference::TracedBy;
use crate::save;
use crate::show::{CHANNELS, Show};
use crate::stage::Source;
use crate::usage::Usage;
use glam::{UVec2, Vec2};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Longest time for one step.
const PATIENCE: Duration = Duration::from_secs(300);

/// What the window is to do.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Next {
    /// Paint a frame, and come back.
    Paint,
    /// Come back when a thread has answered, or after a moment.
    Sleep,
    /// Write what the next frame shows, and come back.
    Screenshot(PathBuf),
    /// Have another size, and come back.
    Resize(UVec2),
    /// Measure, and come back with the answer.
    Measure,
    /// Close.
    Close,
}

/// A script on its way.
pub(crate) struct Runner {
    file: String,
    steps: Vec<(usize, Step)>,
    at: usize,
    /// Of the step: how far it is, and since when.
    count: u32,
    since: Option<Instant>,
    mark: Option<Usage>,
    measured: Option<Usage>,
}

impl Runner {
    /// Begins a script; `file` names it in errors.
    pub fn new(file: &str, steps: Vec<(usize, Step)>) -> Self {
        Self { file: file.to_owned(), steps, at: 0, count: 0, since: None, mark: None, measured: None }
    }

    /// The answer to [`Next::Measure`].
    pub fn measured(&mut self, usage: Usage) {
        self.measured = Some(usage);
    }

    /// Goes on as far as possible without a frame in between.
    ///
    /// # Errors
    /// A step that cannot be carried out, an expectation that is not met, a wait that does not end.
    pub fn advance(&mut self, app: &mut App) -> Result<Next, Error> {
        while let Some((line, step)) = self.steps.get(self.at).cloned() {
            let since = *self.since.get_or_insert_with(Instant::now);
            let file = self.file.clone();
            let failed = |reason: String| if line == 0 { Error::Asked { reason } } else { Error::Script { file, line, reason } };
            if since.elapsed() > PATIENCE {
                return Err(failed(format!("it has not happened in {} s", PATIENCE.as_secs())));
            }
            let (done, next) = self.carry_out(&step, app).map_err(failed)?;
            if done {
                (self.at, self.count, self.since) = (self.at + 1, 0, None);
            }
            if let Some(next) = next {
                return Ok(next);
            }
        }
        Ok(Next::Close)
    }

    /// Whether the step is done, and what the window has to do before the next one.
    fn carry_out(&mut self, step: &Step, app: &mut App) -> Result<(bool, Option<Next>), String> {
        let paint = Ok((true, Some(Next::Paint)));
        match step {
            Step::Open(reference) => app.open(Source { reference: reference.clone(), environment: None }),
            Step::Drop(path) => app.drop_file(path),
            // What was changed has to be seen before it is asked for.
            Step::Wait | Step::Picture if self.count < 2 => return self.once_more(false),
            Step::Wait if app.is_settled() => return paint,
            Step::Picture if app.has_picture() => return paint,
            Step::Picture | Step::Spin(_) if app.is_empty() => return Err(why_empty(app)),
            Step::Wait | Step::Picture => return Ok((false, Some(Next::Sleep))),
            Step::Frames(count) => return self.once_more(self.count + 1 >= *count),
            Step::Spin(_) if !app.has_picture() => return Ok((false, Some(Next::Sleep))),
            Step::Spin(count) => {
                let tilt = if self.count % 20 < 10 { 1.0 } else { -1.0 };
                rig(&mut app.model)?.orbit(Vec2::new(3.0, tilt));
                return self.once_more(self.count + 1 >= *count);
            }
            Step::Size(size) => return Ok((true, Some(Next::Resize(*size)))),
            Step::Screenshot(path) => return Ok((true, Some(Next::Screenshot(path.clone())))),
            Step::Save(path) => save::picture(&app.model, path)?,
            Step::Mark | Step::ExpectSteady => match (self.measured.take(), &self.mark) {
                (None, _) => return Ok((false, Some(Next::Measure))),
                (Some(now), Some(before)) if *step == Step::ExpectSteady => before.check(&now)?,
                (Some(_), None) if *step == Step::ExpectSteady => return Err("there is no `mark` before".into()),
                (Some(now), _) => self.mark = Some(now),
            },
            Step::ExpectMessage(_) | Step::ExpectQuiet | Step::ExpectPicture | Step::ExpectErrorBelow(_) | Step::ExpectTracedBy(_) => {
                expect(step, app)?
            }
            change => apply(change, &mut app.model)?,
        }
        Ok((true, None))
    }

    /// Another frame of the same step.
    fn once_more(&mut self, done: bool) -> Result<(bool, Option<Next>), String> {
        self.count += 1;
        Ok((done, Some(Next::Paint)))
    }
}

/// Why no picture can be waited for.
fn why_empty(app: &App) -> String {
    if app.model.moment.is_some() {
        return "the window has no room for a picture beside the panels; make it larger".into();
    }
    app.messages().last().unwrap_or("there is no scene to see; name one").to_owned()
}

/// Does to the model what a person's hand would.
fn apply(step: &Step, model: &mut Model) -> Result<(), String> {
    match step {
        Step::Technique(choice) => drop(model.selection.chosen.insert(choice.technique.role, choice.clone())),
        Step::Rival(choice) if choice.technique.role == model.selection.judged => model.selection.rival = choice.clone(),
        Step::Rival(choice) => return Err(format!("{} does not fill the judged role {}", choice.technique.id, model.selection.judged)),
        Step::Window(preset) => model.layout = Layout::new(*preset),
        Step::Show(words) => model.show = shown(words)?,
        Step::Orbit(drag) => rig(model)?.orbit(*drag),
        Step::Fly(direction) => rig(model)?.fly(*direction, 1.0),
        Step::Look(from, at) => rig(model)?.look_at(*from, *at),
        Step::Coarseness(side) => model.coarseness = *side,
        Step::Samples(count) => model.spp = *count,
        Step::TracedBy(by) => model.traced_by = *by,
        Step::Judge(role) => model.selection.judge(*role),
        Step::Exposure(Some(stops)) => (model.exposure, model.metering) = (*stops, Metering::Fixed),
        Step::Exposure(None) => model.meter(Metering::Following),
        Step::Light(index, on) => {
            if *on {
                model.dark.remove(index)
            } else {
                model.dark.insert(*index)
            };
            model.refresh();
        }
        Step::LoseDevice => model.losses += 1,
        other => return Err(format!("{other:?} changes nothing")),
    }
    Ok(())
}

fn rig(model: &mut Model) -> Result<&mut Rig, String> {
    model.rig.as_mut().ok_or_else(|| "there is no camera yet: `wait` first".to_owned())
}

/// Looks whether the window is as the script expects.
fn expect(step: &Step, app: &App) -> Result<(), String> {
    let said: Vec<&str> = app.messages().collect();
    match step {
        Step::ExpectMessage(text) if !said.iter().any(|message| message.contains(text.as_str())) => {
            Err(format!("no message contains `{text}`; there are: {said:?}"))
        }
        Step::ExpectQuiet if !said.is_empty() => Err(format!("there are messages: {said:?}")),
        Step::ExpectPicture if !app.has_picture() => Err("there is no picture of what is seen".into()),
        Step::ExpectErrorBelow(limit) => match app.model.errors.first() {
            Some(Some(Ok(errors))) if errors.rmse < *limit => Ok(()),
            Some(Some(Ok(errors))) => Err(format!("the RMSE of A is {}, not below {limit}", errors.rmse)),
            Some(Some(Err(reason))) => Err(format!("the error of A is not known: {reason}")),
            Some(None) | None => Err("the error of A is not known: nothing was measured".into()),
        },
        Step::ExpectTracedBy(by) => match app.model.current_reference().map(|reference| &reference.on_device) {
            None => Err("there is no reference of what is seen".into()),
            Some(Err(reason)) if *by == TracedBy::Device => Err(format!("the CPU has traced the reference: {reason}")),
            Some(Ok(device)) if *by == TracedBy::Cpu => Err(format!("{device} has traced the reference")),
            Some(_) => Ok(()),
        },
        _ => Ok(()),
    }
}

/// The picture that words name.
fn shown(words: &[String]) -> Result<Show, String> {
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let number = |word: &str| word.parse::<usize>().map_err(|_| format!("`{word}` is not a light's number"));
    match words.as_slice() {
        ["picture"] => Ok(Show::Picture),
        ["direct"] => Ok(Show::Direct),
        ["role"] => Ok(Show::Role),
        ["light", index] => Ok(Show::Light(number(index)?)),
        ["classes", index] => Ok(Show::Classes(number(index)?)),
        ["failures"] => Ok(Show::Failures),
        ["debug", name, light] => Ok(Show::Debug { name: (*name).to_owned(), light: number(light)? as u32 }),
        ["channel", ..] => {
            let name = words[1..].join(" ");
            let found = CHANNELS.iter().position(|(known, _)| known.starts_with(&name) && !name.is_empty());
            found
                .map(Show::Channel)
                .ok_or_else(|| format!("no channel is called `{name}`; there are: {}", CHANNELS.map(|(name, _)| name).join(", ")))
        }
        _ => Err(format!(
            "`{}` is no picture: picture, direct, role, light N, classes N, failures, channel NAME, debug NAME N",
            words.join(" ")
        )),
    }
}
