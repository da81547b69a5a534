//! Measured optical constants of common metals, and what red, green and blue make of them.
//!
//! Tables of wavelength (nm), η, κ over the visible range, evaporated films at room temperature: gold, silver, copper from \[Johnson72], iron, chromium,
//! nickel, titanium from \[Johnson74], aluminium from \[Rakic95]; digits as collected by \[Polyanskiy24] (public domain). RGB takes the constants at the
//! dominant wavelengths of the sRGB primaries, 611.4, 549.1 and 464.2 nm, and is the three-wavelength renderer's answer, no colorimetry.

use super::fresnel::normal_reflectance;
use kajo_params::ParamChoice;

/// A metal with measured constants.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Metal {
    /// No metal: the constants given.
    None,
    Gold,
    Silver,
    Copper,
    Aluminium,
    Iron,
    Chromium,
    Nickel,
    Titanium,
}

/// Optical constants of red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetalRgb {
    /// Refractive index.
    pub eta: [f64; 3],
    /// Extinction coefficient.
    pub kappa: [f64; 3],
    /// Reflectance at normal incidence.
    pub f: [f64; 3],
}

/// Dominant wavelengths of the sRGB primaries, nm.
pub const RGB_NM: [f64; 3] = [611.4, 549.1, 464.2];

impl Metal {
    /// Every metal.
    pub const ALL: [Self; 8] =
        [Self::Gold, Self::Silver, Self::Copper, Self::Aluminium, Self::Iron, Self::Chromium, Self::Nickel, Self::Titanium];

    /// The measurements: rows of wavelength (nm, rising), η, κ; none for [`Metal::None`].
    pub const fn table(self) -> &'static [[f64; 3]] {
        match self {
            Self::None => &[],
            Self::Gold => GOLD,
            Self::Silver => SILVER,
            Self::Copper => COPPER,
            Self::Aluminium => ALUMINIUM,
            Self::Iron => IRON,
            Self::Chromium => CHROMIUM,
            Self::Nickel => NICKEL,
            Self::Titanium => TITANIUM,
        }
    }

    /// η and κ at a wavelength in nm, linear between measurements and constant beyond them; `None` for [`Metal::None`].
    pub fn at(self, nm: f64) -> Option<[f64; 2]> {
        let table = self.table();
        let (first, last) = (table.first()?, table.last()?);
        let nm = nm.clamp(first[0], last[0]);
        let upper = table.partition_point(|row| row[0] < nm).clamp(1, table.len() - 1);
        let ([x0, eta0, kappa0], [x1, eta1, kappa1]) = (table[upper - 1], table[upper]);
        let t = (nm - x0) / (x1 - x0);
        Some([eta0 + (eta1 - eta0) * t, kappa0 + (kappa1 - kappa0) * t])
    }

    /// Red, green and blue; `None` for [`Metal::None`].
    pub fn rgb(self) -> Option<MetalRgb> {
        let mut out = MetalRgb { eta: [0.0; 3], kappa: [0.0; 3], f: [0.0; 3] };
        for (channel, nm) in RGB_NM.into_iter().enumerate() {
            let [eta, kappa] = self.at(nm)?;
            (out.eta[channel], out.kappa[channel], out.f[channel]) = (eta, kappa, normal_reflectance(eta, kappa));
        }
        Some(out)
    }
}

const GOLD: &[[f64; 3]] = &[
    [381.5, 1.46, 1.933],
    [397.4, 1.47, 1.952],
    [413.3, 1.46, 1.958],
    [430.5, 1.45, 1.948],
    [450.9, 1.38, 1.914],
    [471.4, 1.31, 1.849],
    [495.9, 1.04, 1.833],
    [520.9, 0.62, 2.081],
    [548.6, 0.43, 2.455],
    [582.1, 0.29, 2.863],
    [616.8, 0.21, 3.272],
    [659.5, 0.14, 3.697],
    [704.5, 0.13, 4.103],
    [756.0, 0.14, 4.542],
    [821.1, 0.16, 5.083],
];

const SILVER: &[[f64; 3]] = &[
    [381.5, 0.05, 1.864],
    [397.4, 0.05, 2.07],
    [413.3, 0.05, 2.275],
    [430.5, 0.04, 2.462],
    [450.9, 0.04, 2.657],
    [471.4, 0.05, 2.869],
    [495.9, 0.05, 3.093],
    [520.9, 0.05, 3.324],
    [548.6, 0.06, 3.586],
    [582.1, 0.05, 3.858],
    [616.8, 0.06, 4.152],
    [659.5, 0.05, 4.483],
    [704.5, 0.04, 4.838],
    [756.0, 0.03, 5.242],
    [821.1, 0.04, 5.727],
];

const COPPER: &[[f64; 3]] = &[
    [381.5, 1.33, 2.045],
    [397.4, 1.32, 2.116],
    [413.3, 1.28, 2.207],
    [430.5, 1.25, 2.305],
    [450.9, 1.24, 2.397],
    [471.4, 1.25, 2.483],
    [495.9, 1.22, 2.564],
    [520.9, 1.18, 2.608],
    [548.6, 1.02, 2.577],
    [582.1, 0.7, 2.704],
    [616.8, 0.3, 3.205],
    [659.5, 0.22, 3.747],
    [704.5, 0.21, 4.205],
    [756.0, 0.24, 4.665],
    [821.1, 0.26, 5.18],
];

const ALUMINIUM: &[[f64; 3]] = &[
    [364.66, 0.39877, 4.3957],
    [413.28, 0.52135, 5.0008],
    [442.8, 0.6079, 5.3676],
    [476.87, 0.7278, 5.7781],
    [516.6, 0.8734, 6.2418],
    [563.57, 1.0728, 6.7839],
    [619.93, 1.366, 7.4052],
    [652.25, 1.5724, 7.7354],
    [688.81, 1.8301, 8.0601],
    [729.32, 2.1606, 8.3565],
    [774.91, 2.6154, 8.4914],
    [794.78, 2.7675, 8.3866],
];

const IRON: &[[f64; 3]] = &[
    [381.0, 2.12, 2.5],
    [397.0, 2.24, 2.58],
    [413.0, 2.35, 2.65],
    [431.0, 2.48, 2.71],
    [451.0, 2.59, 2.77],
    [471.0, 2.67, 2.82],
    [496.0, 2.74, 2.88],
    [521.0, 2.86, 2.91],
    [549.0, 2.95, 2.93],
    [582.0, 2.94, 2.99],
    [617.0, 2.88, 3.05],
    [659.0, 2.92, 3.1],
    [704.0, 2.86, 3.19],
    [756.0, 2.87, 3.28],
    [821.0, 2.94, 3.39],
];

#[allow(clippy::approx_constant, reason = "the extinction at 451 nm, measured")]
const CHROMIUM: &[[f64; 3]] = &[
    [381.0, 1.92, 2.74],
    [397.0, 2.0, 2.83],
    [413.0, 2.08, 2.93],
    [431.0, 2.19, 3.04],
    [451.0, 2.33, 3.14],
    [471.0, 2.51, 3.24],
    [496.0, 2.75, 3.3],
    [521.0, 2.94, 3.33],
    [549.0, 3.18, 3.33],
    [582.0, 3.22, 3.3],
    [617.0, 3.17, 3.3],
    [659.0, 3.09, 3.34],
    [704.0, 3.05, 3.39],
    [756.0, 3.08, 3.42],
    [821.0, 3.2, 3.48],
];

const NICKEL: &[[f64; 3]] = &[
    [381.0, 1.72, 2.48],
    [397.0, 1.72, 2.57],
    [413.0, 1.7, 2.69],
    [431.0, 1.71, 2.82],
    [451.0, 1.73, 2.95],
    [471.0, 1.78, 3.09],
    [496.0, 1.82, 3.25],
    [521.0, 1.85, 3.42],
    [549.0, 1.92, 3.61],
    [582.0, 1.96, 3.8],
    [617.0, 1.99, 4.02],
    [659.0, 1.99, 4.26],
    [704.0, 2.06, 4.5],
    [756.0, 2.13, 4.73],
    [821.0, 2.26, 4.97],
];

const TITANIUM: &[[f64; 3]] = &[
    [381.0, 1.99, 2.93],
    [397.0, 2.08, 2.95],
    [413.0, 2.14, 2.98],
    [431.0, 2.21, 3.01],
    [451.0, 2.27, 3.04],
    [471.0, 2.32, 3.1],
    [496.0, 2.36, 3.19],
    [521.0, 2.44, 3.3],
    [549.0, 2.54, 3.43],
    [582.0, 2.6, 3.58],
    [617.0, 2.67, 3.72],
    [659.0, 2.76, 3.84],
    [704.0, 2.86, 3.96],
    [756.0, 3.0, 4.01],
    [821.0, 3.21, 4.01],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_cover_the_visible_range_in_order() {
        for metal in Metal::ALL {
            let table = metal.table();
            assert!(table.windows(2).all(|pair| pair[0][0] < pair[1][0]), "{metal:?}");
            assert!(table[0][0] <= 382.0 && table[table.len() - 1][0] >= 780.0, "{metal:?}");
            assert!(table.iter().all(|[_, eta, kappa]| *eta > 0.0 && *kappa > 1.0), "{metal:?}");
        }
        assert_eq!(Metal::None.at(500.0), None);
        assert_eq!(Metal::None.rgb(), None);
    }

    #[test]
    fn measurements_are_met_and_joined_by_lines() {
        assert_eq!(Metal::Gold.at(582.1), Some([0.29, 2.863]));
        let [eta, kappa] = Metal::Gold.at(0.5 * (548.6 + 582.1)).unwrap();
        assert!((eta - 0.36).abs() < 1e-12 && (kappa - 2.659).abs() < 1e-12);
        assert_eq!(Metal::Gold.at(100.0), Metal::Gold.at(381.5));
        assert_eq!(Metal::Aluminium.at(5000.0), Metal::Aluminium.at(794.78));
    }

    /// Colours and reflectances that everybody knows: gold and copper are warm, silver and aluminium reflect most, iron and chromium are dark greys.
    #[test]
    fn metals_have_their_colours() {
        for (metal, expected) in [
            (Metal::Gold, [0.93, 0.78, 0.38]),
            (Metal::Silver, [0.99, 0.98, 0.98]),
            (Metal::Copper, [0.90, 0.62, 0.56]),
            (Metal::Aluminium, [0.91, 0.915, 0.92]),
            (Metal::Iron, [0.55, 0.53, 0.50]),
            (Metal::Chromium, [0.57, 0.57, 0.54]),
            (Metal::Nickel, [0.68, 0.64, 0.58]),
            (Metal::Titanium, [0.61, 0.59, 0.56]),
        ] {
            let f = metal.rgb().unwrap().f;
            for (value, expected) in f.into_iter().zip(expected) {
                assert!((value - expected).abs() < 0.03, "{metal:?}: {f:?}");
            }
        }
    }
}
