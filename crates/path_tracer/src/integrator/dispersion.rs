//! Dispersion: a path that a prism has split carries one channel from there on.
//!
//! Each channel has its own index of refraction. A path that kept all three would follow one of them at every dispersive surface, through
//! glass that it enters and leaves it would lose two of three. So where the weights of the channels have come apart, the path keeps one of
//! them, chosen with probability proportional to its throughput T, and goes on with the index of that channel alone:
//!
//! ```text
//! T_c → T_c / p_c = T_r + T_g + T_b,    p_c = T_c / (T_r + T_g + T_b)
//! ```

use super::Split;
use crate::surface::Surface;
use kajo_bsdf::LobeValues;
use kajo_sampling::Sampler;
use kajo_units::LinearRgb;

/// Channels have come apart when the least weight is below this share of the greatest. Rough glass that spreads light wider than its
/// colours keeps them together: one direction serves all three.
const APART: f32 = 0.25;

/// The channel that a path is left with (0, 1, 2); `None`: all.
pub(crate) type Channel = Option<usize>;

/// After a sample of `weight` at `surface`: chooses a channel if it is time to, and reduces `throughput` to it.
#[inline]
pub(crate) fn disperse(surface: &Surface, weight: LobeValues, channel: &mut Channel, throughput: &mut Split, sampler: &mut Sampler) {
    if channel.is_some() || !surface.disperses() {
        return;
    }
    let u = sampler.next_1d();
    let weight = weight.total().0;
    if weight.min_element() < APART * weight.max_element() {
        *channel = choose(throughput, u);
    }
}

/// Reduces `throughput` to one channel; `None` when it is black.
fn choose(throughput: &mut Split, u: f32) -> Channel {
    let total = throughput.total().0;
    let sum = total.element_sum();
    let channel = if u * sum < total.x {
        0
    } else if u * sum < total.x + total.y {
        1
    } else {
        2
    };
    // Rounding may lead to a channel without light.
    let channel = if total[channel] > 0.0 { channel } else { total.max_position() };
    if total[channel].is_nan() || total[channel] <= 0.0 {
        return None;
    }
    let mut scale = LinearRgb::BLACK;
    scale.0[channel] = sum / total[channel];
    *throughput = throughput.scaled(scale);
    Some(channel)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_choice_keeps_the_mean_of_every_channel_and_the_sum_of_each_path() {
        let before = Split { diffuse: LinearRgb::new(0.1, 0.0, 0.3), specular: LinearRgb::new(0.5, 0.0, 0.1) };
        let (mut mean, n) = (LinearRgb::BLACK, 1000);
        for i in 0..n {
            let mut after = before;
            let channel = choose(&mut after, (i as f32 + 0.5) / n as f32).expect("light");
            assert!((after.total().0.element_sum() - 1.0).abs() < 1e-6 && after.total().0[channel] > 0.999);
            mean += after.total() * (1.0 / n as f32);
        }
        assert!(mean.0.abs_diff_eq(before.total().0, 2e-3), "{mean:?}");
        assert_eq!(choose(&mut Split::default(), 0.5), None);
    }
}
