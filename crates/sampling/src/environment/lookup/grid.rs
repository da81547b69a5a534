//! A uniform grid over the image.

use crate::Steps;
use crate::environment::block::pixel;
use crate::environment::{Block, KdSampler};
use glam::{UVec2, Vec2};

/// Each cell lists the blocks that overlap it; a lookup tests only those.    \[Ergun15] chapter 6
///
/// Cells are chosen so that there are about as many as blocks: smaller ones cost memory, larger ones have long lists.
#[derive(Clone, Debug)]
pub struct GridHash {
    size: UVec2,
    cells: UVec2,
    /// For each cell the start of its list; one more for the end of the last.
    starts: Vec<u32>,
    /// Lists, block after block.
    lists: Vec<Entry>,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    block: Block,
    density: f32,
}

impl GridHash {
    /// The grid of a sampler.
    pub fn new(sampler: &KdSampler) -> Self {
        let size = sampler.size();
        // Cells as square as pixels allow.
        let side = (f64::from(size.element_product()) / sampler.blocks().len() as f64).sqrt().max(1.0);
        let cells = (size.as_dvec2() / side).ceil().as_uvec2().clamp(UVec2::ONE, size);
        let mut grid = Self { size, cells, starts: vec![0; cells.element_product() as usize + 1], lists: Vec::new() };
        for &block in sampler.blocks() {
            grid.cells_of(block).for_each(|cell| grid.starts[cell + 1] += 1);
        }
        (1..grid.starts.len()).for_each(|cell| grid.starts[cell] += grid.starts[cell - 1]);
        let empty = Entry { block: Block { x0: 0, y0: 0, x1: 0, y1: 0 }, density: 0.0 };
        grid.lists = vec![empty; grid.starts[grid.starts.len() - 1] as usize];
        let mut next = grid.starts.clone();
        for (index, &block) in sampler.blocks().iter().enumerate() {
            for cell in grid.cells_of(block) {
                grid.lists[next[cell] as usize] = Entry { block, density: sampler.density(index) };
                next[cell] += 1;
            }
        }
        grid
    }

    /// The cells that a block overlaps.
    fn cells_of(&self, block: Block) -> impl Iterator<Item = usize> + use<> {
        let width = self.cells.x as usize;
        let first = self.cell(UVec2::new(block.x0.into(), block.y0.into()));
        let last = self.cell(UVec2::new(block.x1.into(), block.y1.into()) - 1);
        (first.y..=last.y).flat_map(move |y| (first.x..=last.x).map(move |x| y as usize * width + x as usize))
    }

    #[inline]
    fn cell(&self, pixel: UVec2) -> UVec2 {
        // Sides are 16-bit numbers, so the products stay below 2³².
        pixel * self.cells / self.size
    }

    /// Density per unit area at a point of [0, 1)².
    #[inline]
    pub fn density(&self, uv: Vec2) -> f32 {
        self.density_counted(uv, &mut ())
    }

    /// [`Self::density`], counting the blocks that are tested.
    #[inline]
    pub fn density_counted(&self, uv: Vec2, steps: &mut impl Steps) -> f32 {
        let pixel = pixel(uv, self.size);
        let cell = self.cell(pixel);
        let cell = cell.y as usize * self.cells.x as usize + cell.x as usize;
        let list = &self.lists[self.starts[cell] as usize..self.starts[cell + 1] as usize];
        let found = list.iter().find(|entry| {
            steps.step();
            entry.block.contains(pixel)
        });
        found.map_or(0.0, |entry| entry.density)
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.starts.as_slice()) + size_of_val(self.lists.as_slice())
    }
}
