//! Renders, draws and writes for the plates of a gallery.

use crate::GalleryError;
use crate::stage::Stage;
use base64::Engine;
use glam::UVec2;
use kajo_bsdf_lab::figures::Figure;
use kajo_bsdf_lab::plot::{self, Map};
use kajo_image::{ExrFile, Image, Layer, ToneMap, encode_png, tone_map};
use kajo_path_tracer::{Frame, Settings, Stop, render};
use kajo_units::{LinearRgb, Srgb8};
use std::collections::BTreeMap;
use std::io;
use std::ops::ControlFlow;
use std::path::PathBuf;

/// Where the files of a gallery go.
pub trait Folder {
    /// Where to write the file that will be `name` (relative).
    ///
    /// # Errors
    /// When there is no such place.
    fn place(&mut self, name: &str) -> io::Result<PathBuf>;
}

/// Watches a gallery in the making. Called from any thread.
pub trait Watch: Sync {
    /// What is being made, and the share of the whole that is done, [0, 1].
    fn at(&self, what: &str, fraction: f64);

    /// True ends it soon.
    fn interrupted(&self) -> bool {
        false
    }
}

/// How large and how smooth.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Width of a picture of spheres, px.
    pub width: u32,
    /// Samples per pixel.
    pub spp: u32,
    /// Written into the files: what repeats them.
    pub command: String,
}

impl Options {
    /// Width when none is chosen, px.
    pub const WIDTH: u32 = 1000;
    /// Samples per pixel when none are chosen.
    pub const SPP: u32 = 32;
}

/// Radiance 1 is shown a little below white: highlights stay above.
const STOPS: f32 = -0.3;

/// Makes and writes the parts of a plate.
pub struct Studio<'a> {
    pub options: &'a Options,
    folder: &'a mut dyn Folder,
    watch: &'a dyn Watch,
    /// What is being made, and where in the whole: from, to.
    now: (String, [f64; 2]),
    /// Names of all files so far.
    files: Vec<String>,
}

/// A file that the page shows.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Shown {
    /// The picture.
    pub image: String,
    /// What it shows, for those who do not see it.
    pub alt: String,
    /// The same in other formats.
    pub files: Vec<String>,
    /// Beside others of its kind, or alone.
    pub wide: bool,
}

impl<'a> Studio<'a> {
    pub fn new(options: &'a Options, folder: &'a mut dyn Folder, watch: &'a dyn Watch) -> Self {
        Self { options, folder, watch, now: (String::new(), [0.0, 0.0]), files: Vec::new() }
    }

    /// The next plate takes this part of the whole.
    pub fn turn_to(&mut self, what: &str, part: [f64; 2]) -> Result<(), GalleryError> {
        self.now = (what.to_owned(), part);
        self.advance(0.0)
    }

    /// The share of the current plate that is done.
    pub fn advance(&self, share: f64) -> Result<(), GalleryError> {
        let (what, [from, to]) = &self.now;
        self.watch.at(what, from + (to - from) * share);
        if self.watch.interrupted() { Err(GalleryError::Interrupted) } else { Ok(()) }
    }

    /// Everything written so far.
    pub fn files(&self) -> &[String] {
        &self.files
    }

    /// Path traced, with the current plate's progress going from `part[0]` to `part[1]`.
    pub fn render(&self, stage: &Stage, settings: &Settings, spp: u32, part: [f64; 2]) -> Result<Frame, GalleryError> {
        let (what, [from, to]) = &self.now;
        let control = |progress: &kajo_path_tracer::Progress| {
            let share = part[0] + (part[1] - part[0]) * f64::from(progress.fraction);
            self.watch.at(what, from + (to - from) * share);
            if self.watch.interrupted() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let film = render(&stage.tracer()?, settings, Stop::at_spp(spp), None, &control)?;
        if self.watch.interrupted() { Err(GalleryError::Interrupted) } else { Ok(film.develop()) }
    }

    /// The mean of several renderings, each with its own random numbers, and the mean without each pixel's brightest: what a rare path found once is
    /// gone from the second, which is for the eye.
    pub fn render_calmly(
        &self,
        stage: &Stage,
        settings: &Settings,
        spp: u32,
        part: [f64; 2],
    ) -> Result<[Image<LinearRgb>; 2], GalleryError> {
        const BATCHES: u32 = 8;
        let batches = BATCHES.min(spp);
        let renderings = (0..batches)
            .map(|batch| {
                let share = |batch: u32| part[0] + (part[1] - part[0]) * f64::from(batch) / f64::from(batches);
                let settings = Settings { seed: u64::from(batch), ..settings.clone() };
                Ok(self.render(stage, &settings, spp.div_ceil(batches), [share(batch), share(batch + 1)])?.beauty().clone())
            })
            .collect::<Result<Vec<_>, GalleryError>>()?;
        Ok([mean(&renderings), mean_without_brightest(&renderings)])
    }

    /// `stem.exr` with the radiance of the first image, `stem.png` of the second for the eye, and `stem.svg` with the names of rows and columns.
    pub fn picture(&mut self, stem: &str, [image, calm]: [&Image<LinearRgb>; 2], names: &Names, alt: &str) -> Result<Shown, GalleryError> {
        let eye = tone_map(calm, STOPS, ToneMap::PbrNeutral);
        let png = encode_png(&eye, &self.metadata())?;
        self.write(&format!("{stem}.svg"), sheet(&eye, &png, names).as_bytes())?;
        self.write(&format!("{stem}.png"), &png)?;
        let exr = format!("{stem}.exr");
        let mut file = ExrFile::new(image.size());
        file.layers.push(Layer::color("", image));
        file.metadata = self.metadata();
        file.write(&self.place(&exr)?)?;
        let files = ["svg", "png", "exr"].map(|ending| format!("{stem}.{ending}")).into();
        Ok(Shown { image: format!("{stem}.svg"), alt: alt.into(), files, wide: true })
    }

    /// Curves as numbers, vectors and pixels.
    pub fn curves(&mut self, figure: &Figure) -> Result<Shown, GalleryError> {
        let stem = &figure.name;
        self.write(&format!("{stem}.csv"), figure.csv().as_bytes())?;
        self.write(&format!("{stem}.svg"), plot::svg(figure).as_bytes())?;
        self.write(&format!("{stem}.png"), &plot::png(figure))?;
        let files = ["svg", "png", "csv"].map(|ending| format!("{stem}.{ending}")).into();
        let curves: Vec<&str> = figure.curves.iter().map(|curve| curve.name.as_str()).collect();
        let alt = format!("Plot. {}. {} over {}. Curves: {}.", figure.title, figure.axes[1], figure.axes[0], curves.join(", "));
        Ok(Shown { image: format!("{stem}.svg"), alt, files, wide: false })
    }

    /// A map as numbers, vectors and pixels.
    pub fn map(&mut self, map: &Map) -> Result<Shown, GalleryError> {
        let stem = &map.name;
        self.write(&format!("{stem}.csv"), map.csv().as_bytes())?;
        self.write(&format!("{stem}.svg"), plot::map_svg(map).as_bytes())?;
        self.write(&format!("{stem}.png"), &plot::map_png(map))?;
        let files = ["svg", "png", "csv"].map(|ending| format!("{stem}.{ending}")).into();
        let alt = format!("Map. {}. {} over {} and {}.", map.title, map.axes[2], map.axes[0], map.axes[1]);
        Ok(Shown { image: format!("{stem}.svg"), alt, files, wide: false })
    }

    /// Any file.
    pub fn write(&mut self, name: &str, bytes: &[u8]) -> Result<(), GalleryError> {
        let path = self.place(name)?;
        std::fs::write(path, bytes).map_err(|reason| GalleryError::Write { name: name.into(), reason })
    }

    fn place(&mut self, name: &str) -> Result<PathBuf, GalleryError> {
        self.files.push(name.to_owned());
        self.folder.place(name).map_err(|reason| GalleryError::Write { name: name.into(), reason })
    }

    fn metadata(&self) -> BTreeMap<String, String> {
        [("software", format!("Kajo {}", env!("CARGO_PKG_VERSION"))), ("command", self.options.command.clone())]
            .map(|(key, value)| (key.to_owned(), value))
            .into()
    }
}

/// What stands at the left of each row of a sheet, and below each column.
#[derive(Clone, Debug, Default)]
pub struct Names {
    pub rows: Vec<String>,
    pub columns: Vec<String>,
    /// So many in a row, each with its name in its upper left corner.
    pub tiles: Option<(u32, Vec<String>)>,
}

fn mean(images: &[Image<LinearRgb>]) -> Image<LinearRgb> {
    let pixel = |x: u32, y: u32| images.iter().map(|image| *image.get(x, y)).sum::<LinearRgb>() / images.len() as f32;
    Image::from_fn(images[0].size(), pixel)
}

/// Of one image, itself.
fn mean_without_brightest(images: &[Image<LinearRgb>]) -> Image<LinearRgb> {
    let pixel = |x: u32, y: u32| {
        let mut values: Vec<LinearRgb> = images.iter().map(|image| *image.get(x, y)).collect();
        values.sort_by(|a, b| a.luminance().total_cmp(&b.luminance()));
        let kept = &values[..values.len().saturating_sub(1).max(1)];
        kept.iter().copied().sum::<LinearRgb>() / kept.len() as f32
    };
    Image::from_fn(images[0].size(), pixel)
}

/// Pictures below one another. All have the same width.
pub fn stacked(rows: &[Image<LinearRgb>]) -> Image<LinearRgb> {
    let size = rows.iter().fold(UVec2::ZERO, |size, row| UVec2::new(row.width(), size.y + row.height()));
    Image::from_pixels(size, rows.iter().flat_map(|row| row.pixels().iter().copied()).collect())
}

/// Pictures of one size, `columns` of them in a row; what is left of the last row is white.
pub fn tiled(tiles: &[Image<LinearRgb>], columns: u32) -> Image<LinearRgb> {
    let tile = tiles.first().map_or(UVec2::ONE, Image::size);
    let rows = (tiles.len() as u32).div_ceil(columns).max(1);
    Image::from_fn(tile * UVec2::new(columns, rows), |x, y| {
        let at = UVec2::new(x, y) / tile;
        tiles.get((at.y * columns + at.x) as usize).map_or(LinearRgb::WHITE, |image| *image.get(x % tile.x, y % tile.y))
    })
}

/// A document with the picture in it and the names as text.
fn sheet(image: &Image<Srgb8>, png: &[u8], names: &Names) -> String {
    const LINE: u32 = 30;
    let named = names.rows.iter().any(|name| !name.is_empty());
    let left = if named { 96 } else { 0 };
    let below = if names.columns.is_empty() { 0 } else { LINE };
    let (width, height) = (image.width() + left, image.height() + below);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" \
         font-size=\"15\" fill=\"#222\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n<image x=\"{left}\" width=\"{}\" height=\"{}\" \
         href=\"data:image/png;base64,{}\"/>\n",
        image.width(),
        image.height(),
        base64::engine::general_purpose::STANDARD.encode(png)
    );
    let mut text = |x: f64, y: f64, anchor: &str, words: &str| {
        let words = words.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        out += &format!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" dominant-baseline=\"central\">{words}</text>\n");
    };
    let step = f64::from(image.height()) / names.rows.len().max(1) as f64;
    for (k, name) in names.rows.iter().enumerate().filter(|(_, name)| !name.is_empty()) {
        text(f64::from(left) - 12.0, (k as f64 + 0.5) * step, "end", name);
    }
    let step = f64::from(image.width()) / names.columns.len().max(1) as f64;
    for (k, name) in names.columns.iter().enumerate() {
        text(f64::from(left) + (k as f64 + 0.5) * step, f64::from(image.height() + LINE / 2), "middle", name);
    }
    if let Some((columns, names)) = &names.tiles {
        let (width, height) = (image.width() / columns, image.height() / (names.len() as u32).div_ceil(*columns).max(1));
        for (k, name) in (0_u32..).zip(names) {
            text(f64::from(left + k % columns * width) + 8.0, f64::from(k / columns * height) + 15.0, "start", name);
        }
    }
    out + "</svg>\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_put_together_in_their_order() {
        let plain = |value: f32| Image::from_fn(UVec2::new(3, 2), |_, _| LinearRgb::splat(value));
        let column = stacked(&[plain(0.1), plain(0.2)]);
        assert_eq!((column.size(), column.get(0, 1)[0], column.get(2, 2)[0]), (UVec2::new(3, 4), 0.1, 0.2));
        let grid = tiled(&[plain(0.1), plain(0.2), plain(0.3)], 2);
        assert_eq!(grid.size(), UVec2::new(6, 4));
        assert_eq!([[0, 0], [5, 1], [0, 2], [3, 3]].map(|[x, y]| grid.get(x, y)[0]), [0.1, 0.2, 0.3, 1.0]);
    }

    #[test]
    fn what_one_rendering_found_alone_is_not_shown() {
        let plain = |value: f32| Image::from_fn(UVec2::ONE, |_, _| LinearRgb::splat(value));
        let images = [plain(1.0), plain(50.0), plain(2.0)];
        assert!((mean(&images).get(0, 0)[0] - 53.0 / 3.0).abs() < 1e-5 && mean_without_brightest(&images).get(0, 0)[0] == 1.5);
        assert_eq!(mean_without_brightest(&images[1..2]).get(0, 0)[0], 50.0);
    }

    #[test]
    fn names_are_text_of_the_sheet() {
        let image = Image::from_fn(UVec2::new(8, 4), |_, _| Srgb8([9; 3]));
        let names =
            Names { rows: vec!["a < b".into()], columns: vec!["n = 3".into(), "n = 5".into()], tiles: Some((1, vec!["tile".into()])) };
        let svg = sheet(&image, &encode_png(&image, &BTreeMap::new()).unwrap(), &names);
        assert!(
            svg.contains(">a &lt; b</text>")
                && svg.contains(">n = 5</text>")
                && svg.contains(">tile</text>")
                && svg.contains("base64,iVBOR")
        );
    }
}
