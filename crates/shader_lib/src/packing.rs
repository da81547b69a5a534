//! Unit vectors in few bits: the twin of `shader_lib::packing`.

use glam::{Vec2, Vec3};

/// A unit vector as a point of [−1, 1]²: projected to the octahedron, its lower half folded outwards.    \[Cigolle14] section 3
pub fn octahedral_encode(n: Vec3) -> Vec2 {
    let p = n.truncate() / (n.x.abs() + n.y.abs() + n.z.abs());
    if n.z >= 0.0 { p } else { fold(p) }
}

/// The inverse of [`octahedral_encode`]; unit length.
pub fn octahedral_decode(p: Vec2) -> Vec3 {
    let z = 1.0 - p.x.abs() - p.y.abs();
    let xy = if z >= 0.0 { p } else { fold(p) };
    xy.extend(z).normalize()
}

/// A unit vector in 32 bits, 16 a coordinate; the direction is off by less than 8e-5 rad.
pub fn pack_normal(n: Vec3) -> u32 {
    let [x, y] = octahedral_encode(n).to_array().map(|c| (c.clamp(-1.0, 1.0) * 32767.0 + 0.5).floor() as i16 as u16);
    u32::from(x) | u32::from(y) << 16
}

/// The inverse of [`pack_normal`].
pub fn unpack_normal(bits: u32) -> Vec3 {
    let snorm = |half: u32| (f32::from(half as u16 as i16) / 32767.0).max(-1.0);
    octahedral_decode(Vec2::new(snorm(bits), snorm(bits >> 16)))
}

fn fold(p: Vec2) -> Vec2 {
    let sign = |c: f32| if c >= 0.0 { 1.0 } else { -1.0 };
    Vec2::new((1.0 - p.y.abs()) * sign(p.x), (1.0 - p.x.abs()) * sign(p.y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_sampling::{Rng, warp};

    #[test]
    fn directions_survive_packing() {
        let mut rng = Rng::new(1);
        let axes = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z];
        let random = (0..20_000).map(|_| warp::uniform_sphere(rng.next_2d()));
        for n in axes.into_iter().chain(random) {
            assert!(octahedral_decode(octahedral_encode(n)).angle_between(n) < 1e-3, "{n}");
            let packed = unpack_normal(pack_normal(n));
            assert!(packed.cross(n).length() < 8e-5 && packed.dot(n) > 0.0, "{n} became {packed}");
        }
    }
}
