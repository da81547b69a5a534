//! Functions on the unit square, bilinear between the nodes of a grid, one for each tabulated viewer; and densities of that kind, drawn from by inversion:
//! first the row, then the place in it.
//!
//! ```text
//! p(x, y) = Σ_k w_k p_k(x, y)       each ∫∫ p_k dx dy = 1, w_k the shares of the tabulated viewers
//! P(y)    = ∫_0^y ∫_0^1 p dx dy,       P(x | y) = ∫_0^x p dx / ∫_0^1 p dx                                 [Dupuy18]
//! ```
//!
//! Cumulative sums blend like the densities, so that between tabulated viewers sampling and density agree to rounding.

/// Up to four tabulated viewers, and what each contributes; the shares sum to 1.
#[derive(Clone, Copy, Debug)]
pub struct Blend {
    slices: [usize; 4],
    shares: [f64; 4],
    count: usize,
}

impl Blend {
    /// One alone.
    pub fn one(slice: usize) -> Self {
        Self { slices: [slice; 4], shares: [1.0, 0.0, 0.0, 0.0], count: 1 }
    }

    /// The viewers around an azimuth and an inclination, linear between them; beyond the first and the last those.
    pub fn around(azimuths: &[f64], phi: f64, inclinations: &[f64], theta: f64) -> Self {
        let ([p0, p1], p) = bracket(azimuths, phi);
        let ([t0, t1], t) = bracket(inclinations, theta);
        let slice = |p: usize, t: usize| p * inclinations.len() + t;
        Self {
            slices: [slice(p0, t0), slice(p0, t1), slice(p1, t0), slice(p1, t1)],
            shares: [(1.0 - p) * (1.0 - t), (1.0 - p) * t, p * (1.0 - t), p * t],
            count: if p0 == p1 { 2 } else { 4 },
        }
    }

    fn of(&self, value: impl Fn(usize) -> f64) -> f64 {
        (0..self.count).map(|k| self.shares[k] * value(self.slices[k])).sum()
    }
}

/// The neighbours of x among rising values, and how far it is from the lower to the upper.
fn bracket(values: &[f64], x: f64) -> ([usize; 2], f64) {
    if values.len() == 1 {
        return ([0, 0], 0.0);
    }
    let upper = values.partition_point(|value| *value <= x).clamp(1, values.len() - 1);
    let (low, high) = (values[upper - 1], values[upper]);
    ([upper - 1, upper], ((x - low) / (high - low)).clamp(0.0, 1.0))
}

/// Grids of numbers, or of colours with N = 3.
#[derive(Clone, Debug, PartialEq)]
pub struct Patches<const N: usize> {
    /// Nodes along x and along y, at least 2 each.
    size: [usize; 2],
    /// Slices of rows; x fastest.
    nodes: Vec<[f32; N]>,
}

/// A cell of a grid and a place in it, in [0, 1]².
#[derive(Clone, Copy)]
struct Place {
    cell: [usize; 2],
    t: [f64; 2],
}

impl<const N: usize> Patches<N> {
    /// # Panics
    /// Where there are fewer than two nodes along a side, or nodes of only a part of a slice.
    pub fn new(size: [usize; 2], nodes: Vec<[f32; N]>) -> Self {
        assert!(size[0] >= 2 && size[1] >= 2 && nodes.len().is_multiple_of(size[0] * size[1]), "{size:?}, {} nodes", nodes.len());
        Self { size, nodes }
    }

    /// Nodes along x and along y.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Slices of rows; x fastest.
    pub fn nodes(&self) -> &[[f32; N]] {
        &self.nodes
    }

    /// The value at a place in [0, 1]².
    pub fn value(&self, blend: &Blend, at: [f64; 2]) -> [f64; N] {
        let Place { cell, t } = place(self.size, at);
        let corners = [(0, 0), (1, 0), (0, 1), (1, 1)];
        let weight = |corner: usize, t: f64| if corner == 1 { t } else { 1.0 - t };
        let mut out = [0.0; N];
        for k in 0..blend.count {
            let first = self.index(blend.slices[k], cell);
            for (column, row) in corners {
                let share = blend.shares[k] * weight(row, t[1]) * weight(column, t[0]);
                let node = &self.nodes[first + row * self.size[0] + column];
                (0..N).for_each(|channel| out[channel] += share * f64::from(node[channel]));
            }
        }
        out
    }

    fn index(&self, slice: usize, [column, row]: [usize; 2]) -> usize {
        (slice * self.size[1] + row) * self.size[0] + column
    }
}

fn place(size: [usize; 2], at: [f64; 2]) -> Place {
    let scaled: [f64; 2] = std::array::from_fn(|axis| at[axis].clamp(0.0, 1.0) * (size[axis] - 1) as f64);
    let cell: [usize; 2] = std::array::from_fn(|axis| (scaled[axis] as usize).min(size[axis] - 2));
    Place { cell, t: std::array::from_fn(|axis| scaled[axis] - cell[axis] as f64) }
}

/// Densities on the unit square, one for each tabulated viewer.
#[derive(Clone, Debug, PartialEq)]
pub struct Warp {
    density: Patches<1>,
    /// ∫ p dx from 0 to each node of each row.
    along: Vec<f64>,
    /// ∫∫ p dx dy up to each row.
    up: Vec<f64>,
}

impl Warp {
    /// Of relative densities ≥ 0; where all of a slice are 0, even.
    ///
    /// # Panics
    /// As [`Patches::new`].
    pub fn new(size: [usize; 2], relative: &[f32]) -> Self {
        let [columns, rows] = size;
        let steps = size.map(|count| 1.0 / (count - 1) as f64);
        let (mut nodes, mut along, mut up) = (Vec::with_capacity(relative.len()), Vec::with_capacity(relative.len()), Vec::new());
        for slice in relative.chunks(columns * rows) {
            let mean = volume(slice, size);
            let density: Vec<f64> = slice.iter().map(|d| if mean > 0.0 { f64::from(*d) / mean } else { 1.0 }).collect();
            let mut below = 0.0;
            let mut previous = None;
            for row in density.chunks(columns) {
                let mut sum = 0.0;
                along.push(0.0);
                for pair in row.windows(2) {
                    sum += 0.5 * (pair[0] + pair[1]) * steps[0];
                    along.push(sum);
                }
                below += previous.map_or(0.0, |previous: f64| 0.5 * (previous + sum) * steps[1]);
                previous = Some(sum);
                up.push(below);
            }
            nodes.extend(density.into_iter().map(|d| [d as f32]));
        }
        Self { density: Patches::new(size, nodes), along, up }
    }

    /// The density itself.
    pub fn density(&self) -> &Patches<1> {
        &self.density
    }

    /// A place for two numbers in [0, 1].
    pub fn sample(&self, blend: &Blend, [x, y]: [f64; 2]) -> [f64; 2] {
        let [columns, rows] = self.density.size;
        let up = |row: usize| blend.of(|slice| self.up[slice * rows + row]);
        let along = |row: usize, column: usize| blend.of(|slice| self.along[self.density.index(slice, [column, row])]);
        let y = y * up(rows - 1);
        let row = last_below(rows - 1, |row| up(row) <= y);
        let whole = [along(row, columns - 1), along(row + 1, columns - 1)];
        let ty = solve(whole, (y - up(row)) * (rows - 1) as f64);
        let between = |column: usize| mix([along(row, column), along(row + 1, column)], ty);
        let x = x * mix(whole, ty);
        let column = last_below(columns - 1, |column| between(column) <= x);
        let tx = solve(self.edge(blend, [column, row], ty), (x - between(column)) * (columns - 1) as f64);
        [(column as f64 + tx) / (columns - 1) as f64, (row as f64 + ty) / (rows - 1) as f64]
    }

    /// What [`Warp::sample`] makes `at` of, and the density there.
    pub fn invert(&self, blend: &Blend, at: [f64; 2]) -> ([f64; 2], f64) {
        let [columns, rows] = self.density.size;
        let Place { cell: [column, row], t: [tx, ty] } = place(self.density.size, at);
        let along = |row: usize, column: usize| blend.of(|slice| self.along[self.density.index(slice, [column, row])]);
        let whole = [along(row, columns - 1), along(row + 1, columns - 1)];
        let y = blend.of(|slice| self.up[slice * rows + row]) + integral(whole, ty) / (rows - 1) as f64;
        let edge = self.edge(blend, [column, row], ty);
        let x = mix([along(row, column), along(row + 1, column)], ty) + integral(edge, tx) / (columns - 1) as f64;
        let total = mix(whole, ty);
        // In a row without density every place is as good.
        let x = if total > 0.0 { (x / total).min(1.0) } else { at[0] };
        ([x, y.min(1.0)], mix(edge, tx))
    }

    /// The density at both ends of a cell, at a height in it.
    fn edge(&self, blend: &Blend, [column, row]: [usize; 2], ty: f64) -> [f64; 2] {
        [column, column + 1].map(|column| {
            let node = |row: usize| blend.of(|slice| f64::from(self.density.nodes[self.density.index(slice, [column, row])][0]));
            mix([node(row), node(row + 1)], ty)
        })
    }
}

/// The mean over the square.
fn volume(slice: &[f32], [columns, rows]: [usize; 2]) -> f64 {
    let inner = |i: usize, count: usize| if i == 0 || i == count - 1 { 0.5 } else { 1.0 };
    let weighted = |(i, d): (usize, &f32)| f64::from(*d) * inner(i % columns, columns) * inner(i / columns, rows);
    slice.iter().enumerate().map(weighted).sum::<f64>() / ((columns - 1) * (rows - 1)) as f64
}

/// The largest index below `count` that holds, 0 if none: those that hold come first.
fn last_below(count: usize, holds: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (0, count);
    while high - low > 1 {
        let middle = usize::midpoint(low, high);
        if holds(middle) { low = middle } else { high = middle }
    }
    low
}

fn mix([a, b]: [f64; 2], t: f64) -> f64 {
    a + (b - a) * t
}

/// ∫_0^t a + (b − a) s ds.
fn integral([a, b]: [f64; 2], t: f64) -> f64 {
    t * (a + 0.5 * t * (b - a))
}

/// The t in [0, 1] with [`integral`] = `sum`, in the form that does not cancel for a ≈ b.
fn solve([a, b]: [f64; 2], sum: f64) -> f64 {
    let root = (a * a + 2.0 * sum * (b - a)).max(0.0).sqrt();
    if a + root > 0.0 { (2.0 * sum / (a + root)).clamp(0.0, 1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_sampling::Rng;

    /// Two slices of 5 × 4 nodes, one of them with rows and columns of zeros.
    fn warp() -> Warp {
        let mut rng = Rng::new(3);
        let second = |i: usize| if i.is_multiple_of(5) || i / 5 == 3 { 0.0 } else { 1.0 };
        Warp::new([5, 4], &(0..40).map(|i| rng.next_1d() * if i < 20 { 1.0 } else { second(i - 20) }).collect::<Vec<_>>())
    }

    fn between() -> Blend {
        Blend::around(&[0.0], 0.0, &[1.0, 2.0], 1.3)
    }

    #[test]
    fn blends_take_the_neighbours_by_their_distance() {
        let phi = [-1.0, 0.0, 2.0];
        let theta = [0.0, 0.5];
        let number = |p: f64, t: f64| Blend::around(&phi, p, &theta, t).of(|slice| [1.0, 10.0, 100.0, 1e3, 1e4, 1e5][slice]);
        for (p, t, expected) in [
            (-1.0, 0.0, 1.0),
            (-7.0, -1.0, 1.0),
            (-0.5, 0.0, 50.5),
            (0.0, 0.25, 550.0),
            (1.5, 0.5, 75_250.0),
            (2.0, 0.5, 1e5),
            (9.0, 9.0, 1e5),
        ] {
            assert!((number(p, t) - expected).abs() < 1e-9, "{p} {t}: {}", number(p, t));
        }
    }

    #[test]
    fn densities_integrate_to_one() {
        let warp = warp();
        for blend in [Blend::one(0), Blend::one(1), between()] {
            let n = 300;
            let at = |k: usize| [(k % n) as f64, (k / n) as f64].map(|i| (i + 0.5) / n as f64);
            let mean = (0..n * n).map(|k| warp.density().value(&blend, at(k))[0]).sum::<f64>() / (n * n) as f64;
            assert!((mean - 1.0).abs() < 1e-5, "{mean}");
        }
    }

    #[test]
    fn inversion_undoes_sampling() {
        let warp = warp();
        let mut rng = Rng::new(5);
        for blend in [Blend::one(0), Blend::one(1), between()] {
            for _ in 0..10_000 {
                let u = [rng.next_f64(), rng.next_f64()];
                let at = warp.sample(&blend, u);
                let (back, density) = warp.invert(&blend, at);
                assert!((back[0] - u[0]).abs() < 1e-6 && (back[1] - u[1]).abs() < 1e-6, "{u:?} {at:?} {back:?}");
                assert!((density - warp.density().value(&blend, at)[0]).abs() < 1e-9);
            }
            assert!((warp.invert(&blend, warp.sample(&Blend::one(0), [0.4, 0.4])).0[0] - 0.4).abs() > 1e-3 || blend.count == 1);
        }
    }

    #[test]
    fn samples_follow_the_density() {
        let warp = warp();
        let (cells, side) = (6, 600);
        for blend in [Blend::one(0), Blend::one(1), between()] {
            let mut counts = vec![0.0; cells * cells];
            let mut masses = vec![0.0; cells * cells];
            let cell = |at: [f64; 2]| {
                let [x, y] = at.map(|v| ((v * cells as f64) as usize).min(cells - 1));
                y * cells + x
            };
            for k in 0..side * side {
                let u = [(k % side) as f64, (k / side) as f64].map(|i| (i + 0.5) / side as f64);
                counts[cell(warp.sample(&blend, u))] += 1.0 / (side * side) as f64;
                masses[cell(u)] += warp.density().value(&blend, u)[0] / (side * side) as f64;
            }
            let worst = |masses: &[f64]| counts.iter().zip(masses).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()));
            assert!(worst(&masses) < 5e-4, "{}", worst(&masses));
            masses.swap(7, 9);
            assert!(worst(&masses) > 1e-3, "planted fault: swapped cells");
        }
    }

    #[test]
    fn nothing_but_zeros_is_an_even_density() {
        let warp = Warp::new([2, 3], &[0.0; 6]);
        let at = warp.sample(&Blend::one(0), [0.3, 0.8]);
        assert!((at[0] - 0.3).abs() < 1e-12 && (at[1] - 0.8).abs() < 1e-12, "{at:?}");
    }
}
