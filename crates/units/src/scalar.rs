//! Scalar quantities: one `f32` and its unit.

macro_rules! scalar {
    ($($(#[$doc:meta])* $name:ident;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, bytemuck::Pod, bytemuck::Zeroable, serde::Serialize, serde::Deserialize)]
        #[repr(transparent)]
        #[serde(transparent)]
        pub struct $name(pub f32);

        impl $name {
            /// The bare number, in the unit of the type.
            pub const fn get(self) -> f32 {
                self.0
            }
        }
    )*};
}

scalar! {
    /// Length, m.
    Meters;
    /// Plane angle, rad.
    Radians;
    /// Time, s.
    Seconds;
    /// Luminous flux, lm.
    Lumens;
    /// Luminous intensity, cd = lm/sr.
    Candela;
    /// Illuminance, lx = lm/m².
    Lux;
    /// Luminance, nt = cd/m².
    Nits;
    /// Colour temperature, K.
    Kelvin;
    /// Exposure value at ISO 100: log₂(N²/t) of a camera with f-number N and exposure time t seconds.
    Ev100;
    /// Radiant power (flux), W.
    RadiantFlux;
    /// Irradiance, and radiosity (radiant exitance), W/m².
    Irradiance;
    /// Radiance, W/(m² sr).
    Radiance;
    /// Radiant intensity, W/sr.
    RadiantIntensity;
}

impl Radians {
    /// Converts from degrees.
    pub fn from_degrees(degrees: f32) -> Self {
        Self(degrees.to_radians())
    }
}

impl RadiantFlux {
    /// E = Φ/A of light that arrives evenly at an area, or B = Φ/A of light that leaves it. `square_meters` > 0.
    pub fn per_area(self, square_meters: f32) -> Irradiance {
        Irradiance(self.0 / square_meters)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Row BR-2: 50 W on 1.25 m², 100 W from 0.1 m².
    #[test]
    fn power_over_area_is_irradiance_and_radiosity() {
        assert_eq!(RadiantFlux(50.0).per_area(1.25), Irradiance(40.0));
        assert_eq!(RadiantFlux(100.0).per_area(0.1), Irradiance(1000.0));
    }
}
