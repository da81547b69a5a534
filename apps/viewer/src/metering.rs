//! Who sets the exposure, and how it follows the light.

use std::time::Duration;

/// Who sets the exposure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Metering {
    /// The user, or the scene.
    #[default]
    Fixed,
    /// The next frame, once.
    Once,
    /// Every frame: the exposure follows what is seen.
    Following,
}

/// Time in which the exposure comes closer to what is metered by the factor e: an eye that steps into the light takes about as long.
const ADAPTATION: f32 = 0.4;

/// Longest time between frames in which an exposure follows.
pub(crate) const LONGEST_STEP: Duration = Duration::from_millis(100);

/// Difference in stops that nobody sees: the exposure rests within it, and with it the picture.
const REST: f32 = 0.05;

/// The exposure `elapsed` after it was `stops`, when `metered` would be right, in stops.
///
/// ```text
/// e(t + Δt) = e(t) + (m − e(t)) (1 − exp(−Δt / τ))
/// ```
pub(crate) fn adapted(stops: f32, metered: f32, elapsed: Duration) -> f32 {
    let far = metered - stops;
    if far.abs() < REST {
        return stops;
    }
    stops + far * (1.0 - (-elapsed.as_secs_f32() / ADAPTATION).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exposure_follows_and_comes_to_rest() {
        let step = Duration::from_millis(50);
        let mut stops = 0.0;
        let mut way = Vec::new();
        for _ in 0..60 {
            stops = adapted(stops, 4.0, step);
            way.push(stops);
        }
        assert!(way.windows(2).all(|pair| pair[0] <= pair[1]), "it never turns back: {way:?}");
        // After τ all but 1/e of the way is gone.
        assert!((way[7] - 4.0 * (1.0 - (-1.0f32).exp())).abs() < 1e-3, "{}", way[7]);
        assert_eq!(way[58], way[59], "it rests");
        assert!((way[59] - 4.0).abs() < REST);
    }

    #[test]
    fn one_long_step_is_many_short_ones() {
        let long = adapted(1.0, -3.0, Duration::from_millis(400));
        let short = (0..8).fold(1.0, |stops, _| adapted(stops, -3.0, Duration::from_millis(50)));
        assert!((long - short).abs() < 1e-4, "{long} {short}");
    }
}
