//! The references of a scene: one judge for each role, from one rendering of the path tracer for all roles of one pixel filter.
//!
//! Samples lie at pixel centres, where a rasteriser without anti-aliasing looks: a difference is then one of light, not of the pixel
//! filter. The role anti-alias is judged by the mean over the pixel's area. Roles that end at the first hit need no longer paths, and get none.

use crate::judge::{Composed, Judge, Kind, Part};
use crate::{LabError, Progress, ReferenceStop};
use glam::Vec3;
use kajo_image::Image;
use kajo_path_tracer::{Aov, Filter, Frame, Integrator, Pixels, Settings, Stop, Tracer, render};
use kajo_units::LinearRgb;
use std::collections::BTreeMap;
use std::ops::ControlFlow;

/// All judges of a scene.
#[derive(Clone, Debug)]
pub struct References {
    /// By the role's id.
    pub judges: BTreeMap<&'static str, Judge>,
    /// What the rendering that gave each of them took.
    pub renderings: BTreeMap<&'static str, Rendering>,
    /// Samples that were NaN or infinite and count as black.
    pub invalid_samples: u64,
}

/// A rendering of the path tracer.
#[derive(Clone, Copy, Debug)]
pub struct Rendering {
    /// Samples per pixel.
    pub spp: u32,
    /// Wall-clock time, s.
    pub seconds: f64,
    /// Rays traced.
    pub rays: u64,
}

/// How the path tracer judges a role.
#[derive(Clone, Copy, Debug)]
struct Recipe {
    role: &'static str,
    kind: Kind,
    images: fn(&Tracer) -> Vec<Aov>,
    /// Used in the picture of the direct light, which is compared, too.
    composed: bool,
    /// Judged by the whole picture, less what is not simulated, in place of `images`.
    picture: bool,
    /// Needs paths beyond the first bounce.
    indirect: bool,
    filter: Filter,
}

impl Recipe {
    const fn new(role: &'static str, kind: Kind, images: fn(&Tracer) -> Vec<Aov>) -> Self {
        Self { role, kind, images, composed: false, picture: false, indirect: false, filter: Filter::Center }
    }

    /// False where the scene has nothing to judge the role by.
    fn applies(&self, tracer: &Tracer) -> bool {
        self.picture || !(self.images)(tracer).is_empty()
    }
}

const RECIPES: [Recipe; 6] = [
    Recipe { composed: true, ..Recipe::new("direct-visibility", Kind::Visibility, visibilities) },
    Recipe::new("ambient-visibility", Kind::Fraction, |_| vec![Aov::AmbientVisibility]),
    Recipe { indirect: true, ..Recipe::new("diffuse-indirect", Kind::Light, |_| vec![Aov::DiffuseIndirect]) },
    Recipe { indirect: true, ..Recipe::new("specular-indirect", Kind::Light, |_| vec![Aov::SpecularIndirect]) },
    Recipe::new("light-sampling", Kind::Light, |_| vec![Aov::Direct]),
    Recipe { picture: true, filter: Filter::Box, ..Recipe::new("anti-alias", Kind::Light, |_| vec![]) },
];

/// Most lights whose visibility is judged, each by an image of its own: film and takes of all of them must fit in memory.
pub const MAX_LIGHTS: usize = 12;

/// The lights whose visibility is judged, the strongest of the analytic lights and emissive meshes: indices that both renderers share.
pub fn judged_lights(tracer: &Tracer) -> Vec<usize> {
    tracer.strongest_lights(MAX_LIGHTS)
}

fn visibilities(tracer: &Tracer) -> Vec<Aov> {
    judged_lights(tracer).into_iter().map(|light| Aov::Visibility(tracer.light_names()[light].clone())).collect()
}

/// Direct light of no light of the role direct visibility: that of the environment and of unlit surfaces.
fn not_simulated_direct(tracer: &Tracer) -> Vec<Aov> {
    let simulated = tracer.visibility_light_names().count();
    tracer.light_names()[simulated..].iter().cloned().map(Aov::DirectLight).collect()
}

/// Roles whose techniques can be judged by an image of the path tracer.
pub fn judged_roles() -> impl Iterator<Item = &'static str> {
    RECIPES.iter().map(|recipe| recipe.role)
}

/// Most samples per pixel that `--reference-noise` takes: a scene whose noise does not fall must end.
const MAX_SPP: u32 = 1 << 16;
/// Fewest samples per pixel before a noise level is believed.
const MIN_SPP: u32 = 16;

/// Renders the judges of `roles`. `None` when interrupted.
///
/// # Errors
/// Settings that the tracer refuses.
pub fn references(
    tracer: &Tracer,
    roles: &[&str],
    base: &Settings,
    stop: ReferenceStop,
    progress: &dyn Progress,
    share: &(dyn Fn(f64) -> f64 + Sync),
) -> Result<Option<References>, LabError> {
    let recipes: Vec<Recipe> = RECIPES.into_iter().filter(|r| roles.contains(&r.role) && r.applies(tracer)).collect();
    let mut filters: Vec<Filter> = Vec::new();
    recipes.iter().for_each(|r| {
        if !filters.contains(&r.filter) {
            filters.push(r.filter);
        }
    });
    let mut out = References { judges: BTreeMap::new(), renderings: BTreeMap::new(), invalid_samples: 0 };
    for (i, filter) in filters.iter().enumerate() {
        let group: Vec<Recipe> = recipes.iter().filter(|r| r.filter == *filter).copied().collect();
        let part = |f: f64| share((i as f64 + f) / filters.len() as f64);
        let Some((judges, frame)) = rendering(tracer, &group, base, stop, progress, &part)? else { return Ok(None) };
        out.renderings.extend(group.iter().map(|r| (r.role, Rendering { spp: frame.spp, seconds: frame.seconds, rays: frame.rays })));
        out.judges.extend(judges);
        out.invalid_samples += frame.invalid_samples;
    }
    Ok(Some(out))
}

/// Judges by role, and the frame that they come from.
type Judged = (BTreeMap<&'static str, Judge>, Frame);

/// One rendering, for roles of one pixel filter.
fn rendering(
    tracer: &Tracer,
    recipes: &[Recipe],
    base: &Settings,
    stop: ReferenceStop,
    progress: &dyn Progress,
    share: &(dyn Fn(f64) -> f64 + Sync),
) -> Result<Option<Judged>, LabError> {
    let plan = ReferencePlan { recipes: recipes.to_vec(), picture: None };
    let settings = plan.settings(tracer, base);
    let control = |p: &kajo_path_tracer::Progress| {
        progress.at("reference", share(f64::from(p.fraction)));
        if progress.interrupted() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let (mut goal, last, wanted) = match stop {
        ReferenceStop::Spp(spp) => (spp, spp, 0.0),
        ReferenceStop::Noise(error) => (MIN_SPP, MAX_SPP, f64::from(error)),
    };
    let mut film = None;
    loop {
        let rendered = render(tracer, &settings, Stop::at_spp(goal), film.take(), &control)?;
        if progress.interrupted() {
            return Ok(None);
        }
        let frame = rendered.develop();
        let judges = plan.judges(tracer, &frame);
        let noise = judges.values().filter_map(Judge::relative_standard_error).fold(0.0, f64::max);
        if goal >= last || noise <= wanted {
            return Ok(Some((judges, frame)));
        }
        goal = next_goal(goal, noise / wanted).min(last);
        film = Some(rendered);
    }
}

/// What has to be rendered to judge roles of one pixel filter, and how it becomes their judges: for callers that render by themselves, a viewer for one.
#[derive(Clone, Debug)]
pub struct ReferencePlan {
    recipes: Vec<Recipe>,
    /// A picture is wanted, too.
    picture: Option<Pictured>,
}

/// The light in a picture beside the images of roles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pictured {
    /// What emits, and light that bounced once.
    Direct,
    /// All of it.
    Whole,
}

impl ReferencePlan {
    /// The judge of a role, by id; `None` where the scene has nothing to judge it by.
    pub fn new(tracer: &Tracer, role: &str) -> Option<Self> {
        let recipe = RECIPES.into_iter().find(|r| r.role == role && r.applies(tracer))?;
        Some(Self { recipes: vec![recipe], picture: None })
    }

    /// The same, with what [`Self::picture`] is made of.
    pub fn with_picture(self, light: Pictured) -> Self {
        Self { picture: Some(light), ..self }
    }

    /// `base` with the images that the judges are made of, sampled as the role is judged.
    pub fn settings(&self, tracer: &Tracer, base: &Settings) -> Settings {
        let recipes = &self.recipes;
        let mut aovs: Vec<Aov> =
            recipes.iter().flat_map(|r| (r.images)(tracer).into_iter().chain(r.composed.then_some(Aov::Direct))).collect();
        if recipes.iter().any(|r| r.composed || r.picture) {
            aovs.extend(not_simulated_direct(tracer));
        }
        if self.picture.is_some() {
            let missing = [Aov::Emission, Aov::Direct].into_iter().filter(|aov| !aovs.contains(aov));
            aovs.extend(missing.collect::<Vec<_>>());
        }
        aovs.push(Aov::Coverage);
        let bounces = self.picture == Some(Pictured::Whole) || recipes.iter().any(|r| r.indirect);
        let integrator = if bounces { Integrator::Path } else { Integrator::Direct };
        Settings { integrator, filter: recipes[0].filter, aovs, ..base.clone() }
    }

    /// The judges out of a frame of these settings, by the role's id.
    ///
    /// # Panics
    /// When the frame lacks an image that [`Self::settings`] asked for.
    pub fn judges(&self, tracer: &Tracer, frame: &Frame) -> BTreeMap<&'static str, Judge> {
        judges(tracer, &self.recipes, frame)
    }

    /// The picture with the light that [`Self::with_picture`] asked for; `None` where it did not.
    pub fn picture(&self, frame: &Frame) -> Option<Image<LinearRgb>> {
        let image = |aov: Aov| frame.image(&aov.to_string()).map(|image| image.pixels.to_color());
        match self.picture? {
            Pictured::Whole => Some(frame.beauty().clone()),
            Pictured::Direct => {
                let (emission, light) = (image(Aov::Emission)?, image(Aov::Direct)?);
                let sum = emission.pixels().iter().zip(light.pixels()).map(|(a, b)| *a + *b);
                Some(Image::from_pixels(emission.size(), sum.collect()))
            }
        }
    }
}

/// What the real-time renderer simulates of a picture. On the same random streams the lights' images add up to the whole, so the difference is as exact
/// as their sum.
fn simulated(tracer: &Tracer, frame: &Frame, whole: &Image<LinearRgb>) -> Image<LinearRgb> {
    let missing: Option<Vec<_>> =
        not_simulated_direct(tracer).iter().map(|aov| Some(frame.image(&aov.to_string())?.pixels.to_color())).collect();
    let left = |i: usize, whole: LinearRgb| missing.iter().flatten().fold(whole, |left, image| left - image.pixels()[i]).0.max(Vec3::ZERO);
    let pixels = whole.pixels().iter().enumerate().map(|(i, p)| LinearRgb(left(i, *p)));
    Image::from_pixels(whole.size(), pixels.collect())
}

/// Noise falls with the square root of samples; a little more than that predicts saves a round, and 4 times at most guards against a
/// first estimate that missed something.
fn next_goal(spp: u32, excess: f64) -> u32 {
    let predicted = f64::from(spp) * excess * excess * 1.1;
    predicted.clamp(f64::from(spp) * 1.25, f64::from(spp) * 4.0).ceil() as u32
}

fn judges(tracer: &Tracer, recipes: &[Recipe], frame: &Frame) -> BTreeMap<&'static str, Judge> {
    let coverage = frame.image(&Aov::Coverage.to_string()).map(|image| image.pixels.to_color());
    let part = |aov: &str| {
        let image = frame.image(aov).expect("an image that was asked for");
        let variance = image.variance.as_ref().map(Pixels::to_color).filter(|v| v.pixels().iter().all(|p| p.is_finite()));
        Part { name: image.name.clone(), image: image.pixels.to_color(), variance, settled: None }
    };
    let judge = |recipe: &Recipe| Judge {
        parts: if recipe.picture {
            let whole = part("beauty");
            vec![Part { image: simulated(tracer, frame, &whole.image), ..whole }]
        } else {
            (recipe.images)(tracer).iter().map(|aov| part(&aov.to_string())).collect()
        },
        mask: coverage.as_ref().filter(|_| recipe.kind != Kind::Light).map(mask),
        kind: recipe.kind,
        composed: recipe
            .composed
            .then(|| part("direct"))
            .map(|part| Composed { simulated: Some(simulated(tracer, frame, &part.image)), part }),
    };
    recipes.iter().map(|recipe| (recipe.role, judge(recipe))).collect()
}

fn mask(coverage: &Image<LinearRgb>) -> Image<bool> {
    coverage.map(|c| c[0] > 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Unwatched;
    use glam::UVec2;
    use kajo_scene::{LoadOptions, Snapshot, load};
    use kajo_units::Seconds;

    fn tracer(scene: &str) -> Tracer {
        let scene = load(scene, &LoadOptions::default()).unwrap();
        let snapshot = Snapshot::new(&scene, Seconds(0.0));
        Tracer::new(&scene, snapshot).unwrap()
    }

    fn settings() -> Settings {
        Settings { size: UVec2::new(32, 24), ..Settings::default() }
    }

    fn render_all(tracer: &Tracer, roles: &[&str], stop: ReferenceStop) -> References {
        references(tracer, roles, &settings(), stop, &Unwatched, &|f| f).unwrap().unwrap()
    }

    #[test]
    fn every_role_gets_its_judge_with_a_variance() {
        let tracer = tracer("builtin:shadows");
        let roles: Vec<&str> = judged_roles().collect();
        let found = render_all(&tracer, &roles, ReferenceStop::Spp(8));
        for role in roles {
            assert_eq!(found.renderings[role].spp, 8, "{role}");
            let judge = &found.judges[role];
            assert_eq!(judge.size(), UVec2::new(32, 24), "{role}");
            assert!(judge.stacked_variance().is_some(), "{role}");
        }
        let visibility = &found.judges["direct-visibility"];
        assert_eq!(visibility.parts.len(), tracer.snapshot().lights.len());
        assert_eq!(visibility.composed.as_ref().unwrap().part.name, "direct");
        assert!(visibility.composed.as_ref().unwrap().simulated.is_some());
    }

    /// What is left of all direct light without the sky is that of the lamps and the glowing mesh.
    #[test]
    fn emissive_meshes_are_judged_and_the_sky_is_told_apart() {
        let mut scene = load("builtin:cornell", &LoadOptions::default()).unwrap();
        let glow = scene.materials.iter().position(|m| !m.is_emissive()).unwrap();
        scene.materials[glow].emission = LinearRgb::splat(2.0);
        scene.environment = Some(kajo_scene::Environment::uniform(LinearRgb::splat(0.5)));
        let tracer = Tracer::new(&scene, Snapshot::new(&scene, Seconds(0.0))).unwrap();
        let found = render_all(&tracer, &["direct-visibility"], ReferenceStop::Spp(8));
        let judge = &found.judges["direct-visibility"];
        assert!(judge.parts.len() > scene.lights.len() && judge.parts.len() == judged_lights(&tracer).len());
        let composed = judge.composed.as_ref().unwrap();
        let sum = |image: &Image<LinearRgb>| image.pixels().iter().map(|p| p.luminance()).sum::<f32>();
        let (whole, simulated) = (sum(&composed.part.image), sum(composed.simulated.as_ref().unwrap()));
        assert!(simulated > 0.0 && simulated < 0.999 * whole, "{simulated} of {whole}");
    }

    #[test]
    fn more_samples_lower_the_floor_and_the_noise_stop_is_obeyed() {
        let tracer = tracer("builtin:penumbra");
        let floor = |stop| render_all(&tracer, &["direct-visibility"], stop).judges["direct-visibility"].floor();
        let (few, many) = (floor(ReferenceStop::Spp(16)), floor(ReferenceStop::Spp(256)));
        assert!(many < 0.5 * few && many > 0.0, "{few} {many}");
        let quiet = render_all(&tracer, &["direct-visibility"], ReferenceStop::Noise(0.01));
        assert!(
            quiet.judges["direct-visibility"].relative_standard_error().unwrap() <= 0.01 && quiet.renderings["direct-visibility"].spp > 16
        );
    }

    /// The area of the pixel, and no light of the sky on things: what the real-time renderer can draw.
    #[test]
    fn anti_aliasing_is_judged_by_the_area_of_pixels_without_what_is_not_simulated() {
        let mut scene = load("builtin:shadows", &LoadOptions::default()).unwrap();
        scene.environment = None;
        let make = |scene: &kajo_scene::Scene| {
            let tracer = Tracer::new(scene, Snapshot::new(scene, Seconds(0.0))).unwrap();
            render_all(&tracer, &["anti-alias", "direct-visibility"], ReferenceStop::Spp(32)).judges.remove("anti-alias").unwrap()
        };
        let black = make(&scene);
        scene.environment = Some(kajo_scene::Environment::uniform(LinearRgb::splat(0.5)));
        let lit = make(&scene);
        assert_eq!(black.parts[0].name, "beauty");
        let pairs = black.parts[0].image.pixels().iter().zip(lit.parts[0].image.pixels());
        let gains: Vec<f32> = pairs.map(|(a, b)| b.luminance() - a.luminance()).filter(|gain| *gain < 0.1).collect();
        let mean = gains.iter().sum::<f32>() / gains.len() as f32;
        // Left in, the light of the sky would add several tenths.
        assert!(gains.len() > 32 * 24 / 2 && mean.abs() < 0.005, "{} surfaces gain {mean}", gains.len());
    }

    /// Caught when a plan forgets an image, or counts light twice: the picture of direct light is what the path tracer sees with one bounce.
    #[test]
    fn a_plan_with_a_picture_judges_as_the_references_do() {
        let tracer = tracer("builtin:shadows");
        for role in judged_roles() {
            let plan = ReferencePlan::new(&tracer, role).unwrap().with_picture(Pictured::Direct);
            let settings = plan.settings(&tracer, &settings());
            let frame = render(&tracer, &settings, Stop::at_spp(4), None, &kajo_path_tracer::uncontrolled).unwrap().develop();
            let judge = &plan.judges(&tracer, &frame)[role];
            let expected = &render_all(&tracer, &[role], ReferenceStop::Spp(4)).judges[role];
            assert_eq!(judge.stacked(), expected.stacked(), "{role}");
            let picture = plan.picture(&frame).unwrap();
            let whole = ReferencePlan::new(&tracer, role).unwrap().with_picture(Pictured::Whole);
            assert_eq!(whole.settings(&tracer, &settings).integrator, Integrator::Path);
            if settings.integrator == Integrator::Direct {
                let largest = picture.pixels().iter().zip(frame.beauty().pixels()).map(|(a, b)| (*a - *b).0.abs().max_element());
                assert!(largest.fold(0.0, f32::max) < 1e-4, "{role}");
            }
        }
    }

    #[test]
    fn an_interruption_gives_nothing() {
        struct Stop;
        impl Progress for Stop {
            fn at(&self, _: &str, _: f64) {}
            fn interrupted(&self) -> bool {
                true
            }
        }
        let tracer = tracer("builtin:shadows");
        assert!(references(&tracer, &["direct-visibility"], &settings(), ReferenceStop::Spp(4), &Stop, &|f| f).unwrap().is_none());
    }

    #[test]
    fn next_goal_grows_by_what_the_noise_asks_within_bounds() {
        assert_eq!(next_goal(16, 1.5), 40);
        assert_eq!(next_goal(16, 100.0), 64);
        assert_eq!(next_goal(100, 1.001), 125);
    }
}
