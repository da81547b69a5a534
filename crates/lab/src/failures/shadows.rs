//! The faults of one light's shadow, by the definitions in the table of [`super`].

use super::regions::regions;
use super::surfaces::{LightPlace, Surfaces};
use super::{Class, reach};
use kajo_image::Image;
use kajo_image_metrics::{MetricsError, ShadowClass, border_distance, distance_to, shadow_classes};

/// Difference of visibility that is no fault: what filters and noise leave.
const FAINT: f32 = 0.1;
/// Share of a cast shadow that is lit beyond which the whole shadow is missing.
const MISSING: f64 = 0.95;
/// Pixels of a fault that must lie at a contact.
const AT_CONTACT: usize = 2;
/// Half the width of the window in which a penumbra is looked for, px.
const PENUMBRA_WINDOW: u32 = 2;

/// The class of each pixel under a light, and the pixels that it can reach.
///
/// # Errors
/// Sizes that differ.
pub fn classify(
    image: &Image<f32>,
    reference: &Image<f32>,
    surfaces: &Surfaces,
    (light, reached): (LightPlace, &Image<bool>),
) -> Result<Image<Option<Class>>, MetricsError> {
    let classes = shadow_classes(reference, Some(reached))?;
    let size = classes.size();
    let lit = classes.map(|class| *class == Some(ShadowClass::Lit));
    let cast = Image::from_fn(size, |x, y| *classes.get(x, y) == Some(ShadowClass::Umbra) && surfaces.faces(light, x, y));
    let among = |set: &Image<bool>, is: &dyn Fn(f32) -> bool| {
        Image::from_pixels(size, set.pixels().iter().zip(image.pixels()).map(|(on, v)| *on && is(*v)).collect())
    };
    let light_faults = among(&cast, &|v| v > 0.5);
    let dark_faults = among(&lit, &|v| v < 0.5);
    let view = View {
        surfaces,
        light,
        reach: reach(size.y),
        border: border_distance(reference, Some(reached))?,
        to_light_faults: distance_to(&light_faults),
        to_dark_faults: distance_to(&dark_faults),
    };

    let mut out = Image::from_fn(size, |_, _| None);
    missed_penumbra(image, reference, &classes, &mut out);
    // Faint ones first: a region has the class of its strong part where it has one.
    for region in regions(&among(&lit, &|v| v < 1.0 - FAINT)).iter().filter(|region| !view.begins_at_border(region)) {
        paint(&mut out, region, Class::Acne);
    }
    let faint: Vec<usize> = among(&cast, &|v| v > FAINT).pixels().iter().enumerate().filter(|(_, on)| **on).map(|(i, _)| i).collect();
    for &i in faint.iter().filter(|&&i| view.border.pixels()[i] > view.reach) {
        out.pixels_mut()[i] = Some(Class::Leak);
    }
    for region in regions(&dark_faults) {
        match (view.hugs_border(&region), view.depth(&region)) {
            (true, depth) if depth < 1.0 => {}
            (true, _) => paint(&mut out, &region, Class::Aliasing),
            (false, _) => paint(&mut out, &region, Class::Acne),
        }
    }
    let missing = missing(&cast, &light_faults);
    for region in regions(&light_faults) {
        if let Some(class) = view.light_fault(&region, missing.pixels()[region[0]]) {
            paint(&mut out, &region, class);
        }
    }
    Ok(out)
}

fn paint(out: &mut Image<Option<Class>>, region: &[usize], class: Class) {
    region.iter().for_each(|&i| out.pixels_mut()[i] = Some(class));
}

/// Cast shadows that are lit all over.
fn missing(cast: &Image<bool>, light_faults: &Image<bool>) -> Image<bool> {
    let mut out = cast.map(|_| false);
    for region in regions(cast) {
        let lit = region.iter().filter(|&&i| light_faults.pixels()[i]).count();
        if lit as f64 > MISSING * region.len() as f64 {
            region.iter().for_each(|&i| out.pixels_mut()[i] = true);
        }
    }
    out
}

/// What regions are told apart by.
struct View<'a> {
    surfaces: &'a Surfaces<'a>,
    light: LightPlace,
    reach: f32,
    /// Distance to the border, px.
    border: Image<f32>,
    /// Distance to the nearest pixel that is lit and must not be, px.
    to_light_faults: Image<f32>,
    /// Distance to the nearest pixel that is dark and must not be, px.
    to_dark_faults: Image<f32>,
}

impl View<'_> {
    /// Largest distance from the border, px.
    fn depth(&self, region: &[usize]) -> f32 {
        region.iter().map(|&i| self.border.pixels()[i]).fold(0.0, f32::max)
    }

    fn begins_at_border(&self, region: &[usize]) -> bool {
        region.iter().any(|&i| self.border.pixels()[i] <= 1.0)
    }

    fn hugs_border(&self, region: &[usize]) -> bool {
        self.begins_at_border(region) && self.depth(region) <= self.reach
    }

    /// True when a fault of the other sign is near.
    fn alternates(&self, region: &[usize]) -> bool {
        region.iter().any(|&i| self.to_light_faults.pixels()[i].max(self.to_dark_faults.pixels()[i]) <= 2.0 * self.reach)
    }

    fn at_contact(&self, region: &[usize]) -> bool {
        let width = self.border.width() as usize;
        let contacts = region.iter().filter(|&&i| self.surfaces.is_contact(self.light, (i % width) as u32, (i / width) as u32));
        contacts.take(AT_CONTACT).count() == AT_CONTACT
    }

    /// The class of a region of cast shadow that is lit; `missing`: the whole shadow is.
    fn light_fault(&self, region: &[usize], missing: bool) -> Option<Class> {
        let hugs = self.hugs_border(region);
        if hugs && self.depth(region) < 1.0 {
            return None;
        }
        Some(match (missing, hugs && self.alternates(region)) {
            (true, false) => Class::Leak,
            (true, true) => Class::Aliasing,
            (false, _) if self.at_contact(region) => Class::Detachment,
            (false, true) => Class::Aliasing,
            (false, false) if hugs => Class::Detachment,
            (false, false) => Class::Leak,
        })
    }
}

/// Penumbra, with all its neighbours, where the technique shows one class all around.
fn missed_penumbra(image: &Image<f32>, reference: &Image<f32>, classes: &Image<Option<ShadowClass>>, out: &mut Image<Option<Class>>) {
    let window = |x: u32, y: u32, half: u32| {
        let columns = x.saturating_sub(half)..=(x + half).min(image.width() - 1);
        (y.saturating_sub(half)..=(y + half).min(image.height() - 1)).flat_map(move |v| columns.clone().map(move |u| (u, v)))
    };
    for (x, y) in (0..image.height()).flat_map(|y| (0..image.width()).map(move |x| (x, y))) {
        let resolved = || window(x, y, 1).all(|(u, v)| *classes.get(u, v) == Some(ShadowClass::Penumbra));
        if (image.get(x, y) - reference.get(x, y)).abs() <= FAINT || !resolved() {
            continue;
        }
        let around = window(x, y, PENUMBRA_WINDOW).filter(|&(u, v)| classes.get(u, v).is_some());
        let (sum, count) = around.fold((0.0, 0.0), |(sum, count), (u, v)| (sum + image.get(u, v), count + 1.0));
        if ShadowClass::of(sum / count) != ShadowClass::Penumbra {
            *out.get_mut(x, y) = Some(Class::MissedPenumbra);
        }
    }
}
