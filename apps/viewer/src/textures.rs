//! The pictures of the strips, uploaded when they change.

use crate::layout::Pane;
use crate::model::Model;
use crate::show;
use egui::{ColorImage, Context, TextureHandle, TextureId, TextureOptions};
use std::collections::HashMap;

/// A texture for each pane that was shown.
#[derive(Default)]
pub(crate) struct Textures {
    handles: HashMap<Pane, Shown>,
}

struct Shown {
    handle: TextureHandle,
    /// What it was made from.
    key: Key,
}

/// Numbers that change when the picture does.
#[derive(Clone, Debug, PartialEq)]
struct Key {
    show: show::Show,
    develop: show::Develop,
    frame: Option<u64>,
    reference: Option<u64>,
    heat: Option<(u64, f32)>,
}

impl Textures {
    /// Uploads what has changed; strips that are not shown are forgotten.
    pub fn update(&mut self, context: &Context, model: &Model) {
        let panes = model.layout.preset().panes;
        self.handles.retain(|pane, _| panes.contains(pane));
        for &pane in panes {
            let key = key(model, pane);
            if self.handles.get(&pane).is_some_and(|shown| shown.key == key) {
                continue;
            }
            // An old picture stays until there is a new one, unless it shows another thing.
            match picture(model, pane) {
                Some(image) => self.upload(context, pane, key, image),
                None if self.handles.get(&pane).is_some_and(|shown| shown.key.show == key.show) => {}
                None => drop(self.handles.remove(&pane)),
            }
        }
    }

    fn upload(&mut self, context: &Context, pane: Pane, key: Key, image: ColorImage) {
        // Pixels are judged here: none is smoothed.
        let options = TextureOptions::NEAREST;
        match self.handles.get_mut(&pane) {
            Some(shown) => {
                shown.handle.set(image, options);
                shown.key = key;
            }
            None => {
                let handle = context.load_texture(format!("{pane:?}"), image, options);
                self.handles.insert(pane, Shown { handle, key });
            }
        }
    }

    /// The texture of a strip.
    pub fn get(&self, pane: Pane) -> Option<TextureId> {
        self.handles.get(&pane).map(|shown| shown.handle.id())
    }
}

fn side(pane: Pane) -> usize {
    usize::from(matches!(pane, Pane::B | Pane::HeatB))
}

fn key(model: &Model, pane: Pane) -> Key {
    let frame = model.frames.as_ref().map(|frames| frames.serial);
    let judge = model.current_reference().map(|reference| reference.serial);
    let heat = Some((model.errors_serial, model.heat_full));
    let (frame, reference, heat) = match pane {
        // The role's picture is shown as the reference's is.
        Pane::A | Pane::B => (frame, judge.filter(|_| model.show == show::Show::Role).map(|_| 1), None),
        Pane::Reference => (None, judge, None),
        Pane::HeatA | Pane::HeatB => (None, None, heat),
    };
    Key { show: model.show.clone(), develop: model.develop(), frame, reference, heat }
}

/// The picture of a strip; `None` while there is none.
pub(crate) fn picture(model: &Model, pane: Pane) -> Option<ColorImage> {
    match pane {
        Pane::A | Pane::B => show::of_side(&model.show, model.frames.as_ref()?, side(pane), model.current_reference(), model.develop()),
        Pane::Reference => show::of_reference(&model.show, model.current_reference()?, model.develop()),
        Pane::HeatA | Pane::HeatB => Some(show::of_errors(model.errors.get(side(pane))?.as_ref()?.as_ref().ok()?, model.heat_full)),
    }
}
