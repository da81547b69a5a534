//! Colours of spectra: what a reflectance over wavelengths looks like in daylight.
//!
//! ```text
//! X = ∫ R S x̄ dλ / ∫ S ȳ dλ        Y, Z with ȳ, z̄;   S the illuminant D65                       [CIE15]
//! ```
//!
//! Linear Rec. 709 follows from XYZ by the matrix of IEC 61966-2-1. Its white is D65, so that R = 1 is (1, 1, 1).

/// The first wavelength of the tables, nm.
const FIRST_NM: usize = 380;
/// Between wavelengths of the tables, nm.
const STEP_NM: usize = 5;
/// CIE XYZ to linear Rec. 709.    IEC 61966-2-1
const RGB_FROM_XYZ: [[f64; 3]; 3] =
    [[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560], [0.0556434, -0.2040259, 1.0572252]];

/// The visible wavelengths, nm.
pub const VISIBLE_NM: [f64; 2] = [FIRST_NM as f64, (FIRST_NM + STEP_NM * (TABLE.len() - 1)) as f64];

/// What each measurement of a reflectance contributes to linear Rec. 709: RGB = Σ_k R(λ_k) w_k. The reflectance is linear between `wavelengths` (nm,
/// rising, not empty) and constant beyond them. The weights of each channel sum to 1; for that they are scaled by less than 1e-3.
pub fn rgb_weights(wavelengths: &[f64]) -> Vec<[f64; 3]> {
    let mut weights = vec![[0.0; 3]; wavelengths.len()];
    for nm in FIRST_NM..=FIRST_NM + STEP_NM * (TABLE.len() - 1) {
        let rgb = daylight_rgb((nm - FIRST_NM) as f64 / STEP_NM as f64);
        let upper = wavelengths.partition_point(|w| *w <= nm as f64).min(wavelengths.len() - 1);
        let lower = upper.saturating_sub(1);
        let width = wavelengths[upper] - wavelengths[lower];
        let share = if width > 0.0 { ((nm as f64 - wavelengths[lower]) / width).clamp(0.0, 1.0) } else { 1.0 };
        for (channel, part) in rgb.into_iter().enumerate() {
            weights[lower][channel] += (1.0 - share) * part;
            weights[upper][channel] += share * part;
        }
    }
    let mut white = [0.0; 3];
    for weight in &weights {
        (0..3).for_each(|channel| white[channel] += weight[channel]);
    }
    weights.into_iter().map(|weight| std::array::from_fn(|channel| weight[channel] / white[channel])).collect()
}

/// S (x̄, ȳ, z̄) in the primaries of Rec. 709, at a place in the table.
fn daylight_rgb(at: f64) -> [f64; 3] {
    let lower = (at as usize).min(TABLE.len() - 2);
    let share = at - lower as f64;
    let [x, y, z, daylight] = std::array::from_fn(|i| TABLE[lower][i] + share * (TABLE[lower + 1][i] - TABLE[lower][i]));
    RGB_FROM_XYZ.map(|row| daylight * (row[0] * x + row[1] * y + row[2] * z))
}

/// x̄, ȳ, z̄ of the standard observer of 1931 (2°), and the relative power of D65.    [CIE15]
const TABLE: [[f64; 4]; 81] = [
    [0.001368, 0.000039, 0.00645, 49.9755],
    [0.002236, 0.000064, 0.01055, 52.3118],
    [0.004243, 0.00012, 0.02005, 54.6482],
    [0.00765, 0.000217, 0.03621, 68.7015],
    [0.01431, 0.000396, 0.06785, 82.7549],
    [0.02319, 0.00064, 0.1102, 87.1204],
    [0.04351, 0.00121, 0.2074, 91.486],
    [0.07763, 0.00218, 0.3713, 92.4589],
    [0.13438, 0.004, 0.6456, 93.4318],
    [0.21477, 0.0073, 1.0390501, 90.057],
    [0.2839, 0.0116, 1.3856, 86.6823],
    [0.3285, 0.01684, 1.62296, 95.7736],
    [0.34828, 0.023, 1.74706, 104.865],
    [0.34806, 0.0298, 1.7826, 110.936],
    [0.3362, 0.038, 1.77211, 117.008],
    [0.3187, 0.048, 1.7441, 117.41],
    [0.2908, 0.06, 1.6692, 117.812],
    [0.2511, 0.0739, 1.5281, 116.336],
    [0.19536, 0.09098, 1.28764, 114.861],
    [0.1421, 0.1126, 1.0419, 115.392],
    [0.09564, 0.13902, 0.8129501, 115.923],
    [0.05795, 0.1693, 0.6162, 112.367],
    [0.03201, 0.20802, 0.46518, 108.811],
    [0.0147, 0.2586, 0.3533, 109.082],
    [0.0049, 0.323, 0.272, 109.354],
    [0.0024, 0.4073, 0.2123, 108.578],
    [0.0093, 0.503, 0.1582, 107.802],
    [0.0291, 0.6082, 0.1117, 106.296],
    [0.06327, 0.71, 0.07825, 104.79],
    [0.1096, 0.7932, 0.05725, 106.239],
    [0.1655, 0.862, 0.04216, 107.689],
    [0.2257499, 0.9148501, 0.02984, 106.047],
    [0.2904, 0.954, 0.0203, 104.405],
    [0.3597, 0.9803, 0.0134, 104.225],
    [0.4334499, 0.9949501, 0.00875, 104.046],
    [0.5120501, 1.0, 0.00575, 102.023],
    [0.5945, 0.995, 0.0039, 100.0],
    [0.6784, 0.9786, 0.00275, 98.1671],
    [0.7621, 0.952, 0.0021, 96.3342],
    [0.8425, 0.9154, 0.0018, 96.0611],
    [0.9163, 0.87, 0.00165, 95.788],
    [0.9786, 0.8163, 0.0014, 92.2368],
    [1.0263, 0.757, 0.0011, 88.6856],
    [1.0567, 0.6949, 0.001, 89.3459],
    [1.0622, 0.631, 0.0008, 90.0062],
    [1.0456, 0.5668, 0.0006, 89.8026],
    [1.0026, 0.503, 0.00034, 89.5991],
    [0.9384, 0.4412, 0.00024, 88.6489],
    [0.8544499, 0.381, 0.00019, 87.6987],
    [0.7514, 0.321, 0.0001, 85.4936],
    [0.6424, 0.265, 0.00005, 83.2886],
    [0.5419, 0.217, 0.00003, 83.4939],
    [0.4479, 0.175, 0.00002, 83.6992],
    [0.3608, 0.1382, 0.00001, 81.863],
    [0.2835, 0.107, 0.0, 80.0268],
    [0.2187, 0.0816, 0.0, 80.1207],
    [0.1649, 0.061, 0.0, 80.2146],
    [0.1212, 0.04458, 0.0, 81.2462],
    [0.0874, 0.032, 0.0, 82.2778],
    [0.0636, 0.0232, 0.0, 80.281],
    [0.04677, 0.017, 0.0, 78.2842],
    [0.0329, 0.01192, 0.0, 74.0027],
    [0.0227, 0.00821, 0.0, 69.7213],
    [0.01584, 0.005723, 0.0, 70.6652],
    [0.0113592, 0.004102, 0.0, 71.6091],
    [0.0081109, 0.002929, 0.0, 72.979],
    [0.0057903, 0.002091, 0.0, 74.349],
    [0.0041095, 0.001484, 0.0, 67.9765],
    [0.0028993, 0.001047, 0.0, 61.604],
    [0.0020492, 0.00074, 0.0, 65.7448],
    [0.00144, 0.00052, 0.0, 69.8856],
    [0.0009999, 0.0003611, 0.0, 72.4863],
    [0.0006901, 0.0002492, 0.0, 75.087],
    [0.000476, 0.0001719, 0.0, 69.3398],
    [0.0003323, 0.00012, 0.0, 63.5927],
    [0.0002348, 0.0000848, 0.0, 55.0054],
    [0.0001662, 0.00006, 0.0, 46.4182],
    [0.0001174, 0.0000424, 0.0, 56.6118],
    [0.0000831, 0.00003, 0.0, 66.8054],
    [0.0000587, 0.0000212, 0.0, 65.0941],
    [0.0000415, 0.000015, 0.0, 63.3828],
];

#[cfg(test)]
mod tests {
    use super::*;

    fn rgb(wavelengths: &[f64], reflectance: impl Fn(f64) -> f64) -> [f64; 3] {
        let weights = rgb_weights(wavelengths);
        std::array::from_fn(|channel| wavelengths.iter().zip(&weights).map(|(nm, weight)| reflectance(*nm) * weight[channel]).sum())
    }

    fn every(step: f64) -> Vec<f64> {
        (0..).map(|k| 360.0 + step * f64::from(k)).take_while(|nm| *nm <= 1000.0).collect()
    }

    fn off(a: [f64; 3], b: [f64; 3]) -> f64 {
        (0..3).fold(0.0, |worst, i| f64::max(worst, (a[i] - b[i]).abs()))
    }

    #[test]
    fn a_reflectance_of_one_is_white() {
        for wavelengths in [every(3.3), every(40.0), vec![550.0], vec![450.0, 700.0]] {
            let white = rgb(&wavelengths, |_| 1.0);
            assert!(off(white, [1.0; 3]) < 1e-12, "{white:?}");
        }
    }

    /// Divided by daylight, what is left is the equal-energy spectrum, whose colour is the sum of the matrix's columns.
    #[test]
    fn equal_energy_has_its_known_colour() {
        let daylight = |nm: f64| {
            let at = ((nm - 380.0) / 5.0).clamp(0.0, 80.0);
            let lower = (at as usize).min(79);
            TABLE[lower][3] + (at - lower as f64) * (TABLE[lower + 1][3] - TABLE[lower][3])
        };
        let luminance = |c: [f64; 3]| 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
        let color = rgb(&every(1.0), |nm| 100.0 / daylight(nm));
        let color = color.map(|channel| channel / luminance(color));
        let known = [1.2048, 0.9483, 0.9088];
        assert!(off(color, known) < 1e-3, "{color:?}");
        assert!(off([color[1], color[0], color[2]], known) > 0.1, "planted fault: swapped channels");
    }

    #[test]
    fn long_waves_are_red_and_invisible_ones_nothing() {
        let fine = every(2.0);
        let [r, g, b] = rgb(&fine, |nm| f64::from(nm > 600.0));
        assert!(r > 0.8 && g.abs() < 0.1 && b.abs() < 0.02, "{r} {g} {b}");
        let [r, g, b] = rgb(&fine, |nm| f64::from(nm < 480.0));
        assert!(b > 0.8 && g.abs() < 0.1 && r.abs() < 0.1, "{r} {g} {b}");
        assert!(off(rgb(&fine, |nm| f64::from(!(378.0..=782.0).contains(&nm))), [0.0; 3]) < 1e-4);
    }

    #[test]
    fn few_wavelengths_of_a_straight_spectrum_are_as_good_as_many() {
        let straight = |nm: f64| (nm - 300.0) / 700.0;
        assert!(off(rgb(&every(1.0), straight), rgb(&[380.0, 780.0], straight)) < 1e-9);
    }
}
