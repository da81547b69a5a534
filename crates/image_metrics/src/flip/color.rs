//! Colour spaces of ꟻLIP: the opponent space YyCxCz that is filtered, and the L*a*b* space that is compared.

use glam::{Mat3, Vec3};
use std::sync::LazyLock;

/// XYZ from linear sRGB, from the primaries and D65.    IEC 61966-2-1
const XYZ_FROM_LINEAR: Mat3 = Mat3::from_cols(
    Vec3::new(10_135_552.0 / 24_577_794.0, 2_613_072.0 / 12_288_897.0, 1_425_312.0 / 73_733_382.0),
    Vec3::new(8_788_810.0 / 24_577_794.0, 8_788_810.0 / 12_288_897.0, 8_788_810.0 / 73_733_382.0),
    Vec3::new(4_435_075.0 / 24_577_794.0, 887_015.0 / 12_288_897.0, 70_074_185.0 / 73_733_382.0),
);

static LINEAR_FROM_XYZ: LazyLock<Mat3> = LazyLock::new(|| XYZ_FROM_LINEAR.inverse());
static WHITE: LazyLock<Vec3> = LazyLock::new(|| XYZ_FROM_LINEAR * Vec3::ONE);

/// YyCxCz, a linear form of L*a*b*: (116 Y − 16, 500 (X − Y), 200 (Y − Z)), relative to white.    \[Andersson20] eq. 4
pub fn opponent_from_linear(rgb: Vec3) -> Vec3 {
    let v = XYZ_FROM_LINEAR * rgb / *WHITE;
    Vec3::new(116.0 * v.y - 16.0, 500.0 * (v.x - v.y), 200.0 * (v.y - v.z))
}

/// The inverse of [`opponent_from_linear`].
pub fn linear_from_opponent(opponent: Vec3) -> Vec3 {
    let y = (opponent.x + 16.0) / 116.0;
    *LINEAR_FROM_XYZ * (Vec3::new(y + opponent.y / 500.0, y, y - opponent.z / 200.0) * *WHITE)
}

/// L*a*b* of a filtered colour, clamped to the display's gamut, chroma scaled by 0.01 L* (Hunt effect).    \[Andersson20] eq. 8 and 9
pub fn hunt_lab(opponent: Vec3) -> Vec3 {
    let displayed = linear_from_opponent(opponent).clamp(Vec3::ZERO, Vec3::ONE);
    let f = (XYZ_FROM_LINEAR * displayed / *WHITE).to_array().map(cube_root);
    let lightness = 116.0 * f[1] - 16.0;
    Vec3::new(lightness, 0.01 * lightness * 500.0 * (f[0] - f[1]), 0.01 * lightness * 200.0 * (f[1] - f[2]))
}

/// The compressive function of CIE 1976 L*a*b*.
fn cube_root(t: f32) -> f32 {
    const DELTA: f32 = 6.0 / 29.0;
    if t > DELTA * DELTA * DELTA { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
}

/// HyAB: |ΔL*| + √(Δa² + Δb²), which keeps large differences apart better than a Euclidean distance.    \[Andersson20] eq. 10
pub fn hyab(a: Vec3, b: Vec3) -> f32 {
    let d = a - b;
    d.x.abs() + d.y.hypot(d.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_100_without_chroma_and_black_is_0() {
        assert!((hunt_lab(opponent_from_linear(Vec3::ONE)) - Vec3::new(100.0, 0.0, 0.0)).abs().max_element() < 1e-3);
        assert!(hunt_lab(opponent_from_linear(Vec3::ZERO)).abs().max_element() < 1e-3);
    }

    #[test]
    fn opponent_space_inverts() {
        for rgb in [Vec3::X, Vec3::new(0.2, 0.5, 0.9), Vec3::ONE] {
            assert!((linear_from_opponent(opponent_from_linear(rgb)) - rgb).abs().max_element() < 1e-5);
        }
    }
}
