//! Values over two numbers as coloured cells.

use super::raster::Raster;
use super::svg::Svg;
use super::{Anchor, Canvas, FIELD, INK, SIZE, ticks};

/// Values over a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// The stem of its files.
    pub name: String,
    /// What it shows.
    pub title: String,
    /// Names of both axes and of the values, with units.
    pub axes: [String; 3],
    /// Where the columns are, ascending.
    pub x: Vec<f64>,
    /// Where the rows are, from below.
    pub y: Vec<f64>,
    /// Row by row from below.
    pub values: Vec<f64>,
}

/// Above 1, where a surface reflects more than arrives.
const TOO_MUCH: [u8; 3] = [220, 30, 40];
/// The scale of colours is right of the field.
const SCALE: [f64; 2] = [FIELD[2] + 36.0, FIELD[2] + 62.0];

impl Map {
    /// One line a value.
    pub fn csv(&self) -> String {
        let mut out = self.axes.each_ref().map(|axis| format!("\"{}\"", axis.replace('"', "\"\""))).join(",") + "\n";
        for (row, y) in self.values.chunks(self.x.len().max(1)).zip(&self.y) {
            for (value, x) in row.iter().zip(&self.x) {
                out += &format!("{x},{y},{value}\n");
            }
        }
        out
    }
}

/// The map as an SVG document.
pub fn map_svg(map: &Map) -> String {
    let mut canvas = Svg::new(SIZE);
    draw(map, &mut canvas);
    canvas.finish()
}

/// The map as a PNG file.
pub fn map_png(map: &Map) -> Vec<u8> {
    let mut canvas = Raster::new(SIZE);
    draw(map, &mut canvas);
    canvas.finish()
}

fn colour(value: f64) -> [u8; 3] {
    // A little above 1 is the error of quadrature.
    if value > 1.002 {
        return TOO_MUCH;
    }
    let colorous::Color { r, g, b } = colorous::VIRIDIS.eval_continuous(value.clamp(0.0, 1.0));
    [r, g, b]
}

fn draw(map: &Map, canvas: &mut impl Canvas) {
    let [left, top, right, bottom] = FIELD;
    let (columns, rows) = (map.x.len().max(1) as f64, map.y.len().max(1) as f64);
    let x_at = |column: f64| left + column / columns * (right - left);
    let y_at = |row: f64| bottom - row / rows * (bottom - top);
    for (row, values) in map.values.chunks(map.x.len().max(1)).enumerate() {
        for (column, value) in values.iter().enumerate() {
            let (x, y) = (column as f64, row as f64);
            canvas.cell([x_at(x), y_at(y + 1.0), x_at(x + 1.0), y_at(y)], colour(*value));
        }
    }
    let every = |count: f64| (count / 10.0).ceil().max(1.0) as usize;
    for (column, x) in map.x.iter().enumerate().step_by(every(columns)) {
        canvas.text([x_at(column as f64 + 0.5), bottom + 16.0], &format!("{x}"), Anchor::Middle, false);
    }
    for (row, y) in map.y.iter().enumerate().step_by(every(rows)) {
        canvas.text([left - 8.0, y_at(row as f64 + 0.5)], &format!("{y}"), Anchor::End, false);
    }
    let steps = 100;
    let level = |value: f64| bottom - value * (bottom - top);
    for step in 0..steps {
        let [from, to] = [step, step + 1].map(|step| f64::from(step) / f64::from(steps));
        canvas.cell([SCALE[0], level(to), SCALE[1], level(from)], colour(from));
    }
    for (value, label) in ticks([0.0, 1.0]) {
        canvas.text([SCALE[1] + 8.0, level(value)], &label, Anchor::Start, false);
    }
    if map.values.iter().any(|value| colour(*value) == TOO_MUCH) {
        canvas.cell([SCALE[0], top - 26.0, SCALE[1], top - 10.0], TOO_MUCH);
        canvas.text([SCALE[1] + 8.0, top - 18.0], "more than 1", Anchor::Start, false);
    }
    canvas.line(&[[left, top], [left, bottom], [right, bottom]], INK, 1.0);
    canvas.text([(left + right) / 2.0, top / 2.0], &map.title, Anchor::Middle, false);
    canvas.text([(left + right) / 2.0, bottom + 44.0], &map.axes[0], Anchor::Middle, false);
    canvas.text([18.0, (top + bottom) / 2.0], &map.axes[1], Anchor::Middle, true);
    canvas.text([SCALE[1] + 60.0, (top + bottom) / 2.0], &map.axes[2], Anchor::Middle, true);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_have_the_colours_of_their_values() {
        let axes = ["x", "y", "v"].map(str::to_owned);
        let map =
            Map { name: "m".into(), title: "t".into(), axes, x: vec![0.0, 30.0], y: vec![1.0, 2.0], values: vec![0.0, 0.5, 1.0, 1.2] };
        assert_eq!(map.csv(), "\"x\",\"y\",\"v\"\n0,1,0\n30,1,0.5\n0,2,1\n30,2,1.2\n");
        let bytes = map_png(&map);
        let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes[..])).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        for (column, row, value) in [(0, 0, 0.0), (1, 0, 0.5), (0, 1, 1.0), (1, 1, 1.2)] {
            let x = FIELD[0] + (f64::from(column) + 0.5) / 2.0 * (FIELD[2] - FIELD[0]);
            let y = FIELD[3] - (f64::from(row) + 0.5) / 2.0 * (FIELD[3] - FIELD[1]);
            let at = (y as usize * SIZE[0] as usize + x as usize) * 3;
            assert_eq!(pixels[at..at + 3], colour(value), "{column} {row}");
        }
        assert_eq!(colour(1.2), TOO_MUCH);
        assert!(map_svg(&map).matches("<rect").count() > 104 && map_svg(&map).contains("more than 1"));
    }
}
