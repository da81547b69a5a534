//! How fast one quantity grows with another.

/// The power p of y = c xᵖ through positive points, by least squares of logarithms.
pub(super) fn exponent(points: &[[f64; 2]]) -> f64 {
    let logs: Vec<[f64; 2]> = points.iter().map(|p| p.map(f64::ln)).collect();
    let mean = |axis: usize| logs.iter().map(|p| p[axis]).sum::<f64>() / logs.len() as f64;
    let (mx, my) = (mean(0), mean(1));
    logs.iter().map(|p| (p[0] - mx) * (p[1] - my)).sum::<f64>() / logs.iter().map(|p| (p[0] - mx).powi(2)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::exponent;

    #[test]
    fn powers_are_found() {
        for power in [-1.0, 0.5, 1.0, 2.0] {
            let points: Vec<[f64; 2]> = (1..6).map(|x| [f64::from(x), 3.0 * f64::from(x).powf(power)]).collect();
            assert!((exponent(&points) - power).abs() < 1e-12);
        }
    }
}
