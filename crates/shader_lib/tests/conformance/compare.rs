//! The comparison: every number within a stated tolerance, and the worst one in the message.

use crate::gpu;

/// |gpu − cpu| ≤ absolute + relative · |cpu|.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    pub relative: f32,
    pub absolute: f32,
}

impl Tolerance {
    /// Equal bits.
    pub const EXACT: Self = Self { relative: 0.0, absolute: 0.0 };

    /// What a chain of f32 operations in another order, and transcendental functions of a few ulp, may differ by.
    pub const USUAL: Self = Self { relative: 1e-4, absolute: 1e-6 };

    fn excess(self, gpu: f32, cpu: f32) -> f32 {
        if gpu.to_bits() == cpu.to_bits() {
            return 0.0;
        }
        let difference = (gpu - cpu).abs() / (self.absolute + self.relative * cpu.abs());
        // A NaN on one side only is infinitely wrong.
        if difference.is_nan() { f32::INFINITY } else { difference }
    }
}

/// `Err` with the worst row when some number is outside the tolerance.
pub fn compare<const N: usize, const M: usize>(
    rows: &[[f32; N]],
    gpu: &[[f32; M]],
    cpu: &[[f32; M]],
    tolerance: Tolerance,
) -> Result<(), String> {
    assert!(rows.len() == gpu.len() && rows.len() == cpu.len() && !rows.is_empty(), "one result a row");
    let excess = |row: usize| (0..M).map(|i| tolerance.excess(gpu[row][i], cpu[row][i])).fold(0.0, f32::max);
    let outside = (0..rows.len()).filter(|&row| excess(row) > 1.0).count();
    if outside == 0 {
        return Ok(());
    }
    let worst = (0..rows.len()).max_by(|&a, &b| excess(a).total_cmp(&excess(b))).expect("not empty");
    Err(format!(
        "{outside} of {} rows differ by more than {tolerance:?}; worst, by a factor of {}: of {:?} the GPU makes {:?} and the CPU {:?}",
        rows.len(),
        excess(worst),
        rows[worst],
        gpu[worst],
        cpu[worst]
    ))
}

/// Evaluates `shader` and its twin for every row and panics where they differ; says so and returns without an adapter.
pub fn conform<const N: usize, const M: usize>(
    name: &str,
    shader: &str,
    rows: &[[f32; N]],
    twin: impl Fn([f32; N]) -> [f32; M],
    tolerance: Tolerance,
) {
    let Some(device) = gpu::device() else { return };
    let gpu = gpu::evaluate(&device, name, shader, rows);
    let cpu: Vec<_> = rows.iter().map(|&row| twin(row)).collect();
    compare(rows, &gpu, &cpu, tolerance).unwrap_or_else(|message| panic!("{name}: {message}"));
    // Planted fault: a twin whose every number is scaled must be found out, or the rows prove nothing.
    let scaled: Vec<_> = cpu.iter().map(|row| row.map(|value| value * (1.0 + 4.0 * tolerance.relative.max(1e-3)))).collect();
    assert!(compare(rows, &gpu, &scaled, tolerance).is_err(), "{name}: a scaled twin passed");
}

#[test]
fn planted_faults_are_found() {
    let rows = [[0.0f32], [1.0], [2.0]];
    let good = [[1.0f32, 5.0], [2.0, 6.0], [3.0, 7.0]];
    assert_eq!(compare(&rows, &good, &good, Tolerance::EXACT), Ok(()));
    let mut swapped = good;
    swapped[1] = [6.0, 2.0];
    let mut not_a_number = good;
    not_a_number[2][0] = f32::NAN;
    let mut slightly = good;
    slightly[0][1] *= 1.0 + 3e-4;
    for wrong in [swapped, not_a_number, slightly] {
        let message = compare(&rows, &wrong, &good, Tolerance::USUAL).unwrap_err();
        assert!(message.starts_with("1 of 3 rows"), "{message}");
    }
}
