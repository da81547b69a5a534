//! Everything that the window shows and the user can change. No thread and no window: tests drive it as they like.

use crate::camera::Rig;
use crate::errors;
use crate::frames::{self, Frames};
use crate::layout::{Layout, Pane};
use crate::metering::Metering;
use crate::reference::{self, Reference, TracedBy};
use crate::selection::Selection;
use crate::show::{Develop, Show, curve};
use crate::stage::{Moment, Shot, Source, Stage};
use glam::UVec2;
use kajo_lab::failures::places;
use kajo_render_graph::DeviceInfo;
use kajo_renderer::{FrameSettings, Read, RoleSelection};
use kajo_scene::Ignored;
use kajo_techniques::Role;
use std::collections::BTreeSet;
use std::sync::Arc;

/// A message in the window.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Notice {
    /// One sentence.
    pub text: String,
    /// Something is not there that was asked for.
    pub error: bool,
}

/// The state of the viewer.
#[derive(Debug)]
pub(crate) struct Model {
    /// The scene that is being loaded.
    pub loading: Option<Source>,
    /// The scene at the time.
    pub moment: Option<Arc<Moment>>,
    /// Analytic lights of the scene by name, also those that are switched off.
    pub lights: Vec<String>,
    /// The camera.
    pub rig: Option<Rig>,
    /// Time of the animation, s.
    pub time: f32,
    /// Analytic lights that are switched off.
    pub dark: BTreeSet<usize>,
    /// Techniques of both sides.
    pub selection: Selection,
    /// Strips of the window.
    pub layout: Layout,
    /// What they show.
    pub show: Show,
    /// Error at which the heat map is lightest.
    pub heat_full: f32,
    /// Pixels of the screen along a side of one that is rendered.
    pub coarseness: u32,
    /// Stops.
    pub exposure: f32,
    /// Who sets it.
    pub metering: Metering,
    /// Number of the frame: random numbers depend on it.
    pub frame: u32,
    /// The reference is path traced.
    pub judging: bool,
    /// Samples per pixel that it ends at.
    pub spp: u32,
    /// Who traces it.
    pub traced_by: TracedBy,
    /// Messages, oldest first.
    pub notices: Vec<Notice>,
    /// Why no frame can be rendered.
    pub frames_failed: Option<String>,
    /// Why nothing is judged.
    pub reference_failed: Option<String>,
    /// The device that renders.
    pub device: Option<DeviceInfo>,
    /// Techniques that it cannot run, and what they need.
    pub missing: Vec<(&'static str, String)>,
    /// The last frames.
    pub frames: Option<Frames>,
    /// The reference so far.
    pub reference: Option<Reference>,
    /// Lights that are judged, while the moment lasts.
    pub judged_lights: Option<Vec<usize>>,
    /// Errors of both sides.
    pub errors: errors::Answer,
    /// Counts the answers.
    pub errors_serial: u64,
    /// Size of the picture on the screen, px.
    pub screen: UVec2,
    /// Times that the device is to have been lost.
    pub losses: u32,
}

impl Default for Model {
    fn default() -> Self {
        Self {
            loading: None,
            moment: None,
            lights: Vec::new(),
            rig: None,
            time: 0.0,
            dark: BTreeSet::new(),
            selection: Selection::default(),
            layout: Layout::default(),
            show: Show::default(),
            heat_full: 0.5,
            coarseness: 1,
            exposure: 0.0,
            metering: Metering::Fixed,
            frame: 0,
            judging: true,
            spp: 256,
            traced_by: TracedBy::default(),
            notices: Vec::new(),
            frames_failed: None,
            reference_failed: None,
            device: None,
            missing: Vec::new(),
            frames: None,
            reference: None,
            judged_lights: None,
            errors: Vec::new(),
            errors_serial: 0,
            screen: UVec2::ZERO,
            losses: 0,
        }
    }
}

/// Most messages that are kept.
const MOST_NOTICES: usize = 4;

impl Model {
    /// Shows a message; one that is there already stands once.
    pub fn notify(&mut self, text: impl Into<String>, error: bool) {
        let notice = Notice { text: text.into(), error };
        self.notices.retain(|known| *known != notice);
        self.notices.push(notice);
        if self.notices.len() > MOST_NOTICES {
            self.notices.remove(0);
        }
    }

    /// Goes on with a scene that was loaded.
    pub fn enter(&mut self, stage: Stage) {
        let stage = Arc::new(stage);
        // An environment that is dropped changes the light, not the view.
        let same = self.moment.as_ref().is_some_and(|before| before.stage.source.reference == stage.source.reference);
        if !same {
            (self.time, self.dark, self.rig) = (0.0, BTreeSet::new(), None);
            self.show = Show::default();
        }
        self.exposure = stage.scene.exposure.unwrap_or(0.0);
        if self.metering != Metering::Following {
            self.metering = if stage.scene.exposure.is_none() { Metering::Once } else { Metering::Fixed };
        }
        self.evaluate(&stage);
        if self.rig.is_none() {
            self.rig = self.moment.as_ref().map(|moment| Rig::new(&moment.snapshot.cameras[0], moment.bounds));
        }
    }

    /// Evaluates the scene anew: at another time, with other lights.
    pub fn refresh(&mut self) {
        if let Some(stage) = self.moment.as_ref().map(|moment| moment.stage.clone()) {
            self.evaluate(&stage);
        }
    }

    fn evaluate(&mut self, stage: &Arc<Stage>) {
        let moment = Moment::new(stage, self.time, &self.dark);
        let name = |(index, node): (usize, &kajo_scene::Node)| {
            let light = &stage.scene.lights[node.light?];
            let name = [&light.name, &node.name].into_iter().find(|name| !name.is_empty()).cloned();
            Some(name.unwrap_or_else(|| format!("light of node {index}")))
        };
        self.lights = stage.scene.nodes.iter().enumerate().filter_map(name).collect();
        self.moment = Some(Arc::new(moment));
        self.judged_lights = None;
        if matches!(self.show, Show::Light(_) | Show::Classes(_) | Show::Debug { .. }) {
            // Lights have other numbers now.
            self.show = Show::default();
        }
    }

    /// Lets another set the exposure; the next frame is rendered for it to meter.
    pub fn meter(&mut self, metering: Metering) {
        self.metering = metering;
        self.frame = self.frame.wrapping_add(1);
    }

    /// What is to be seen; `None` without a scene or without a window.
    pub fn shot(&self) -> Option<Shot> {
        let size = (self.screen / self.coarseness.max(1)).max(UVec2::ONE);
        let shown = self.screen.min_element() > 0;
        let (moment, rig) = self.moment.as_ref().zip(self.rig.as_ref()).filter(|_| shown)?;
        Some(Shot { moment: moment.clone(), camera: rig.placed(), size })
    }

    /// Techniques of the sides that the strips show.
    pub fn sides(&self) -> Vec<RoleSelection> {
        let mut sides = vec![self.selection.roles()];
        if self.layout.needs_rival() {
            sides.push(self.selection.rival_roles());
        }
        sides
    }

    /// What to ask the renderer.
    pub fn frame_question(&self) -> Option<frames::Question> {
        let settings = FrameSettings {
            index: self.frame,
            exposure: Some(self.exposure),
            gbuffer: self.show.needs_gbuffer(),
            ambient_distance: self.moment.as_ref().map_or(f32::INFINITY, |moment| kajo_lab::ambient_distance(moment.bounds)),
            read: Read::One(self.selection.judged),
            debug: matches!(self.show, Show::Debug { .. }),
            ..FrameSettings::default()
        };
        let watch = self.judged_lights.clone();
        Some(frames::Question { shot: self.shot()?, sides: self.sides(), settings, watch, losses: self.losses })
    }

    /// What to ask the path tracer.
    pub fn reference_question(&self) -> Option<reference::Question> {
        let wanted = self.judging || self.layout.shows(Pane::Reference);
        let shot = self.shot().filter(|_| wanted)?;
        Some(reference::Question { shot, role: self.selection.judged, light: self.selection.light(), spp: self.spp, by: self.traced_by })
    }

    /// The reference, when it is one of what is seen now.
    pub fn current_reference(&self) -> Option<&Reference> {
        let (reference, question) = (self.reference.as_ref()?, self.reference_question()?);
        let same = reference.question.shot == question.shot
            && reference.question.role == question.role
            && reference.question.light == question.light
            && reference.question.by == question.by;
        same.then_some(reference)
    }

    /// What to measure; `None` while frames and reference are of different things.
    pub fn errors_question(&self) -> Option<errors::Question> {
        let (reference, frames) = (self.current_reference()?, self.frames.as_ref()?);
        let belongs = frames.question.shot == reference.question.shot && frames.watched == reference.lights;
        let sides = frames.sides.iter().map(|side| side.as_ref().ok().cloned()).collect();
        let moment = self.moment.as_ref().filter(|_| self.show == Show::Failures);
        let lights = moment.map(|moment| places(&moment.stage.scene, &moment.snapshot, &reference.lights));
        belongs.then(|| errors::Question { role: reference.question.role, judge: reference.judge.clone(), lights, sides })
    }

    /// How light becomes a picture.
    pub fn develop(&self) -> Develop {
        let curve = curve(self.selection.chosen.get(&Role::ToneMap));
        Develop { exposure: self.exposure, curve, role: self.selection.judged }
    }

    /// Everything that the picture leaves out: by the importer, the renderer and the technique.
    pub fn ignored(&self) -> Vec<Ignored> {
        let of_scene = self.moment.iter().flat_map(|moment| moment.stage.scene.ignored.iter().cloned());
        let frame = self.frames.as_ref().and_then(|frames| frames.sides.first()).and_then(|side| side.as_ref().ok());
        let of_frame = frame.into_iter().flat_map(|frame| frame.ignored.iter().cloned());
        let all: BTreeSet<Ignored> = of_scene.chain(of_frame).collect();
        all.into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model(reference: &str) -> Model {
        let source = Source { reference: reference.into(), environment: None };
        let mut model = Model { screen: UVec2::new(64, 48), ..Model::default() };
        model.enter(Stage::load(&source).unwrap());
        model
    }

    #[test]
    fn without_a_scene_or_with_a_minimised_window_nothing_is_asked() {
        assert!(Model { screen: UVec2::new(9, 9), ..Model::default() }.frame_question().is_none());
        let mut model = model("builtin:cornell");
        assert!(model.frame_question().is_some());
        model.screen = UVec2::new(0, 40);
        assert!(model.frame_question().is_none() && model.reference_question().is_none());
    }

    #[test]
    fn coarse_pictures_have_fewer_pixels_and_never_none() {
        let mut model = model("builtin:cornell");
        model.coarseness = 4;
        assert_eq!(model.shot().unwrap().size, UVec2::new(16, 12));
        model.screen = UVec2::new(3, 1);
        assert_eq!(model.shot().unwrap().size, UVec2::ONE);
    }

    #[test]
    fn another_environment_keeps_the_camera_and_another_scene_does_not() {
        let mut model = model("builtin:cornell");
        model.rig.as_mut().unwrap().look(glam::Vec2::splat(30.0));
        model.enter(Stage::load(&Source { reference: "builtin:cornell".into(), environment: None }).unwrap());
        assert!(model.rig.as_ref().unwrap().is_moved());
        model.enter(Stage::load(&Source { reference: "builtin:shadows".into(), environment: None }).unwrap());
        assert!(!model.rig.as_ref().unwrap().is_moved());
    }

    #[test]
    fn the_rival_is_rendered_only_where_it_is_shown() {
        let mut model = model("builtin:shadows");
        assert_eq!(model.sides().len(), 1);
        model.layout = Layout::new(crate::layout::PRESETS[2]);
        assert_eq!(model.sides().len(), 2);
    }

    #[test]
    fn lights_are_listed_and_switched_off() {
        let mut model = model("builtin:shadows");
        let all = model.lights.clone();
        model.dark.insert(1);
        model.refresh();
        assert_eq!(model.lights, all);
        assert_eq!(model.moment.as_ref().unwrap().snapshot.lights.len(), all.len() - 1);
    }

    #[test]
    fn messages_stand_once_and_do_not_pile_up() {
        let mut model = Model::default();
        (0..20).for_each(|i| model.notify(format!("{}", i % 6), true));
        assert!(model.notices.len() == MOST_NOTICES && model.notices.last().unwrap().text == "1");
        model.notify("1", true);
        assert_eq!(model.notices.len(), MOST_NOTICES);
    }
}
