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
    /// Width and height, px.
    size: [usize; 2],
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
        let image = within(image, context.input(|input| input.max_texture_side));
        let size = image.size;
        // Pixels are judged here: none is smoothed.
        let options = TextureOptions::NEAREST;
        match self.handles.get_mut(&pane) {
            Some(shown) => {
                shown.handle.set(image, options);
                (shown.key, shown.size) = (key, size);
            }
            None => {
                let handle = context.load_texture(format!("{pane:?}"), image, options);
                self.handles.insert(pane, Shown { handle, key, size });
            }
        }
    }

    /// The texture of a strip, and width and height of its picture.
    pub fn get(&self, pane: Pane) -> Option<(TextureId, [usize; 2])> {
        self.handles.get(&pane).map(|shown| (shown.handle.id(), shown.size))
    }
}

/// A picture that a texture can hold: every second pixel, or third, … of one that is too large, such as a shadow map.
fn within(image: ColorImage, limit: usize) -> ColorImage {
    let step = image.size[0].max(image.size[1]).div_ceil(limit.max(1)).max(1);
    if step == 1 {
        return image;
    }
    let size = image.size.map(|side| side.div_ceil(step));
    let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x * step, y * step))).map(|at| image[at]);
    ColorImage::new(size, pixels.collect())
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
        Pane::A | Pane::B if model.show == show::Show::Failures => (None, None, heat),
        Pane::A | Pane::B => (frame, judge.filter(|_| model.show == show::Show::Role).map(|_| 1), None),
        Pane::Reference => (None, judge, None),
        Pane::HeatA | Pane::HeatB => (None, None, heat),
    };
    Key { show: model.show.clone(), develop: model.develop(), frame, reference, heat }
}

/// The picture of a strip; `None` while there is none.
pub(crate) fn picture(model: &Model, pane: Pane) -> Option<ColorImage> {
    match pane {
        Pane::A | Pane::B if model.show == show::Show::Failures => {
            show::of_failures(model.errors.get(side(pane))?.as_ref()?.as_ref().ok()?)
        }
        Pane::A | Pane::B => show::of_side(&model.show, model.frames.as_ref()?, side(pane), model.current_reference(), model.develop()),
        Pane::Reference => show::of_reference(&model.show, model.current_reference()?, model.develop()),
        Pane::HeatA | Pane::HeatB => Some(show::of_errors(model.errors.get(side(pane))?.as_ref()?.as_ref().ok()?, model.heat_full)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::Color32;

    #[test]
    fn large_pictures_are_thinned_to_what_a_texture_holds() {
        let pixels = (0..50u8).map(Color32::from_gray).collect();
        let image = ColorImage::new([10, 5], pixels);
        assert_eq!(within(image.clone(), 10).size, [10, 5]);
        let thin = within(image, 4);
        assert_eq!((thin.size, thin[(1, 1)]), ([4, 2], Color32::from_gray(33)));
    }
}
