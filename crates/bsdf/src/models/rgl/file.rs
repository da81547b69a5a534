//! The `.bsdf` files of the RGL material database: what their fields must be, and the table that they make.

use super::table::{Data, Table};
use super::tensor::{Array, Content, Shape, Tensors, is_tensor_file, to_bytes};
use super::warp::{Patches, Warp};
use crate::models::ModelError;
use crate::models::blocks::colorimetry::{VISIBLE_NM, rgb_weights};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};

/// Bytes of the largest file that is read: the largest of the database have about a tenth.
const MOST_BYTES: u64 = 1 << 30;
/// Angles of files are f32: what they may be off by, rad.
const ROUNDING: f64 = 1e-4;

impl Table {
    /// Reads a file.
    ///
    /// # Errors
    /// [`ModelError::File`] where it is missing or not such a table.
    pub fn read(path: &str) -> Result<Self, ModelError> {
        let wrong = |problem: String| ModelError::File { file: path.to_owned(), problem };
        let unreadable = |error| wrong(format!("cannot be read: {error}; give the path of a .bsdf file of the RGL material database"));
        let mut file = File::open(path).map_err(unreadable)?;
        // A film that was named by mistake is not read to its end.
        let mut bytes = Vec::new();
        file.by_ref().take(64).read_to_end(&mut bytes).map_err(unreadable)?;
        if is_tensor_file(&bytes) {
            bytes.clear();
            file.seek(SeekFrom::Start(0)).and_then(|_| file.take(MOST_BYTES + 1).read_to_end(&mut bytes)).map_err(unreadable)?;
        }
        if bytes.len() as u64 > MOST_BYTES {
            return Err(wrong(format!("has more than {MOST_BYTES} bytes, the most that is read; give the RGB version of the material")));
        }
        Self::from_bytes(&bytes).map_err(wrong)
    }

    /// Writes a file that every reader of the format understands, with colours in RGB.
    ///
    /// # Errors
    /// [`ModelError::File`] where that is not possible.
    pub fn write(&self, path: &str) -> Result<(), ModelError> {
        std::fs::write(path, self.to_bytes()).map_err(|error| ModelError::File {
            file: path.to_owned(),
            problem: format!("cannot be written: {error}; give a path in a folder that exists"),
        })
    }

    /// From the contents of a file.
    ///
    /// # Errors
    /// What is wrong with them, in one sentence.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        let tensors = Tensors::parse(bytes)?;
        let phi_i = angles(&tensors, "phi_i", [-TAU, TAU])?;
        let theta_i = angles(&tensors, "theta_i", [0.0, FRAC_PI_2])?;
        let viewers = [phi_i.len(), theta_i.len()];
        let ndf = grid(&tensors, "ndf")?;
        let sigma = grid(&tensors, "sigma")?;
        let (vndf_size, vndf) = slices(&tensors, "vndf", viewers)?;
        not_negative("vndf", &vndf)?;
        let (size, mut luminance) = slices(&tensors, "luminance", viewers)?;
        // Noise of the measurement; it decides nothing but where samples go.
        luminance.iter_mut().for_each(|v| *v = v.max(0.0));
        let jacobian = match tensors.bytes("jacobian")? {
            [flag] => *flag != 0,
            other => return Err(format!("its field `jacobian` has {} bytes, not one flag; fetch the file again", other.len())),
        };
        Self::new(Data {
            phi_i,
            theta_i,
            ndf,
            sigma,
            vndf: Warp::new(vndf_size, &vndf),
            luminance: Warp::new(size, &luminance),
            color: colors(&tensors, viewers, size)?,
            jacobian,
        })
    }

    /// The contents of a file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let data = self.data();
        let list = |values: &[f64]| Content::Numbers(Array { shape: vec![values.len()], data: values.iter().map(|v| *v as f32).collect() });
        let viewers = [data.phi_i.len(), data.theta_i.len()];
        let numbers = |leading: &[usize], patches: &Patches<1>| {
            let [columns, rows] = patches.size();
            let shape = leading.iter().copied().chain([rows, columns]).collect();
            Content::Numbers(Array { shape, data: patches.nodes().iter().map(|[v]| *v).collect() })
        };
        let [columns, rows] = data.color.size();
        let slices = data.color.nodes().chunks(columns * rows);
        let by_channel = slices.flat_map(|slice| (0..3).flat_map(move |channel| slice.iter().map(move |color| color[channel])));
        let rgb = Array { shape: vec![viewers[0], viewers[1], 3, rows, columns], data: by_channel.collect() };
        to_bytes(&[
            ("description", Content::Bytes(b"written by Kajo".to_vec())),
            ("phi_i", list(&data.phi_i)),
            ("theta_i", list(&data.theta_i)),
            ("sigma", numbers(&[], &data.sigma)),
            ("ndf", numbers(&[], &data.ndf)),
            ("vndf", numbers(&viewers, data.vndf.density())),
            ("luminance", numbers(&viewers, data.luminance.density())),
            ("rgb", Content::Numbers(rgb)),
            ("jacobian", Content::Bytes(vec![u8::from(data.jacobian)])),
        ])
    }
}

/// Rising angles in a range, rad.
fn angles(tensors: &Tensors, name: &str, [least, most]: [f64; 2]) -> Result<Vec<f64>, String> {
    let values = rising(tensors, name)?;
    match values.iter().find(|v| !(least - ROUNDING..=most + ROUNDING).contains(*v)) {
        Some(v) => Err(format!("its field `{name}` holds the angle {v}, not one from {least:.4} to {most:.4} rad; fetch the file again")),
        None => Ok(values),
    }
}

/// At least one number, each larger than the one before.
fn rising(tensors: &Tensors, name: &str) -> Result<Vec<f64>, String> {
    let values: Vec<f64> = tensors.numbers(name, 1)?.data.into_iter().map(f64::from).collect();
    if values.is_empty() {
        return Err(format!("its field `{name}` is empty; fetch the file again"));
    }
    match values.windows(2).find(|pair| pair[0] >= pair[1]) {
        Some(pair) => Err(format!("its field `{name}` does not rise: {} follows {}; fetch the file again", pair[1], pair[0])),
        None => Ok(values),
    }
}

/// Numbers ≥ 0 over azimuth and inclination.
fn grid(tensors: &Tensors, name: &str) -> Result<Patches<1>, String> {
    let Array { shape, data } = tensors.numbers(name, 2)?;
    let size = at_least_two(name, &shape)?;
    not_negative(name, &data)?;
    Ok(Patches::new(size, data.into_iter().map(|v| [v]).collect()))
}

/// A grid for each azimuth and inclination of the viewer: its size, and numbers.
fn slices(tensors: &Tensors, name: &str, viewers: [usize; 2]) -> Result<([usize; 2], Vec<f32>), String> {
    let Array { shape, data } = tensors.numbers(name, 4)?;
    same_viewers(name, &shape, viewers)?;
    Ok((at_least_two(name, &shape)?, data))
}

/// RGB for each viewer over the square of samples, spectra converted.
fn colors(tensors: &Tensors, viewers: [usize; 2], size: [usize; 2]) -> Result<Patches<3>, String> {
    let (name, weights) = if tensors.has("rgb") || !tensors.has("spectra") {
        ("rgb", vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    } else {
        let wavelengths = rising(tensors, "wavelengths")?;
        let [first, last] = VISIBLE_NM;
        if !wavelengths.iter().any(|nm| (first..=last).contains(nm)) {
            return Err(format!("its field `wavelengths` has none from {first} to {last} nm, so that the material has no colour"));
        }
        ("spectra", rgb_weights(&wavelengths))
    };
    let Array { shape, data } = tensors.numbers(name, 5)?;
    same_viewers(name, &shape, viewers)?;
    if shape[2] != weights.len() || [shape[4], shape[3]] != size {
        return Err(format!(
            "its field `{name}` has the shape {}, not … × {} × {} × {} as the others say; fetch the file again",
            Shape(&shape),
            weights.len(),
            size[1],
            size[0]
        ));
    }
    let nodes = size[0] * size[1];
    let mut colors = Vec::with_capacity(viewers[0] * viewers[1] * nodes);
    for slice in data.chunks(weights.len() * nodes) {
        colors.extend((0..nodes).map(|node| {
            let mut color = [0.0; 3];
            for (value, weight) in slice[node..].iter().step_by(nodes).zip(&weights) {
                (0..3).for_each(|channel| color[channel] += f64::from(*value) * weight[channel]);
            }
            // Weights have both signs, so that a sum may lie beyond what its terms can be.
            color.map(|channel| channel.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32)
        }));
    }
    Ok(Patches::new(size, colors))
}

fn same_viewers(name: &str, shape: &[usize], viewers: [usize; 2]) -> Result<(), String> {
    if shape[..2] == viewers {
        return Ok(());
    }
    let [phi, theta] = viewers;
    Err(format!(
        "its field `{name}` has the shape {}, not {phi} × {theta} × … as `phi_i` and `theta_i` say; fetch the file again",
        Shape(shape)
    ))
}

/// The last two lengths: along x, along y.
fn at_least_two(name: &str, shape: &[usize]) -> Result<[usize; 2], String> {
    match shape {
        [.., rows, columns] if *rows >= 2 && *columns >= 2 => Ok([*columns, *rows]),
        _ => Err(format!("its field `{name}` has the shape {}, too few nodes to interpolate between; fetch the file again", Shape(shape))),
    }
}

fn not_negative(name: &str, data: &[f32]) -> Result<(), String> {
    match data.iter().position(|v| *v < 0.0) {
        Some(at) => Err(format!("its field `{name}` holds {} at index {at}, which cannot be negative; fetch the file again", data[at])),
        None => Ok(()),
    }
}
