//! Large arrays in large pages: rays jump about in them, and every small page that they come to must be looked up.

/// Smaller arrays stay as they are, bytes.
const LEAST: usize = 8 << 20;

/// The same array without spare room; a large one moves to memory that the operating system is asked to back with large pages.
pub(crate) fn settled<T: Copy>(mut array: Vec<T>) -> Vec<T> {
    array.shrink_to_fit();
    if size_of_val(&array[..]) < LEAST {
        return array;
    }
    let mut moved = Vec::with_capacity(array.len());
    ask_for_large_pages(moved.spare_capacity_mut());
    moved.extend_from_slice(&array);
    moved
}

/// A wish: where it cannot be met, nothing changes.
#[cfg(target_os = "linux")]
fn ask_for_large_pages<T>(fresh: &mut [std::mem::MaybeUninit<T>]) {
    use std::ffi::{c_int, c_void};
    const HUGEPAGE: c_int = 14;
    const SMALL_PAGE: usize = 4096;
    unsafe extern "C" {
        fn madvise(start: *mut c_void, length: usize, advice: c_int) -> c_int;
    }
    let start = fresh.as_mut_ptr().cast::<u8>();
    let skipped = start.align_offset(SMALL_PAGE);
    let length = size_of_val(fresh).saturating_sub(skipped);
    // SAFETY: the range lies in `fresh`, and the advice changes neither what memory holds nor who may use it.
    unsafe {
        madvise(start.wrapping_add(skipped).cast(), length / SMALL_PAGE * SMALL_PAGE, HUGEPAGE);
    }
}

#[cfg(not(target_os = "linux"))]
fn ask_for_large_pages<T>(_: &mut [std::mem::MaybeUninit<T>]) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_of_every_size_keep_what_they_hold() {
        for count in [0, 5, 1000, LEAST / 4, LEAST / 4 + 12_345] {
            let mut array: Vec<u32> = (0..count as u32).collect();
            array.reserve(100);
            let settled = settled(array);
            assert!(settled.capacity() == count && settled.iter().enumerate().all(|(i, &n)| i as u32 == n), "{count}");
        }
    }
}
