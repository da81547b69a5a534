//! Connected sets of pixels.

use kajo_image::Image;

/// The connected sets of a mask (8 neighbours), each as indices of its pixels, in the order of their first pixels.
pub fn regions(mask: &Image<bool>) -> Vec<Vec<usize>> {
    let (width, height) = (mask.width() as usize, mask.height() as usize);
    let mut left: Vec<bool> = mask.pixels().to_vec();
    let mut out = Vec::new();
    for start in 0..left.len() {
        if !std::mem::take(&mut left[start]) {
            continue;
        }
        let mut region = vec![start];
        let mut next = 0;
        while let Some(&at) = region.get(next) {
            next += 1;
            let (x, y) = (at % width, at / width);
            for v in y.saturating_sub(1)..=(y + 1).min(height - 1) {
                for u in x.saturating_sub(1)..=(x + 1).min(width - 1) {
                    if std::mem::take(&mut left[v * width + u]) {
                        region.push(v * width + u);
                    }
                }
            }
        }
        out.push(region);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    #[test]
    fn corners_connect_and_gaps_do_not() {
        let picture = ["##..#", "..#..", "#...#", "#..##"];
        let mask = Image::from_fn(UVec2::new(5, 4), |x, y| picture[y as usize].as_bytes()[x as usize] == b'#');
        let found = regions(&mask);
        assert_eq!(found.iter().map(Vec::len).collect::<Vec<_>>(), [3, 1, 2, 3]);
        assert!(regions(&mask.map(|_| false)).is_empty());
    }
}
