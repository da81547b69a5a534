//! Looking textures up on the CPU: texel addressing, filtering at full resolution, and decoding.
//!
//! Texel (x, y) of a `width × height` image covers [x, x+1] × [y, y+1] in texel space, its centre is at half-integers, and texture
//! coordinate (u, v) is the point (u·width, v·height). Encoded colours are decoded before they are filtered. Minification is left to
//! supersampling: a renderer that takes many samples a pixel integrates the texture itself, and what filtering could save was measured to be little
//! (docs/performance.md, Texture filtering).

use crate::{ColorSpace, Filter, Scene, Texels, Texture, TextureImage, TextureRef, Wrap};
use glam::{Vec2, Vec3, Vec4};
use kajo_units::linear_from_srgb;

/// One axis of a lookup: two texels and the weight of the second.
#[derive(Clone, Copy)]
struct Taps {
    first: u32,
    second: u32,
    weight: f32,
}

impl Wrap {
    /// Folds a texture coordinate into [0, 1]. Coordinates that are not finite land on 0.
    #[inline]
    fn fold(self, u: f32) -> f32 {
        if !u.is_finite() {
            return 0.0;
        }
        match self {
            Self::Repeat => u - u.floor(),
            Self::Mirror => 1.0 - (u - 2.0 * (u * 0.5).floor() - 1.0).abs(),
            Self::Clamp => u.clamp(0.0, 1.0),
        }
    }

    /// The texel that contains `u` on an axis of `size` texels.
    #[inline]
    fn nearest(self, u: f32, size: u32) -> u32 {
        ((self.fold(u) * size as f32) as u32).min(size - 1)
    }

    /// The two texels whose centres enclose `u`. Beyond the border stand the opposite texel (repeat) or the border texel again: mirroring
    /// repeats it, since the fold has already turned the coordinate round.
    #[inline]
    fn bilinear(self, u: f32, size: u32) -> Taps {
        let x = self.fold(u) * size as f32 - 0.5;
        let floor = x.floor();
        let (first, last) = (floor as i32, size as i32 - 1);
        let second = first + 1;
        let (before, after) = if self == Self::Repeat { (last, 0) } else { (0, last) };
        Taps {
            first: if first < 0 { before } else { first.min(last) } as u32,
            second: if second > last { after } else { second } as u32,
            weight: x - floor,
        }
    }
}

impl TextureImage {
    /// The decoded texel in column `x` and row `y`: linear RGB and alpha, [0, 1] for integer formats.
    ///
    /// # Panics
    /// When `x` or `y` is outside the image.
    #[inline]
    pub fn texel(&self, x: u32, y: u32, color_space: ColorSpace) -> Vec4 {
        let index = y as usize * self.width as usize + x as usize;
        match (&self.texels, color_space) {
            (Texels::Rgba8(texels), ColorSpace::Srgb) => {
                let [r, g, b, a] = texels[index];
                let decode = |c: u8| LINEAR_FROM_SRGB8[c as usize];
                Vec4::new(decode(r), decode(g), decode(b), f32::from(a) * (1.0 / 255.0))
            }
            (Texels::Rgba8(texels), ColorSpace::Linear) => Vec4::from_array(texels[index].map(f32::from)) * (1.0 / 255.0),
            (Texels::Rgba16(texels), space) => {
                let encoded = Vec4::from_array(texels[index].map(f32::from)) * (1.0 / 65535.0);
                match space {
                    ColorSpace::Srgb => encoded.truncate().map(linear_from_srgb).extend(encoded.w),
                    ColorSpace::Linear => encoded,
                }
            }
            (Texels::Rgba32F(texels), _) => Vec4::from_array(texels[index]),
            (Texels::Rgb32F(texels), _) => Vec3::from_array(texels[index]).extend(1.0),
        }
    }

    /// Alpha of the texel in column `x` and row `y`.
    #[inline]
    fn texel_alpha(&self, x: u32, y: u32) -> f32 {
        let index = y as usize * self.width as usize + x as usize;
        match &self.texels {
            Texels::Rgba8(texels) => f32::from(texels[index][3]) * (1.0 / 255.0),
            Texels::Rgba16(texels) => f32::from(texels[index][3]) * (1.0 / 65535.0),
            Texels::Rgba32F(texels) => texels[index][3],
            Texels::Rgb32F(_) => 1.0,
        }
    }

    /// Memory of the texels, bytes.
    pub fn bytes(&self) -> usize {
        match &self.texels {
            Texels::Rgba8(texels) => size_of_val(texels.as_slice()),
            Texels::Rgba16(texels) => size_of_val(texels.as_slice()),
            Texels::Rgba32F(texels) => size_of_val(texels.as_slice()),
            Texels::Rgb32F(texels) => size_of_val(texels.as_slice()),
        }
    }

    /// Mean of all decoded texels.
    pub fn average(&self, color_space: ColorSpace) -> Vec4 {
        let mut sum = glam::DVec4::ZERO;
        for y in 0..self.height {
            for x in 0..self.width {
                sum += self.texel(x, y, color_space).as_dvec4();
            }
        }
        (sum / (f64::from(self.width) * f64::from(self.height))).as_vec4()
    }
}

impl Texture {
    /// The texture's value at `uv`: linear RGB and alpha. `image` is the one that [`Texture::image`] names; it has at least one texel.
    #[inline]
    pub fn lookup(&self, image: &TextureImage, uv: Vec2) -> Vec4 {
        self.filtered(image, uv, |x, y| image.texel(x, y, self.color_space))
    }

    /// Alpha alone, for alpha tests.
    #[inline]
    pub fn lookup_alpha(&self, image: &TextureImage, uv: Vec2) -> f32 {
        self.filtered(image, uv, |x, y| image.texel_alpha(x, y))
    }

    #[inline]
    fn filtered<T>(&self, image: &TextureImage, uv: Vec2, texel: impl Fn(u32, u32) -> T) -> T
    where
        T: std::ops::Add<Output = T> + std::ops::Mul<f32, Output = T>,
    {
        let [wrap_u, wrap_v] = self.wrap;
        match self.filter {
            Filter::Nearest => texel(wrap_u.nearest(uv.x, image.width), wrap_v.nearest(uv.y, image.height)),
            Filter::Linear => {
                let (u, v) = (wrap_u.bilinear(uv.x, image.width), wrap_v.bilinear(uv.y, image.height));
                let row = |y| texel(u.first, y) * (1.0 - u.weight) + texel(u.second, y) * u.weight;
                row(v.first) * (1.0 - v.weight) + row(v.second) * v.weight
            }
        }
    }
}

impl TextureRef {
    /// The texture's value for a surface point with texture coordinates `uvs`.
    #[inline]
    pub fn lookup(&self, scene: &Scene, uvs: &[Vec2; 2]) -> Vec4 {
        let texture = &scene.textures[self.texture];
        texture.lookup(&scene.images[texture.image], self.transform.transform_point2(uvs[self.uv_set]))
    }

    /// Alpha alone, for alpha tests.
    #[inline]
    pub fn lookup_alpha(&self, scene: &Scene, uvs: &[Vec2; 2]) -> f32 {
        let texture = &scene.textures[self.texture];
        texture.lookup_alpha(&scene.images[texture.image], self.transform.transform_point2(uvs[self.uv_set]))
    }
}

/// Linear values of the 256 codes of sRGB: the function [`linear_from_srgb`] as a table.
static LINEAR_FROM_SRGB8: [f32; 256] = srgb8_table();

/// x^2.4 = x² · (x²)^(1/5); the fifth root is found by Newton's method, since `powf` is no constant function.
const fn srgb8_table() -> [f32; 256] {
    let mut table = [0.0; 256];
    let mut code = 0;
    while code < 256 {
        let encoded = code as f64 / 255.0;
        table[code] = if encoded <= 0.040_45 {
            (encoded / 12.92) as f32
        } else {
            let x = (encoded + 0.055) / 1.055;
            let square = x * x;
            let mut root = 1.0;
            let mut step = 0;
            while step < 40 {
                root = 0.8 * root + 0.2 * square / (root * root * root * root);
                step += 1;
            }
            (square * root) as f32
        };
        code += 1;
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A `width × 1` image whose texel x has red = x.
    fn ramp(width: u32) -> TextureImage {
        let texels = (0..width).map(|x| [x as f32, 0.0, 0.0, 1.0]).collect();
        TextureImage { name: "ramp".into(), width, height: 1, texels: Texels::Rgba32F(texels) }
    }

    fn texture(wrap: Wrap, filter: Filter) -> Texture {
        Texture { image: 0, wrap: [wrap; 2], filter, color_space: ColorSpace::Linear }
    }

    fn red(image: &TextureImage, wrap: Wrap, filter: Filter, u: f32) -> f32 {
        texture(wrap, filter).lookup(image, Vec2::new(u, 0.5)).x
    }

    #[test]
    fn table_is_the_srgb_function() {
        for code in 0..=255u8 {
            let expected = linear_from_srgb(f32::from(code) / 255.0);
            assert!((LINEAR_FROM_SRGB8[code as usize] - expected).abs() <= 2e-7, "{code}");
        }
    }

    #[test]
    fn texel_centres_return_their_texel_for_every_wrap_and_filter() {
        let image = ramp(7);
        for filter in [Filter::Nearest, Filter::Linear] {
            for x in 0..7 {
                let u = (x as f32 + 0.5) / 7.0;
                for (wrap, u) in [
                    (Wrap::Repeat, u),
                    (Wrap::Repeat, u + 3.0),
                    (Wrap::Repeat, u - 2.0),
                    (Wrap::Mirror, u),
                    (Wrap::Mirror, -u),
                    (Wrap::Mirror, 2.0 - u),
                    (Wrap::Mirror, u + 4.0),
                    (Wrap::Clamp, u),
                ] {
                    let got = red(&image, wrap, filter, u);
                    assert!((got - x as f32).abs() < 1e-4, "{wrap:?} {filter:?} u {u}: {got} for texel {x}");
                }
            }
        }
    }

    #[test]
    fn bilinear_is_linear_between_centres() {
        let image = ramp(4);
        assert!((red(&image, Wrap::Repeat, Filter::Linear, 0.5) - 1.5).abs() < 1e-6);
        assert!((red(&image, Wrap::Clamp, Filter::Linear, (1.25 + 0.5) / 4.0) - 1.25).abs() < 1e-6);
    }

    #[test]
    fn borders_wrap_mirror_and_clamp() {
        let image = ramp(4);
        // u = 0 lies half-way between texel 0 and its neighbour beyond the border: 3, 0 or 0.
        assert!((red(&image, Wrap::Repeat, Filter::Linear, 0.0) - 1.5).abs() < 1e-6);
        assert_eq!(red(&image, Wrap::Mirror, Filter::Linear, 0.0), 0.0);
        assert_eq!(red(&image, Wrap::Clamp, Filter::Linear, 0.0), 0.0);
        assert_eq!(red(&image, Wrap::Mirror, Filter::Linear, 1.0), 3.0);
        assert_eq!(red(&image, Wrap::Clamp, Filter::Linear, 1.0), 3.0);
        assert_eq!(red(&image, Wrap::Clamp, Filter::Nearest, 17.0), 3.0);
        assert_eq!(red(&image, Wrap::Clamp, Filter::Nearest, -17.0), 0.0);
        assert_eq!(red(&image, Wrap::Repeat, Filter::Nearest, 1.0), 0.0);
        assert_eq!(red(&image, Wrap::Mirror, Filter::Nearest, 1.0), 3.0);
    }

    #[test]
    fn extreme_coordinates_stay_inside_the_image() {
        let image = ramp(5);
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for filter in [Filter::Nearest, Filter::Linear] {
                for u in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, -1e-30, 1e9, -1.0, 1.0 - f32::EPSILON] {
                    let got = red(&image, wrap, filter, u);
                    assert!((0.0..=4.0).contains(&got), "{wrap:?} {filter:?} {u}: {got}");
                }
            }
        }
    }

    #[test]
    fn a_single_texel_fills_the_plane() {
        let image = ramp(1);
        for u in [-3.7, 0.0, 0.2, 0.9, 1.0, 12.1] {
            for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
                assert_eq!(red(&image, wrap, Filter::Linear, u), 0.0);
            }
        }
    }

    #[test]
    fn colours_are_decoded_before_filtering_and_alpha_is_not() {
        let texels = Texels::Rgba8(vec![[0, 0, 0, 0], [255, 255, 255, 255]]);
        let image = TextureImage { name: String::new(), width: 2, height: 1, texels };
        let srgb = Texture { color_space: ColorSpace::Srgb, ..texture(Wrap::Clamp, Filter::Linear) };
        let middle = srgb.lookup(&image, Vec2::new(0.5, 0.5));
        assert!((middle - Vec4::splat(0.5)).abs().max_element() < 1e-6, "{middle}");

        let grey = TextureImage { name: String::new(), width: 1, height: 1, texels: Texels::Rgba8(vec![[128, 128, 128, 128]]) };
        let value = srgb.lookup(&grey, Vec2::ZERO);
        assert!((value.x - 0.215_86).abs() < 1e-5 && (value.w - 128.0 / 255.0).abs() < 1e-6, "{value}");
        assert_eq!(srgb.lookup_alpha(&grey, Vec2::ZERO), value.w);

        let deep = TextureImage { texels: Texels::Rgba16(vec![[32896; 4]]), ..grey };
        let deep_value = srgb.lookup(&deep, Vec2::ZERO);
        assert!((deep_value - value).abs().max_element() < 1e-6, "16 bits agree with 8: {deep_value} {value}");
    }

    #[test]
    fn average_is_the_mean_of_texels() {
        assert_eq!(ramp(5).average(ColorSpace::Linear), Vec4::new(2.0, 0.0, 0.0, 1.0));
        assert_eq!(ramp(5).bytes(), 5 * 16);
    }
}
