//! The coarsest threshold that is good enough.

/// Steps at most, and halves of the last one.
const STEPS: usize = 12;
/// See [`STEPS`].
const HALVES: usize = 4;

/// Tries thresholds by steps of `factor` from `first`: to finer ones until one is good, or, where the first is good, to coarser ones until one is not; then halves
/// of the step between the two, in the logarithm. What is tried is for `is_good` to remember.
///
/// # Errors
/// Those of `is_good`.
pub fn search<E>(first: f32, factor: f32, mut is_good: impl FnMut(f32) -> Result<bool, E>) -> Result<(), E> {
    let begins_good = is_good(first)?;
    let step = if begins_good { 1.0 / factor } else { factor };
    let mut last = first;
    for _ in 1..STEPS {
        let next = last * step;
        if is_good(next)? != begins_good {
            let (mut good, mut bad) = if begins_good { (last, next) } else { (next, last) };
            for _ in 0..HALVES {
                let middle = (bad * good).sqrt();
                *(if is_good(middle)? { &mut good } else { &mut bad }) = middle;
            }
            return Ok(());
        }
        last = next;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Everything that is tried, and of it the largest that is below `limit`: finer thresholds are smaller.
    fn tried(first: f32, limit: f32) -> (Vec<f32>, Option<f32>) {
        let mut all = Vec::new();
        let good = |threshold: f32| {
            all.push(threshold);
            Ok::<_, ()>(threshold < limit)
        };
        search(first, 0.5, good).unwrap();
        let best = all.iter().copied().filter(|threshold| *threshold < limit).reduce(f32::max);
        (all, best)
    }

    #[test]
    fn the_threshold_is_found_from_either_side() {
        for limit in [0.01, 0.3, 0.99, 1.7, 50.0] {
            let (_, best) = tried(1.0, limit);
            let best = best.unwrap();
            assert!(best < limit && best > limit * 0.5f32.powf(1.1 / 16.0), "{limit}: {best}");
        }
    }

    /// Where the steps end before a good one is found, or a bad one, nothing is taken for what it was not tried to be.
    #[test]
    fn steps_that_end_too_early_halve_nothing() {
        for (limit, none_is_good) in [(1e-9, true), (1e9, false)] {
            let (all, best) = tried(1.0, limit);
            assert_eq!((all.len(), best.is_none()), (STEPS, none_is_good));
            let step = if none_is_good { 0.5 } else { 2.0 };
            assert!(all.windows(2).all(|pair| pair[1] == step * pair[0]), "{all:?}");
        }
    }
}
