//! Films as files, so that a long rendering survives an interruption.
//!
//! Layout, all little-endian: magic, version, fingerprints of scene and settings, size, rays, seconds, invalid samples, names of the
//! images, levels of the rows, sums, block sums, the plan of adaptive sampling if there is one, and a hash of all of it. Files are written atomically.

use crate::adaptive::Pilot;
use crate::blocks::{BLOCKS, BlockSums};
use crate::film::{Film, FilmLayout, Fingerprint};
use crate::fingerprint::StableHasher;
use crate::{Aov, PathTracerError, Settings};
use glam::UVec2;
use std::path::Path;

const MAGIC: &[u8; 8] = b"KAJOFILM";
const VERSION: u64 = 2;

impl Film {
    /// Writes the film, atomically.
    ///
    /// # Errors
    /// [`PathTracerError::CheckpointWrite`].
    pub fn save(&self, path: &Path) -> Result<(), PathTracerError> {
        Ok(kajo_image::write_atomic(path, &self.encode())?)
    }

    /// Reads a film that [`Film::save`] wrote.
    ///
    /// # Errors
    /// [`PathTracerError::CheckpointRead`], and [`PathTracerError::CheckpointFormat`] for a file that is none, of another version,
    /// or damaged.
    pub fn load(path: &Path) -> Result<Self, PathTracerError> {
        let bytes = kajo_image::read_file(path).map_err(|source| PathTracerError::CheckpointRead { path: path.into(), source })?;
        Self::decode(&bytes).map_err(|problem| PathTracerError::CheckpointFormat { path: path.into(), problem: problem.into() })
    }

    fn encode(&self) -> Vec<u8> {
        let mut out = Vec::with_capacity(self.sums.len() * 8 + self.blocks.len() * 4 * BLOCKS + self.levels.len() * 4 + 4096);
        out.extend(MAGIC);
        let header = [VERSION, self.fingerprint.scene, self.fingerprint.settings, self.size.x.into(), self.size.y.into()];
        let plan = self.plan.as_ref().map_or([0; 3], |plan| [1, plan.level.into(), plan.milestone.into()]);
        let counters = [self.rays, self.seconds.to_bits(), self.invalid, plan[0], plan[1], plan[2], self.layout.images.len() as u64];
        header.iter().chain(&counters).for_each(|v| out.extend(v.to_le_bytes()));
        for image in &self.layout.images {
            out.extend((image.name.len() as u64).to_le_bytes());
            out.extend(image.name.as_bytes());
        }
        self.levels.iter().for_each(|v| out.extend(v.to_le_bytes()));
        self.sums.iter().for_each(|v| out.extend(v.to_le_bytes()));
        bytemuck::cast_slice::<_, f32>(&self.blocks).iter().for_each(|v| out.extend(v.to_le_bytes()));
        if let Some(plan) = &self.plan {
            plan.base.iter().for_each(|v| out.extend(v.to_le_bytes()));
            plan.density.iter().for_each(|v| out.extend(v.to_le_bytes()));
            bytemuck::cast_slice::<_, f32>(&plan.pilots).iter().for_each(|v| out.extend(v.to_le_bytes()));
        }
        let hash = StableHasher::hash(&out);
        out.extend(hash.to_le_bytes());
        out
    }

    fn decode(bytes: &[u8]) -> Result<Self, &'static str> {
        if !bytes.starts_with(MAGIC) {
            return Err("it is not a checkpoint of Kajo");
        }
        let (content, hash) = bytes.split_last_chunk::<8>().ok_or("it ends early")?;
        let mut reader = Reader(content.get(MAGIC.len()..).ok_or("it ends early")?);
        if reader.u64()? != VERSION {
            return Err("it was written by another version of Kajo");
        }
        if StableHasher::hash(content) != u64::from_le_bytes(*hash) {
            return Err("it is damaged or ends early");
        }
        let fingerprint = Fingerprint { scene: reader.u64()?, settings: reader.u64()? };
        let side = |v: u64| u32::try_from(v).ok().filter(|v| (1..=Settings::MAX_SIDE).contains(v)).ok_or("its size is out of range");
        let size = UVec2::new(side(reader.u64()?)?, side(reader.u64()?)?);
        let (rays, seconds, invalid) = (reader.u64()?, f64::from_bits(reader.u64()?), reader.u64()?);
        let number = |v: u64| u32::try_from(v).map_err(|_| "its plan is out of range");
        let (adaptive, level, milestone) = (reader.u64()? == 1, number(reader.u64()?)?, number(reader.u64()?)?);
        let images = reader.u64()?;
        let mut aovs: Vec<Aov> = Vec::new();
        for index in 0..images {
            let length = usize::try_from(reader.u64()?).map_err(|_| "a name is too long")?;
            let name = std::str::from_utf8(reader.take(length)?).map_err(|_| "a name is not UTF-8")?;
            match (index, name) {
                (0, "beauty") => {}
                _ => aovs.push(name.parse().map_err(|_| "it has an image that this version does not know")?),
            }
        }
        let mut film = Self::new(size, FilmLayout::new(&aovs), fingerprint, adaptive);
        let plan = film.plan.as_ref().map_or(0, |plan| plan.base.len() * size_of::<(u32, f32, Pilot)>());
        let expected = film.levels.len() * 4 + film.sums.len() * 8 + film.blocks.len() * 4 * BLOCKS + plan;
        if reader.0.len() != expected {
            return Err("its length does not fit its size");
        }
        film.levels.iter_mut().try_for_each(|v| reader.array().map(|b| *v = u32::from_le_bytes(b)))?;
        film.sums.iter_mut().try_for_each(|v| reader.array().map(|b| *v = f64::from_le_bytes(b)))?;
        let blocks: &mut [f32] = bytemuck::cast_slice_mut::<BlockSums, f32>(&mut film.blocks);
        blocks.iter_mut().try_for_each(|v| reader.array().map(|b| *v = f32::from_le_bytes(b)))?;
        if let Some(plan) = &mut film.plan {
            (plan.level, plan.milestone) = (level, milestone);
            plan.base.iter_mut().try_for_each(|v| reader.array().map(|b| *v = u32::from_le_bytes(b)))?;
            plan.density.iter_mut().try_for_each(|v| reader.array().map(|b| *v = f32::from_le_bytes(b)))?;
            let pilots: &mut [f32] = bytemuck::cast_slice_mut(&mut plan.pilots);
            pilots.iter_mut().try_for_each(|v| reader.array().map(|b| *v = f32::from_le_bytes(b)))?;
        }
        (film.rays, film.seconds, film.invalid) = (rays, seconds, invalid);
        Ok(film)
    }
}

/// Takes bytes from the front.
struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], &'static str> {
        let (head, tail) = self.0.split_at_checked(count).ok_or("it ends early")?;
        self.0 = tail;
        Ok(head)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], &'static str> {
        let (head, tail) = self.0.split_first_chunk::<N>().ok_or("it ends early")?;
        self.0 = tail;
        Ok(*head)
    }

    fn u64(&mut self) -> Result<u64, &'static str> {
        self.array().map(u64::from_le_bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film(adaptive: bool) -> Film {
        let aovs = [Aov::Depth, Aov::Visibility("Key light".into())];
        let mut film = Film::new(UVec2::new(5, 3), FilmLayout::new(&aovs), Fingerprint { scene: 7, settings: 8 }, adaptive);
        for (y, row) in film.rows().iter_mut().enumerate() {
            (0..5).for_each(|x| (0..3).for_each(|i| assert!(row.add(x, i, &[0.1, 0.2 * x as f32, y as f32, 3.0, 0.5, 1.0]))));
            *row.level = 3;
        }
        (film.rays, film.seconds, film.invalid) = (1 << 40, 1.25, 2);
        if let Some(plan) = &mut film.plan {
            (plan.level, plan.milestone, plan.base[3], plan.density[4], plan.pilots[5].mean) = (2, 64, 1, 0.5, 0.25);
        }
        film
    }

    #[test]
    fn a_film_survives_the_file() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("film.kajo");
        for adaptive in [false, true] {
            film(adaptive).save(&path).unwrap();
            assert_eq!(Film::load(&path).unwrap(), film(adaptive));
        }
    }

    #[test]
    fn damaged_truncated_and_foreign_files_are_refused() {
        let good = film(true).encode();
        assert!(Film::decode(&good).is_ok());
        for at in [9, 17, 40, 100, good.len() / 2, good.len() - 1] {
            let mut bad = good.clone();
            bad[at] ^= 1;
            assert!(Film::decode(&bad).is_err(), "byte {at}");
            assert!(Film::decode(&good[..at]).is_err(), "cut at {at}");
        }
        assert_eq!(Film::decode(b"GIF89a").unwrap_err(), "it is not a checkpoint of Kajo");
        let missing = Film::load(Path::new("/no-such-directory/film")).unwrap_err().to_string();
        assert!(missing.contains("/no-such-directory/film"), "{missing}");
    }
}
