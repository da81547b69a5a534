//! OpenEXR with named layers.
//!
//! A file is written as one part whose channels are `R`, `G`, `B` for the layer with the empty name and `name.R`, … for the others:
//! the naming that viewers (tev, Blender, djv, Nuke) group by. All channels are 32-bit float, so that ids up to 2²⁴, depths and variances
//! are exact; [`Precision::Half`] stores colour in 16 bits. Compression is ZIP, which loses nothing.

use crate::limits::check_declared;
use crate::{Image, ImageError, MAX_PIXELS, check_size, read_file, write_atomic};
use exr::prelude as x;
use exr::prelude::{ReadChannels, ReadLayers, WritableImage};
use glam::{IVec2, UVec2, Vec3};
use kajo_units::LinearRgb;
use std::collections::{BTreeMap, BTreeSet};
use std::io::Cursor;
use std::path::Path;

/// Every layer of an OpenEXR file, with its text metadata.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExrFile {
    /// Width and height of every channel, px.
    pub size: UVec2,
    /// Layers; the one named "" is the picture.
    pub layers: Vec<Layer>,
    /// Text attributes.
    pub metadata: BTreeMap<String, String>,
}

/// A group of channels.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// `""`, `albedo`, `visibility.key`, …; may contain dots.
    pub name: String,
    /// Channel name without the layer's, and `height × width` values, row-major.
    pub channels: Vec<(String, Vec<f32>)>,
}

/// Storage of colour channels; all others are always float.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// 32 bits.
    #[default]
    Float,
    /// 16 bits: 11 significant bits, at most 65 504.
    Half,
}

/// Values, over all parts and channels, that a file may hold for each pixel that its picture may have: 8.6 GB of floats at [`MAX_PIXELS`].
const VALUES_PER_PIXEL: u64 = 8;

/// Keys we write are `kajo:KEY`, which cannot collide with the attributes OpenEXR defines.
const METADATA_PREFIX: &str = "kajo:";

impl Layer {
    /// Channels R, G, B.
    pub fn color(name: impl Into<String>, image: &Image<LinearRgb>) -> Self {
        let channel = |c: usize| image.pixels().iter().map(|p| p[c]).collect();
        Self { name: name.into(), channels: vec![("R".into(), channel(0)), ("G".into(), channel(1)), ("B".into(), channel(2))] }
    }

    /// One channel, named `Y` (viewers show it in grey).
    pub fn scalar(name: impl Into<String>, image: &Image<f32>) -> Self {
        Self { name: name.into(), channels: vec![("Y".into(), image.pixels().to_vec())] }
    }

    /// Channels X, Y, Z: a direction or a position.
    pub fn vector(name: impl Into<String>, image: &Image<Vec3>) -> Self {
        let channel = |c: usize| image.pixels().iter().map(|p| p[c]).collect();
        Self { name: name.into(), channels: vec![("X".into(), channel(0)), ("Y".into(), channel(1)), ("Z".into(), channel(2))] }
    }

    /// The values of one channel.
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        self.channels.iter().find(|(n, _)| n == name).map(|(_, values)| values.as_slice())
    }

    fn full_name(&self, channel: &str) -> String {
        if self.name.is_empty() { channel.to_owned() } else { format!("{}.{channel}", self.name) }
    }
}

impl ExrFile {
    /// A file without layers.
    pub fn new(size: UVec2) -> Self {
        Self { size, ..Self::default() }
    }

    /// The layer of that name.
    pub fn layer(&self, name: &str) -> Option<&Layer> {
        self.layers.iter().find(|layer| layer.name == name)
    }

    /// The colour of the layer of that name: R, G, B, or Y as grey.
    pub fn color(&self, name: &str) -> Option<Image<LinearRgb>> {
        let layer = self.layer(name)?;
        let rgb = ["R", "G", "B"].map(|c| layer.channel(c));
        let pixels = match (rgb, layer.channel("Y")) {
            ([Some(r), Some(g), Some(b)], _) => (0..r.len()).map(|i| LinearRgb::new(r[i], g[i], b[i])).collect(),
            (_, Some(y)) => y.iter().map(|&y| LinearRgb::splat(y)).collect(),
            _ => return None,
        };
        Some(Image::from_pixels(self.size, pixels))
    }

    /// Writes with float precision, see [`Self::write_with`].
    ///
    /// # Errors
    /// Those of [`Self::write_with`].
    pub fn write(&self, path: &Path) -> Result<(), ImageError> {
        self.write_with(path, Precision::Float)
    }

    /// Writes atomically; NaN and infinity are kept.
    ///
    /// # Errors
    /// A size outside the limits, a channel of another length, a name given twice, and those of [`write_atomic`].
    pub fn write_with(&self, path: &Path, precision: Precision) -> Result<(), ImageError> {
        write_atomic(path, &self.encode(path, precision)?)
    }

    fn encode(&self, path: &Path, precision: Precision) -> Result<Vec<u8>, ImageError> {
        check_size(self.size)?;
        let mut names = BTreeSet::new();
        let mut channels: x::SmallVec<[x::AnyChannel<x::FlatSamples>; 4]> = x::SmallVec::new();
        for layer in &self.layers {
            for (name, values) in &layer.channels {
                let channel = layer.full_name(name);
                let expected = self.size.x as usize * self.size.y as usize;
                if values.len() != expected {
                    return Err(ImageError::ChannelLength { channel, got: values.len(), expected });
                }
                if !names.insert(channel.clone()) {
                    return Err(ImageError::DuplicateChannel { channel });
                }
                channels.push(x::AnyChannel::new(text(&channel), samples(name, values, precision)));
            }
        }
        let attributes = x::LayerAttributes { software_name: Some(text("Kajo")), ..x::LayerAttributes::default() };
        let encoding = x::Encoding { compression: x::Compression::ZIP16, ..x::Encoding::FAST_LOSSLESS };
        let encoding = x::Encoding { blocks: x::Blocks::ScanLines, line_order: x::LineOrder::Increasing, ..encoding };
        let size = (self.size.x as usize, self.size.y as usize);
        let layer = x::Layer::new(size, attributes, encoding, x::AnyChannels::sort(channels));
        let mut image = x::Image::from_layer(layer);
        for (key, value) in &self.metadata {
            image.attributes.other.insert(text(&format!("{METADATA_PREFIX}{key}")), x::AttributeValue::Text(text(value)));
        }
        let mut bytes = Cursor::new(Vec::new());
        image.write().to_buffered(&mut bytes).map_err(|e| ImageError::from_write(path, 0, std::io::Error::other(e)))?;
        Ok(bytes.into_inner())
    }

    /// True for bytes that begin like an EXR file.
    pub fn recognises(bytes: &[u8]) -> bool {
        bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01])
    }

    /// Reads every layer of any part. Channels of a part with a smaller window stand in the display window, 0 around them.
    ///
    /// # Errors
    /// A missing or malformed file, deep or subsampled channels (not supported), a size outside the limits.
    pub fn read(path: &Path) -> Result<Self, ImageError> {
        let bytes = read_file(path).map_err(|reason| ImageError::Read { path: path.to_path_buf(), reason })?;
        Self::decode(path, &bytes)
    }

    /// [`Self::read`] of bytes in memory; `path` only names them in messages.
    ///
    /// # Errors
    /// Those of [`Self::read`].
    pub fn decode(path: &Path, bytes: &[u8]) -> Result<Self, ImageError> {
        Self::decode_within(path, bytes, MAX_PIXELS)
    }

    /// [`Self::decode`] that refuses parts of more than `max_pixels` and, over all parts, more than [`VALUES_PER_PIXEL`] times as many values.
    pub(crate) fn decode_within(path: &Path, bytes: &[u8], max_pixels: u64) -> Result<Self, ImageError> {
        let malformed = |e: exr::error::Error| ImageError::Malformed {
            path: path.to_path_buf(),
            format: "OpenEXR",
            reason: match e {
                exr::error::Error::NotSupported(what) => format!("{what} is not supported"),
                other => other.to_string(),
            },
        };
        let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(malformed)?;
        let mut values = 0u64;
        for header in &meta.headers {
            let mut largest = 0u64;
            for size in [header.layer_size, header.shared_attributes.display_window.size] {
                let side = |v: usize| u32::try_from(v).unwrap_or(u32::MAX);
                check_declared(path, UVec2::new(side(size.x()), side(size.y())), max_pixels)?;
                largest = largest.max(size.area() as u64);
            }
            values = largest.saturating_mul(header.channels.list.len() as u64).saturating_add(values);
        }
        let max_values = VALUES_PER_PIXEL * max_pixels.min(MAX_PIXELS);
        if values > max_values {
            return Err(ImageError::TooManyValues { path: path.to_path_buf(), values, max_values });
        }
        let image = x::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .all_layers()
            .all_attributes()
            .from_buffered(Cursor::new(bytes))
            .map_err(malformed)?;
        Ok(Self::from_parts(image))
    }

    fn from_parts(image: x::Image<x::Layers<x::AnyChannels<x::FlatSamples>>>) -> Self {
        let window = image.attributes.display_window;
        let mut file = Self::new(UVec2::new(window.size.x() as u32, window.size.y() as u32));
        file.metadata = text_attributes(&image.attributes.other);
        let several = image.layer_data.len() > 1;
        for part in image.layer_data {
            file.metadata.extend(text_attributes(&part.attributes.other));
            let part_name = part.attributes.layer_name.as_ref().filter(|_| several).map(string);
            let position = part.attributes.layer_position - window.position;
            let origin = IVec2::new(position.x(), position.y());
            let part_size = UVec2::new(part.size.x() as u32, part.size.y() as u32);
            for channel in part.channel_data.list {
                let mut name = string(&channel.name);
                if let Some(prefix) = part_name.as_deref().filter(|prefix| !name.starts_with(&format!("{prefix}."))) {
                    name = format!("{prefix}.{name}");
                }
                let (layer, channel_name) = name.rsplit_once('.').unwrap_or(("", &name));
                let values: Vec<f32> = match channel.sample_data {
                    x::FlatSamples::F32(values) => values,
                    other => other.values_as_f32().collect(),
                };
                let values =
                    if origin == IVec2::ZERO && part_size == file.size { values } else { placed(file.size, origin, part_size, &values) };
                match file.layers.iter_mut().find(|l| l.name == layer) {
                    Some(found) => found.channels.push((channel_name.to_owned(), values)),
                    None => file.layers.push(Layer { name: layer.to_owned(), channels: vec![(channel_name.to_owned(), values)] }),
                }
            }
        }
        file.layers.iter_mut().for_each(|layer| layer.channels.sort_by_key(|(name, _)| channel_order(name)));
        file
    }

    /// The picture of the file: the layer "", else the first one with colour.
    pub(crate) fn into_color(self, path: &Path) -> Result<Image<LinearRgb>, ImageError> {
        let first = || self.layers.iter().find_map(|layer| self.color(&layer.name));
        self.color("").or_else(first).ok_or_else(|| ImageError::NoColor {
            path: path.to_path_buf(),
            found: self.layers.iter().flat_map(|l| l.channels.iter().map(|(c, _)| l.full_name(c))).collect(),
        })
    }
}

fn samples(name: &str, values: &[f32], precision: Precision) -> x::FlatSamples {
    if precision == Precision::Half && matches!(name, "R" | "G" | "B") {
        x::FlatSamples::F16(values.iter().map(|&v| half::f16::from_f32(v)).collect())
    } else {
        x::FlatSamples::F32(values.to_vec())
    }
}

/// A part's window pasted into the display window.
fn placed(size: UVec2, origin: IVec2, part_size: UVec2, values: &[f32]) -> Vec<f32> {
    let mut out = vec![0.0; size.x as usize * size.y as usize];
    for y in 0..part_size.y {
        let Some(row) = inside(origin.y, y, size.y) else { continue };
        for x in 0..part_size.x {
            if let Some(column) = inside(origin.x, x, size.x) {
                out[row * size.x as usize + column] = values[(y * part_size.x + x) as usize];
            }
        }
    }
    out
}

fn inside(origin: i32, offset: u32, size: u32) -> Option<usize> {
    let at = i64::from(origin) + i64::from(offset);
    (0..i64::from(size)).contains(&at).then_some(at as usize)
}

/// R, G, B, A before the others, which keep the alphabet.
fn channel_order(name: &str) -> (usize, String) {
    (["R", "G", "B", "A"].iter().position(|c| *c == name).unwrap_or(4), name.to_owned())
}

fn text_attributes(attributes: &std::collections::HashMap<x::Text, x::AttributeValue>) -> BTreeMap<String, String> {
    let texts = attributes.iter().filter_map(|(key, value)| match value {
        x::AttributeValue::Text(value) => Some((string(key), string(value))),
        _ => None,
    });
    texts.map(|(key, value)| (key.strip_prefix(METADATA_PREFIX).map_or(key.clone(), str::to_owned), value)).collect()
}

/// OpenEXR text is bytes, by custom UTF-8; the library takes one character a byte.
fn text(utf8: &str) -> x::Text {
    x::Text::from(utf8.bytes().map(char::from).collect::<String>().as_str())
}

fn string(text: &x::Text) -> String {
    String::from_utf8_lossy(text.as_slice()).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(size: UVec2, scale: f32) -> Vec<f32> {
        (0..size.x * size.y).map(|i| i as f32 * scale).collect()
    }

    fn example() -> ExrFile {
        let size = UVec2::new(37, 21);
        let mut file = ExrFile::new(size);
        file.layers.push(Layer::color("", &Image::from_fn(size, |x, y| LinearRgb::new(x as f32 / 7.0, y as f32 * 1e5, -1.5))));
        file.layers.push(Layer::scalar("instance_id", &Image::from_pixels(size, ramp(size, 21_000.0))));
        file.layers.push(Layer::vector("normal", &Image::from_fn(size, |x, y| Vec3::new(x as f32, y as f32, f32::NEG_INFINITY))));
        file.layers.push(Layer { name: "visibility.key light".into(), channels: vec![("V".into(), ramp(size, 1e-3))] });
        file.metadata = BTreeMap::from([("scene".into(), "Kylä ☀".into()), ("owner".into(), "nobody".into()), ("spp".into(), "64".into())]);
        file
    }

    #[test]
    fn every_layer_and_the_metadata_round_trip() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.exr");
        let mut expected = example();
        expected.write(&path).unwrap();
        let mut read = ExrFile::read(&path).unwrap();
        read.layers.sort_by(|a, b| a.name.cmp(&b.name));
        expected.layers.sort_by(|a, b| a.name.cmp(&b.name));
        assert_eq!(read, expected);
        assert_eq!(crate::read_image(&path).unwrap(), expected.color("").unwrap());
    }

    #[test]
    fn half_precision_touches_colour_only() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.exr");
        example().write_with(&path, Precision::Half).unwrap();
        let read = ExrFile::read(&path).unwrap();
        assert_eq!(read.layer("instance_id"), example().layer("instance_id"));
        let (a, b) = (read.color("").unwrap(), example().color("").unwrap());
        assert_eq!(a.get(5, 0)[0], half::f16::from_f32(b.get(5, 0)[0]).to_f32());
        assert_ne!(a.get(5, 0)[0], b.get(5, 0)[0]);
    }

    #[test]
    fn channels_have_the_names_viewers_group_by() {
        let bytes = example().encode(Path::new("a"), Precision::Float).unwrap();
        let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(&bytes), true).unwrap();
        assert_eq!(meta.headers.len(), 1, "one part");
        let names: Vec<_> = meta.headers[0].channels.list.iter().map(|c| c.name.to_string()).collect();
        assert_eq!(names, ["B", "G", "R", "instance_id.Y", "normal.X", "normal.Y", "normal.Z", "visibility.key light.V"]);
    }

    #[test]
    fn cropped_part_stands_in_the_display_window() {
        let channels =
            x::AnyChannels::sort(x::SmallVec::from_vec(vec![x::AnyChannel::new("Y", x::FlatSamples::F32(vec![1.0, 2.0, 3.0, 4.0]))]));
        let mut attributes = x::LayerAttributes::named("crop");
        attributes.layer_position = x::Vec2(2, -1);
        let mut image = x::Image::from_layer(x::Layer::new((2, 2), attributes, x::Encoding::UNCOMPRESSED, channels));
        image.attributes.display_window = x::IntegerBounds::from_dimensions((4, 3));
        let mut bytes = Cursor::new(Vec::new());
        image.write().to_buffered(&mut bytes).unwrap();
        let read = crate::decode_image(Path::new("a"), bytes.get_ref()).unwrap();
        assert_eq!(read.size(), UVec2::new(4, 3));
        assert_eq!(read.pixels().iter().map(|p| p[0]).collect::<Vec<_>>(), [0., 0., 3., 4., 0., 0., 0., 0., 0., 0., 0., 0.]);
    }

    #[test]
    fn mistakes_of_the_caller_are_sentences() {
        let mut file = ExrFile::new(UVec2::new(2, 2));
        file.layers.push(Layer { name: "depth".into(), channels: vec![("Z".into(), vec![0.0; 3])] });
        let message = file.write(Path::new("a.exr")).unwrap_err().to_string();
        assert_eq!(message, "channel depth.Z has 3 values, but the file's size asks for 4");
        file.layers[0].channels = vec![("Z".into(), vec![0.0; 4]), ("Z".into(), vec![0.0; 4])];
        assert!(matches!(file.write(Path::new("a.exr")), Err(ImageError::DuplicateChannel { .. })));
        file.layers[0].channels.pop();
        let bytes = file.encode(Path::new("a"), Precision::Float).unwrap();
        let message = crate::decode_image(Path::new("a.exr"), &bytes).unwrap_err().to_string();
        assert!(message.contains("found depth.Z"), "{message}");
        assert!(matches!(ExrFile::decode(Path::new("a.exr"), &bytes[..bytes.len() / 2]), Err(ImageError::Malformed { .. })));
    }

    #[test]
    fn the_limit_holds_for_all_parts_together() {
        let part = |name: &str| {
            let channel = |channel: u32| x::AnyChannel::new(format!("c{channel}").as_str(), x::FlatSamples::F32(vec![0.5; 4]));
            let channels = x::AnyChannels::sort((0..5).map(channel).collect());
            x::Layer::new((4, 1), x::LayerAttributes::named(name), x::Encoding::UNCOMPRESSED, channels)
        };
        let bytes = |parts: &[&str]| {
            let parts: x::Layers<_> = parts.iter().map(|name| part(name)).collect();
            let image = x::Image::from_layers(x::ImageAttributes::with_size((4, 1)), parts);
            let mut bytes = Cursor::new(Vec::new());
            image.write().to_buffered(&mut bytes).unwrap();
            bytes.into_inner()
        };
        let decode = |parts: &[&str], max_pixels| ExrFile::decode_within(Path::new("a.exr"), &bytes(parts), max_pixels);
        assert_eq!(decode(&["a", "b"], 5).unwrap().layers.len(), 2);
        assert_eq!(decode(&["a"], 4).unwrap().layers.len(), 1, "20 values are within 32");
        let message = decode(&["a", "b"], 4).unwrap_err().to_string();
        assert!(message.starts_with("a.exr declares 40 values in the channels of all its parts; the limit is 32;"), "{message}");
    }

    #[test]
    fn a_file_without_layers_is_refused() {
        assert!(ExrFile::new(UVec2::ONE).encode(Path::new("a.exr"), Precision::Float).is_err());
    }
}
