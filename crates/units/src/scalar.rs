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
    /// Irradiance, W/m².
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
