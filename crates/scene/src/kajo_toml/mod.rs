//! `.kajo.toml` scenes: assets with transforms, light, cameras and replaced materials in one file.    docs/scene-format.md

mod camera;
mod format;
mod light;
mod material;
mod placement;
mod reflectance;
mod source;
#[cfg(test)]
mod tests;

use crate::decode::{self, Decoded, Encoded};
use crate::limits::{Budget, ImportLimits};
use crate::{
    Animation, ColorSpace, Environment, Filter, Ignored, Node, Scene, SceneError, Texture, TextureImage, Transform, Wrap, load_environment,
};
use format::{Asset, Choice, EnvironmentTable, File, MaterialTable, TextureTable};
use glam::Vec3;
use kajo_names::UnknownName;
use kajo_units::{LinearRgb, Radians};
use placement::{ANY, FROM_ZERO};
use source::{Source, Table};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Files that name each other in a circle end here.
const DEEPEST_NESTING: usize = 8;

/// Loads a `.kajo.toml` file and everything it names, relative to itself.
///
/// # Errors
/// A missing file; a line that is no TOML, an unknown key (the nearest one is offered), a value out of range, each with line and column; an asset,
/// environment or texture that cannot be loaded; a name of an asset, node, animation or material that does not exist.
pub fn load_kajo_toml(path: &Path) -> Result<Scene, SceneError> {
    load_nested(path, 0)
}

pub(crate) fn load_nested(path: &Path, depth: usize) -> Result<Scene, SceneError> {
    let file = path.display().to_string();
    if depth > DEEPEST_NESTING {
        let problem = format!("scene files are nested more than {DEEPEST_NESTING} deep; does one name itself?");
        return Err(SceneError::invalid(&file, "file", problem));
    }
    let bytes = kajo_image::read_file(path).map_err(|source| SceneError::Read { file: file.clone(), source })?;
    let text = String::from_utf8(bytes).map_err(|error| {
        SceneError::invalid(&file, format!("byte {}", error.utf8_error().valid_up_to()), "it is not UTF-8 text; save it as UTF-8")
    })?;
    compose(&file, &text, Some(path.parent().unwrap_or(Path::new(""))), depth)
}

/// [`load_kajo_toml`] of a text that names no other file; `file` only names it in messages.
///
/// # Errors
/// Those of [`load_kajo_toml`]; any use of another file.
pub fn parse_kajo_toml(file: &str, text: &str) -> Result<Scene, SceneError> {
    compose(file, text, None, 0)
}

fn compose(file: &str, text: &str, directory: Option<&Path>, depth: usize) -> Result<Scene, SceneError> {
    let source = Source { file, text };
    let parsed: File = toml::from_str(text).map_err(|error| source.refused(&error))?;
    let mut composer = Composer { source, directory, depth, scene: Scene::default(), assets: Vec::new(), images: HashMap::new() };
    composer.scene.name = file.into();
    composer.run(parsed)?;
    Ok(composer.scene)
}

/// A scene in the making.
struct Composer<'a> {
    source: Source<'a>,
    directory: Option<&'a Path>,
    depth: usize,
    scene: Scene,
    assets: Vec<Placed>,
    images: HashMap<PathBuf, usize>,
}

/// What an asset became.
struct Placed {
    name: String,
    nodes: std::ops::Range<usize>,
    materials: std::ops::Range<usize>,
}

impl Composer<'_> {
    fn run(&mut self, file: File) -> Result<(), SceneError> {
        if let Some(exposure) = file.exposure {
            let table = self.source.table("scene", None, 0..0);
            self.scene.exposure = Some(table.number("exposure", exposure, -64.0..=64.0)?);
        }
        // Cameras and lights of the file come first, so that its first camera is camera 0.
        let mut attached = Vec::new();
        for (index, camera) in file.camera.iter().enumerate() {
            let (table, values) = (self.source.table("camera", camera.get_ref().name.as_deref(), camera.span()), camera.get_ref());
            let (camera, transform) = camera::read(&table, values, index)?;
            let node = Node { name: camera.name.clone(), transform, camera: Some(self.scene.cameras.len()), ..Node::default() };
            self.scene.cameras.push(camera);
            self.add_node(node, values.node.clone(), table, &mut attached);
        }
        for (index, light) in file.light.iter().enumerate() {
            let (table, values) = (self.source.table("light", light.get_ref().name.as_deref(), light.span()), light.get_ref());
            let (light, transform) = light::read(&table, values, index)?;
            let node = Node { name: light.name.clone(), transform, light: Some(self.scene.lights.len()), ..Node::default() };
            self.scene.lights.push(light);
            self.add_node(node, values.node.clone(), table, &mut attached);
        }
        if let Some(environment) = &file.environment {
            let table = self.source.table("environment", None, environment.span());
            self.scene.environment = Some(self.environment(&table, environment.get_ref())?);
        }
        let mut playing = Animation { name: "composed".into(), channels: Vec::new() };
        for asset in &file.asset {
            let table = self.source.table("asset", Some(asset.get_ref().name.as_deref().unwrap_or(&asset.get_ref().file)), asset.span());
            self.asset(&table, asset.get_ref(), &mut playing)?;
        }
        if !playing.channels.is_empty() {
            self.scene.animations = vec![playing];
        }
        for (node, target, table) in attached {
            self.scene.nodes[node].parent = Some(self.find_node(&table, &target)?);
        }
        for material in &file.material {
            let table = self.source.table("material", Some(&material.get_ref().name), material.span());
            self.material(&table, material.get_ref())?;
        }
        Ok(())
    }

    fn add_node<'t>(&mut self, node: Node, on: Option<String>, table: Table<'t>, attached: &mut Vec<(usize, String, Table<'t>)>) {
        if let Some(on) = on {
            attached.push((self.scene.nodes.len(), on, table));
        }
        self.scene.nodes.push(node);
    }

    /// A node of an asset by name.
    fn find_node(&self, table: &Table, name: &str) -> Result<usize, SceneError> {
        let first = self.assets.first().map_or(self.scene.nodes.len(), |asset| asset.nodes.start);
        let found = (first..self.scene.nodes.len()).find(|&index| self.scene.nodes[index].name == name);
        found.ok_or_else(|| {
            let known: Vec<&str> = self.scene.nodes[first..].iter().map(|node| node.name.as_str()).collect();
            table.error(UnknownName::new("node", name, &known).to_string())
        })
    }

    fn path(&self, table: &Table, file: &str) -> Result<PathBuf, SceneError> {
        match self.directory {
            Some(directory) => Ok(directory.join(file)),
            None => Err(table.error(format!("`{file}`: no other file is opened here"))),
        }
    }

    fn environment(&mut self, table: &Table, values: &EnvironmentTable) -> Result<Environment, SceneError> {
        let scale = LinearRgb(table.numbers("scale", values.scale.map_or([1.0; 3], |c| c.0), FROM_ZERO)?.into());
        let rotation = Radians::from_degrees(table.number("rotation_deg", values.rotation_deg.unwrap_or(0.0), ANY)?);
        match (&values.file, values.radiance) {
            (Some(file), None) => {
                let (environment, ignored) = load_environment(&self.path(table, file)?)?;
                self.scene.ignored.extend(ignored);
                Ok(Environment { scale, rotation, ..environment })
            }
            (None, Some(radiance)) => {
                let radiance = LinearRgb(table.numbers("radiance", radiance.0, FROM_ZERO)?.into());
                Ok(Environment { rotation, ..Environment::uniform(radiance * scale) })
            }
            (Some(_), Some(_)) => Err(table.error("`file` and `radiance` exclude each other; keep one")),
            (None, None) => Err(table.error("give `file`, or `radiance` for a uniform environment")),
        }
    }

    fn asset(&mut self, table: &Table, asset: &Asset, playing: &mut Animation) -> Result<(), SceneError> {
        let translation = Vec3::from_array(table.numbers("translate", asset.translate.unwrap_or_default(), ANY)?);
        let scale = Vec3::from_array(table.numbers("scale", asset.scale.map_or([1.0; 3], |s| s.0), ANY)?);
        let rotation = placement::rotation(table, asset.rotate_deg)?;
        let offset = table.number("time_offset", asset.time_offset.unwrap_or(0.0), ANY)?;
        let mut imported = match asset.file.strip_prefix("builtin:") {
            Some(_) if self.directory.is_none() => return Err(table.error(format!("`{}`: no other file is opened here", asset.file))),
            Some(name) => crate::builtin::load(name)?,
            None => crate::load::import(&self.path(table, &asset.file)?, self.depth + 1)?,
        };
        let choice = choose_animation(table, asset.animation.as_ref(), &imported)?;
        let animations = std::mem::take(&mut imported.animations);

        let name = asset.name.clone().unwrap_or_else(|| asset.file.clone());
        if self.assets.iter().any(|other| other.name == name) {
            return Err(table.error("another asset has this name; give each its own `name`"));
        }
        let root = self.scene.nodes.len();
        let materials = self.scene.materials.len();
        let transform = Transform::Trs { translation, rotation, scale };
        self.scene.nodes.push(Node { name: name.clone(), transform, ..Node::default() });
        let base = self.scene.append(imported, Some(root));
        if let Some(animation) = choice.map(|index| &animations[index]) {
            playing.channels.extend(animation.channels.iter().cloned().map(|mut channel| {
                channel.node += base;
                channel.times.iter_mut().for_each(|time| *time -= offset);
                channel
            }));
        }
        self.assets.push(Placed { name, nodes: root..self.scene.nodes.len(), materials: materials..self.scene.materials.len() });
        Ok(())
    }

    fn material(&mut self, table: &Table, values: &MaterialTable) -> Result<(), SceneError> {
        let range = match &values.asset {
            None => 0..self.scene.materials.len(),
            Some(name) => match self.assets.iter().find(|asset| asset.name == *name) {
                Some(asset) => asset.materials.clone(),
                None => {
                    let known: Vec<&str> = self.assets.iter().map(|asset| asset.name.as_str()).collect();
                    return Err(table.error(UnknownName::new("asset", name, &known).to_string()));
                }
            },
        };
        let matching: Vec<usize> = range.clone().filter(|&index| self.scene.materials[index].name == values.name).collect();
        if matching.is_empty() {
            let known: Vec<&str> = range.map(|index| self.scene.materials[index].name.as_str()).collect();
            return Err(table.error(UnknownName::new("material", &values.name, &known).to_string()));
        }
        let model = reflectance::read(table, values, &|file| self.path(table, file))?;
        for index in matching {
            let mut material = self.scene.materials[index].clone();
            if let Some(model) = &model {
                material = model.replace_reflection(material);
            }
            material::apply(table, values, &mut material, &mut |texture, wrap, filter, color_space| {
                self.texture(table, texture, wrap, filter, color_space)
            })?;
            self.scene.materials[index] = material;
        }
        Ok(())
    }

    fn texture(
        &mut self,
        table: &Table,
        texture: &TextureTable,
        wrap: [Wrap; 2],
        filter: Filter,
        color_space: ColorSpace,
    ) -> Result<usize, SceneError> {
        let path = self.path(table, &texture.file)?;
        let image = match self.images.get(&path) {
            Some(&image) => image,
            None => {
                let image = read_image(&path, &mut self.scene.ignored)?;
                self.scene.images.push(Arc::new(image));
                self.images.insert(path, self.scene.images.len() - 1);
                self.scene.images.len() - 1
            }
        };
        let texture = Texture { image, wrap, filter, color_space };
        Ok(self.scene.textures.iter().position(|known| *known == texture).unwrap_or_else(|| {
            self.scene.textures.push(texture);
            self.scene.textures.len() - 1
        }))
    }
}

fn read_image(path: &Path, ignored: &mut Vec<Ignored>) -> Result<TextureImage, SceneError> {
    let file = path.display().to_string();
    let bytes = kajo_image::read_file(path).map_err(|source| SceneError::Read { file: file.clone(), source })?;
    let name = path.file_name().map_or_else(|| file.clone(), |name| name.to_string_lossy().into_owned());
    let encoded = Encoded { file: &file, place: "image".into(), name, bytes: &bytes };
    let Decoded { image, note } = decode::decode(&encoded, &Budget::new(ImportLimits::default()))?;
    let note = note.map(|(feature, consequence)| Ignored {
        file,
        place: "image".into(),
        feature: feature.into(),
        consequence: consequence.into(),
    });
    ignored.extend(note);
    Ok(image)
}

/// The animation of an asset that plays: the one asked for, else the first.
fn choose_animation(table: &Table, choice: Option<&Choice>, scene: &Scene) -> Result<Option<usize>, SceneError> {
    let count = scene.animations.len();
    match choice {
        Some(Choice::None) => Ok(None),
        None => Ok((scene.animation < count).then_some(scene.animation)),
        Some(Choice::Number(number)) if *number < count => Ok(Some(*number)),
        Some(Choice::Number(number)) => Err(table.error(format!("`animation` is {number}, but the asset has {count}, counted from 0"))),
        Some(Choice::Name(name)) => scene.animations.iter().position(|a| a.name == *name).map(Some).ok_or_else(|| {
            let known: Vec<&str> = scene.animations.iter().map(|a| a.name.as_str()).collect();
            table.error(UnknownName::new("animation", name, &known).to_string())
        }),
    }
}
