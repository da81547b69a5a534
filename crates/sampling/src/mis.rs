//! Weights of multiple importance sampling.

/// Balance heuristic: w_s = N_s p_s / Σ N_j p_j, for two strategies with equal counts.    \[Veach98] eq. 9.8
///
/// Zero when both pdfs are zero. An infinite `pdf` (a delta) gets 1.
#[inline]
pub fn balance_heuristic(pdf: f32, other: f32) -> f32 {
    if pdf == f32::INFINITY {
        1.0
    } else if pdf > 0.0 {
        1.0 / (1.0 + other / pdf)
    } else {
        0.0
    }
}

/// Power heuristic with β = 2: w_s = p_s² / Σ p_j², for two strategies with equal counts.    \[Veach98] eq. 9.11
///
/// Written with the ratio of the pdfs, so that large pdfs do not overflow.
#[inline]
pub fn power_heuristic(pdf: f32, other: f32) -> f32 {
    if pdf == f32::INFINITY {
        1.0
    } else if pdf > 0.0 {
        let ratio = other / pdf;
        1.0 / (1.0 + ratio * ratio)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// First sentence of row M-06.
    #[test]
    fn weights_sum_to_one() {
        for a in [1e-30f32, 1e-3, 0.5, 1.0, 7.0, 1e20] {
            for b in [1e-30f32, 1e-3, 0.5, 1.0, 7.0, 1e20] {
                assert!((balance_heuristic(a, b) + balance_heuristic(b, a) - 1.0).abs() < 1e-6);
                assert!((power_heuristic(a, b) + power_heuristic(b, a) - 1.0).abs() < 1e-6);
            }
        }
        assert_eq!(power_heuristic(0.0, 0.0), 0.0);
        assert_eq!((power_heuristic(f32::INFINITY, 2.0), power_heuristic(2.0, f32::INFINITY)), (1.0, 0.0));
    }
}
