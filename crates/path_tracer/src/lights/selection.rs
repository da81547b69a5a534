//! Which light is looked for, and of a mesh which triangle.
//!
//! A tree over all of them decides, by how much light can arrive at the receiver \[Estevez18], \[Moreau19]: lights and meshes in the upper tree,
//! triangles in one tree a mesh, which its instances share. Lights at infinity stand beside the tree: it is one choice, each of them another, with
//! probability 0.9 · (share of the estimated power) + 0.1 / choices. `power` and `uniform` know no place and choose from tables.

use super::Emitter;
use crate::LightSampler;
use crate::world::World;
use glam::{Affine3A, Vec2};
use kajo_sampling::light_tree::{EmitterBounds, Entry, LightTree, Receiver, TwoLevelTree, is_similarity};
use kajo_sampling::{AliasTable, hash_u64};
use kajo_scene::EmissiveMesh;
use std::collections::HashMap;
use std::sync::Arc;

/// Share of choices that ignores power: estimates of power know nothing of distance and shadows.
const UNIFORM_CHOICE: f32 = 0.1;

/// Radiance that a mesh is given which was black wherever it was probed, as a share of the most that its material emits.
const UNSEEN: f32 = 1e-3;

/// Candidates at the first surface where lights at infinity are among them: of these the choice knows the power alone, not what part of the sky is
/// reflected there. Further on, where noise is less, another candidate costs more than it brings (docs/performance.md, Whole renders).
const FIRST_CANDIDATES: u32 = 2;

/// Chooses lights.
#[derive(Clone, Debug, Default)]
pub(super) struct Selection {
    by: LightSampler,
    /// The light, where there is one without triangles.
    only: Option<u32>,
    /// Chooses among `groups`; `None` without lights.
    table: Option<AliasTable>,
    /// Lights, and [`TREE`].
    groups: Vec<u32>,
    tree: Option<TwoLevelTree>,
    /// The light of each entry of the tree.
    lights: Vec<u32>,
    /// Where each light is chosen.
    places: Vec<Place>,
    /// An environment is chosen, or a light at infinity among others.
    far: bool,
}

/// In the place of a light, the tree.
const TREE: u32 = u32::MAX;

#[derive(Clone, Copy, Debug)]
enum Place {
    Never,
    Group(u32),
    Entry(u32),
}

/// A light that was chosen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chosen {
    /// Index of the light.
    pub light: u32,
    /// The triangle of a mesh, else 0.
    pub triangle: u32,
    /// Probability of the choice.
    pub pmf: f32,
    /// What is left of the random number; uniform in [0, 1).
    pub rest: f32,
}

impl Selection {
    /// `meshes` are those of the emissive instances, in the order of their lights.
    pub(super) fn new(by: LightSampler, emitters: &[Emitter], world: &World, meshes: &[EmissiveMesh]) -> Self {
        let mut selection = Self { by, places: vec![Place::Never; emitters.len()], ..Self::default() };
        // Powers, or numbers of emitters, of the groups.
        let mut weights = Vec::new();
        let (mut entries, mut tree_power) = (Vec::new(), 0.0);
        let mut objects = Objects { world, meshes: meshes.iter(), trees: HashMap::new() };
        for (index, emitter) in emitters.iter().enumerate() {
            let entry = if by.uses_tree() { objects.entry(emitter) } else { None };
            let Some(power) = emitter.power(world) else { continue };
            if let Some(entry) = entry {
                selection.places[index] = Place::Entry(entries.len() as u32);
                selection.lights.push(index as u32);
                entries.push(entry);
                tree_power += power;
                continue;
            }
            selection.places[index] = Place::Group(weights.len() as u32);
            selection.groups.push(index as u32);
            weights.push(match (by, emitter) {
                (LightSampler::Uniform, Emitter::Mesh(mesh)) => mesh.triangles().len() as f32,
                (LightSampler::Uniform, _) => 1.0,
                _ => power,
            });
        }
        if !entries.is_empty() {
            selection.groups.push(TREE);
            weights.push(tree_power);
            selection.tree = Some(TwoLevelTree::new(entries));
        }
        let chosen = match (&selection.groups[..], &selection.lights[..]) {
            (&[TREE], &[light]) | (&[light], []) => Some(light),
            _ => None,
        };
        selection.only = chosen.filter(|&light| !matches!(emitters[light as usize], Emitter::Mesh(_)));
        if by != LightSampler::Uniform {
            mix_with_uniform(&mut weights);
        }
        selection.table = AliasTable::new(&weights);
        selection.far = selection.groups.iter().filter(|&&light| light != TREE).any(|&light| match emitters[light as usize] {
            Emitter::Environment(_) => true,
            Emitter::Directional(_) => weights.len() > 1,
            _ => false,
        });
        selection
    }

    /// True where the choice can go by `by` from now on and the tree stays what it is.
    pub(super) fn change(&mut self, by: LightSampler) -> bool {
        let shared = self.by.uses_tree() && by.uses_tree();
        self.by = if shared { by } else { self.by };
        shared
    }

    pub(super) fn candidates(&self, bounces: u32) -> u32 {
        match self.by {
            LightSampler::Ris { candidates } => candidates.max(1),
            LightSampler::Bvh if bounces == 0 && self.far => FIRST_CANDIDATES,
            _ => 1,
        }
    }

    /// A light for the receiver by the number `choice`; what it has too few digits for is decided by hashing `u`. `None` where no light can arrive.
    #[inline]
    pub(super) fn choose(&self, emitters: &[Emitter], receiver: &Receiver, choice: f32, u: Vec2) -> Option<Chosen> {
        if let Some(light) = self.only {
            return Some(Chosen { light, triangle: 0, pmf: 1.0, rest: choice });
        }
        let (group, pmf, rest) = self.table.as_ref()?.sample_f64(with_more_digits(choice, u));
        let light = self.groups[group];
        if light == TREE {
            let found = self.tree.as_ref()?.sample(receiver, rest)?;
            return Some(Chosen {
                light: self.lights[found.entry],
                triangle: found.emitter as u32,
                pmf: pmf * found.pmf,
                rest: below_one(found.rest),
            });
        }
        let Emitter::Mesh(mesh) = &emitters[light as usize] else {
            return Some(Chosen { light, triangle: 0, pmf, rest: below_one(rest) });
        };
        let table = mesh.triangles();
        let (triangle, share, rest) = if self.by == LightSampler::Uniform {
            let n = table.len();
            let place = rest * n as f64;
            (place as usize, 1.0 / n as f32, place.fract())
        } else {
            table.sample_f64(rest)
        };
        Some(Chosen { light, triangle: triangle as u32, pmf: pmf * share, rest: below_one(rest) })
    }

    /// Probability with which [`Selection::choose`] chooses a light, of a mesh a triangle.
    #[inline]
    pub(super) fn pmf(&self, emitters: &[Emitter], receiver: &Receiver, light: u32, triangle: u32) -> f32 {
        if self.only == Some(light) {
            return 1.0;
        }
        let Some(table) = &self.table else { return 0.0 };
        match (self.places[light as usize], &self.tree, &emitters[light as usize]) {
            (Place::Entry(entry), Some(tree), _) => {
                // The tree is the last group.
                table.pmf(self.groups.len() - 1) * tree.pmf(receiver, entry as usize, triangle as usize)
            }
            (Place::Group(group), _, Emitter::Mesh(mesh)) => {
                let triangles = mesh.triangles();
                let uniform = self.by == LightSampler::Uniform;
                let share = if uniform { 1.0 / triangles.len() as f32 } else { triangles.pmf(triangle as usize) };
                table.pmf(group as usize) * share
            }
            (Place::Group(group), ..) => table.pmf(group as usize),
            _ => 0.0,
        }
    }
}

/// Powers become 0.9 · (share of the sum) + 0.1 / count.
fn mix_with_uniform(weights: &mut [f32]) {
    let (total, count): (f32, _) = (weights.iter().sum(), weights.len() as f32);
    let known = total > 0.0 && total.is_finite();
    for weight in weights {
        *weight = if known { (1.0 - UNIFORM_CHOICE) * *weight / total + UNIFORM_CHOICE / count } else { 1.0 };
    }
}

/// The 24 digits of a uniform number and as many more: probabilities in large trees and tables are finer than the former.
#[inline]
fn with_more_digits(x: f32, u: Vec2) -> f64 {
    let fine = hash_u64(u64::from(u.x.to_bits()) << 32 | u64::from(u.y.to_bits())) >> 40;
    (f64::from(x) + fine as f64 * (1.0 / (1u64 << 48) as f64)).min(1.0 - f64::EPSILON)
}

#[inline]
fn below_one(x: f64) -> f32 {
    (x as f32).min(1.0 - f32::EPSILON / 2.0)
}

/// Makes entries of the tree; instances of a mesh share its tree.
struct Objects<'a> {
    world: &'a World,
    meshes: std::slice::Iter<'a, EmissiveMesh>,
    /// By the index of the mesh in the snapshot.
    trees: HashMap<usize, Arc<LightTree>>,
}

impl Objects<'_> {
    /// `None` for what is at infinity or never chosen. Meshes come in the order of their lights.
    fn entry(&mut self, emitter: &Emitter) -> Option<Entry> {
        match emitter {
            Emitter::Point(light) => Some(Entry::Single(light.emitter_bounds())),
            Emitter::Area(light) => Some(Entry::Single(light.emitter_bounds())),
            Emitter::Mesh(_) => self.meshes.next().map(|mesh| self.object(mesh)),
            Emitter::Directional(_) | Emitter::Environment(_) | Emitter::Unlit => None,
        }
    }

    fn object(&mut self, light: &EmissiveMesh) -> Entry {
        let to_world = self.world.instances[light.instance].world_from_object;
        if !is_similarity(&to_world) {
            return Entry::Object { tree: Arc::new(self.tree(light, &to_world)), world_from_object: Affine3A::IDENTITY };
        }
        let mesh = self.world.snapshot.instances[light.instance].mesh;
        let tree = match self.trees.get(&mesh) {
            Some(tree) => tree.clone(),
            None => {
                let tree = Arc::new(self.tree(light, &Affine3A::IDENTITY));
                self.trees.insert(mesh, tree.clone());
                tree
            }
        };
        Entry::Object { tree, world_from_object: to_world }
    }

    /// The tree over the triangles, each moved by `transform`.
    fn tree(&self, light: &EmissiveMesh, transform: &Affine3A) -> LightTree {
        let placed = &self.world.instances[light.instance];
        let material = &self.world.scene.materials[placed.material as usize];
        let mirrored = transform.matrix3.determinant() < 0.0;
        // L A over all triangles, in the units of the tree.
        let scale2 = placed.world_from_object.matrix3.x_axis.length_squared() / transform.matrix3.x_axis.length_squared();
        let area = if *transform == Affine3A::IDENTITY { light.area / scale2 } else { light.area };
        let intensity = area * light.radiance.luminance().max(UNSEEN * material.emission.luminance());
        let emitters = light.choices.iter().enumerate().map(|(index, share)| {
            let [a, b, c] = placed.triangle(index as u32).map(|p| transform.transform_point3(p));
            let corners = if mirrored { [a, c, b] } else { [a, b, c] };
            EmitterBounds { intensity: share * intensity, ..EmitterBounds::triangle(corners, 1.0, light.double_sided) }
        });
        LightTree::new(emitters.collect())
    }
}
