//! The voxels around the proxy as bits, seen from its side.
//!
//! A window holds 8×8×8 *cells* of 1, 2 or 4 voxels along each axis. Of its free voxels only
//! those count that the proxy reaches face to face inside the window; all others, such as the
//! far side of a thin wall or a pore inside a body, are filled. So a wall of one voxel is as
//! solid for the blur as a thick one, and what is behind it cannot be felt.
//!
//! Frame: grid. Memory: layers of rows along x, packed in words (`rows.rs`).

use super::rows::Rows;
use glam::{DVec3, IVec3};
use palpate_volume::occupancy::Occupancy;
use std::f64::consts::SQRT_2;

/// Cells along each axis of a window.
pub(crate) const CELLS: i32 = 8;
/// Words of the largest window, of cells of 4×4×1 voxels.
const MAX_WORDS: usize = 128;
/// Words of its largest layer of cells.
const MAX_CELL_LAYER: usize = MAX_WORDS / CELLS as usize;

/// How many voxels a cell has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CellShape {
    /// Along each axis, as a power of two: 0, 1 or 2.
    log: [u32; 3],
}

impl CellShape {
    /// One voxel.
    pub(crate) const ONE: Self = Self { log: [0; 3] };

    /// Cells as near to cubes as powers of two get them: two voxels along the finest axis, or
    /// as long as a voxel of the coarsest where that is more. So none has more than 16 voxels.
    pub(crate) fn for_spacing(spacing: DVec3) -> Self {
        let length = spacing.max_element().max(2.0 * spacing.min_element());
        // the power of two next to a ratio, without a logarithm
        let log = |spacing: f64| {
            let ratio = length / spacing;
            u32::from(ratio >= SQRT_2) + u32::from(ratio >= 2.0 * SQRT_2)
        };
        Self {
            log: spacing.to_array().map(log),
        }
    }

    /// Voxels along each axis of a cell.
    pub(crate) fn voxels(self) -> IVec3 {
        IVec3::from_array(self.log.map(|log| 1 << log))
    }

    /// The cell, by its number, that holds a place in half voxels.
    pub(crate) fn cell_of_half(self, halves: IVec3) -> IVec3 {
        let [x, y, z] = self.log;
        IVec3::new(
            halves.x >> (x + 1),
            halves.y >> (y + 1),
            halves.z >> (z + 1),
        )
    }

    /// Voxels of a cell.
    pub(crate) fn volume(self) -> u16 {
        1 << self.log.iter().sum::<u32>()
    }

    /// Voxels along x of a window, as a power of two.
    fn log_width(self) -> u32 {
        3 + self.log[0]
    }

    /// Words of a layer.
    fn layer(self) -> usize {
        1 << (self.log[0] + self.log[1])
    }

    /// Layers.
    fn layers(self) -> usize {
        8 << self.log[2]
    }

    /// Words of a window.
    fn words(self) -> usize {
        (self.layer() * self.layers()).min(MAX_WORDS)
    }
}

/// The voxels of eight cells along x on either side of the surface: 16 bits for each cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct SurfaceRow {
    /// Voxels that are reached, next to those that are not.
    pub(crate) free: u128,
    /// Solid ones next to those that are reached.
    pub(crate) solid: u128,
}

impl SurfaceRow {
    /// Those of the cell whose bits begin at a place.
    #[inline]
    pub(crate) fn cell_at(&self, place: u32) -> SurfaceCell {
        let bits = |cells: u128| u32::from((cells >> place) as u16);
        SurfaceCell(bits(self.free) | bits(self.solid) << 16)
    }
}

/// The voxels of a cell on either side of the surface, one bit each, x fastest: first those that
/// are reached, next to those that are not; 16 bits on, solid ones next to those that are reached.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct SurfaceCell(u32);

impl SurfaceCell {
    /// No voxel.
    pub(crate) const NONE: Self = Self(0);

    /// Tells the voxels of this cell and whether they are solid, z by z and row by row.
    #[inline]
    pub(crate) fn voxels(
        self,
        shape: CellShape,
        number: IVec3,
    ) -> impl Iterator<Item = (IVec3, bool)> {
        let min = number * shape.voxels();
        let [log_x, log_y, _] = shape.log;
        let [last_x, last_y] = [(1 << log_x) - 1, (1 << log_y) - 1];
        let mut left = (self.0 | self.0 >> 16) & 0xffff;
        std::iter::from_fn(move || {
            let bit = (left != 0).then(|| left.trailing_zeros() as i32)?;
            left &= left - 1;
            let (y, z) = (bit >> log_x & last_y, bit >> (log_x + log_y));
            let voxel = min + IVec3::new(bit & last_x, y, z);
            Some((voxel, self.0 >> (16 + bit) & 1 == 1))
        })
    }
}

/// Voxels at the surface, one bit each.
#[derive(Clone, Copy, Debug, Default)]
struct Surface {
    /// Reached ones next to others.
    free: u64,
    /// Solid ones next to those that are reached.
    solid: u64,
}

/// Voxels of eight cells along x, 16 bits for each cell.
#[derive(Clone, Copy, Debug, Default)]
struct RowOfCells([u64; 2]);

impl RowOfCells {
    /// Adds the first row of a word, as the voxels from a number on in each cell.
    #[inline]
    fn add<const LOG: u32>(&mut self, word: u64, first: u32) {
        let [low, high] = Rows::<LOG>::in_cells(word);
        self.0[0] |= low << first;
        self.0[1] |= high << first;
    }

    /// Those of the cells inside the window.
    #[inline]
    fn inside(self) -> u128 {
        let [low, high] = self.0;
        u128::from(low >> 16 << 16) | u128::from(high << 16 >> 16) << 64
    }
}

/// Which voxels of a window are reached from the proxy's.
#[derive(Clone, Debug)]
pub(crate) struct Window {
    shape: CellShape,
    /// The first cell, by its number.
    first: IVec3,
    /// Where the flood began; none where there is no window.
    seed: Option<IVec3>,
    /// Whether it came to its end, so that each voxel reached would have led to the same.
    complete: bool,
    free: [u64; MAX_WORDS],
    reached: [u64; MAX_WORDS],
}

impl Window {
    /// No window.
    pub(crate) const NONE: Self = Self {
        shape: CellShape::ONE,
        first: IVec3::ZERO,
        seed: None,
        complete: false,
        free: [0; MAX_WORDS],
        reached: [0; MAX_WORDS],
    };

    /// The first cell, by its number.
    pub(crate) fn first(&self) -> IVec3 {
        self.first
    }

    /// Whether reading this window again would give the same.
    pub(crate) fn is_for(&self, shape: CellShape, first: IVec3, seed: IVec3) -> bool {
        let Some(old_seed) = self.seed else {
            return false;
        };
        let same_place = self.shape == shape && self.first == first;
        same_place && (old_seed == seed || self.complete && self.is_reached(seed))
    }

    /// Reads the window from cell `first` on, where all that `seed` does not reach through
    /// faces is solid; false where every voxel of the window is free, and where the seed itself
    /// is solid.
    pub(crate) fn read(
        &mut self,
        occupancy: &(impl Occupancy + ?Sized),
        shape: CellShape,
        first: IVec3,
        seed: IVec3,
    ) -> bool {
        (self.shape, self.first, self.seed) = (shape, first, Some(seed));
        let words = shape.words();
        let (free, reached) = (&mut self.free[..words], &mut self.reached[..words]);
        free.fill(0);
        let any_solid = read_free(occupancy, shape, first * shape.voxels(), free);
        if !any_solid {
            reached.copy_from_slice(free);
            self.complete = true;
            return false;
        }
        reached.fill(0);
        self.complete = false;
        let Some((word, bit)) = self.place_of(seed) else {
            return false;
        };
        if self.free[word] & bit == 0 {
            return false;
        }
        self.reached[word] = bit;
        self.complete = self.flood(word / shape.layer());
        true
    }

    fn flood(&mut self, layer: usize) -> bool {
        let words = self.shape.words();
        let (free, reached) = (&self.free[..words], &mut self.reached[..words]);
        let flood = match self.shape.log_width() {
            3 => Rows::<3>::flood,
            4 => Rows::<4>::flood,
            _ => Rows::<5>::flood,
        };
        flood(self.shape.layer(), layer, free, reached)
    }

    /// Voxels that are not reached in each cell: a word for each row of cells, a byte for each.
    pub(crate) fn counts(&self) -> [u64; 64] {
        match self.shape.log_width() {
            3 => self.count::<3>(),
            4 => self.count::<4>(),
            _ => self.count::<5>(),
        }
    }

    fn count<const LOG: u32>(&self) -> [u64; 64] {
        let mut counts = [0_u64; 64];
        let [_, log_y, log_z] = self.shape.log;
        let layer = self.shape.layer();
        let log_rows = 6 - LOG;
        for (i, &reached) in self.reached[..self.shape.words()].iter().enumerate() {
            // nothing solid
            if reached == u64::MAX {
                continue;
            }
            let (y, z) = ((i & (layer - 1)) << log_rows, i / layer);
            let cells = 8 * (z >> log_z);
            for row in 0..1 << log_rows {
                let cells = cells + ((y + row) >> log_y);
                counts[cells & 63] += Rows::<LOG>::clear_in_row(reached >> (row << LOG));
            }
        }
        counts
    }

    /// Tells rows of cells, y and z in the window, with voxels that are reached next to others,
    /// or solid ones next to those that are reached. Only what is inside the window is told and
    /// right, without its outermost cells: those hardly count.
    pub(crate) fn visit_surface(&self, tell: &mut impl FnMut(usize, usize, SurfaceRow)) {
        match self.shape.log_width() {
            3 => self.visit_surface_of::<3>(tell),
            4 => self.visit_surface_of::<4>(tell),
            _ => self.visit_surface_of::<5>(tell),
        }
    }

    #[inline]
    fn visit_surface_of<const LOG: u32>(&self, tell: &mut impl FnMut(usize, usize, SurfaceRow)) {
        let [log_x, log_y, log_z] = self.shape.log;
        let (log_rows, layer) = (6 - LOG, self.shape.layer());
        let mut words = [Surface::default(); MAX_CELL_LAYER];
        for z in 1..7 {
            let first = (z << log_z) * layer;
            for (place, word) in words.iter_mut().enumerate().take(layer << log_z) {
                *word = self.surface_of::<LOG>(first + place);
            }
            for y in 1..7 {
                let [mut near_free, mut near_solid] = [RowOfCells::default(); 2];
                let mut any = false;
                for in_cell in 0..1 << (log_y + log_z) {
                    let row = (y << log_y) + (in_cell & ((1 << log_y) - 1));
                    let word = (in_cell >> log_y) * layer + (row >> log_rows);
                    let Surface { free, solid } = words[word & (MAX_CELL_LAYER - 1)];
                    let place = (row & ((1 << log_rows) - 1)) << LOG;
                    if (free | solid) >> place & ((1 << (1 << LOG)) - 1) == 0 {
                        continue;
                    }
                    any = true;
                    let voxels = (in_cell as u32) << log_x;
                    near_free.add::<LOG>(free >> place, voxels);
                    near_solid.add::<LOG>(solid >> place, voxels);
                }
                if any {
                    let (free, solid) = (near_free.inside(), near_solid.inside());
                    tell(y, z, SurfaceRow { free, solid });
                }
            }
        }
    }

    /// Voxels of a word at the surface; only those of cells inside the window are right, for
    /// beyond its border are others.
    #[inline]
    fn surface_of<const LOG: u32>(&self, word: usize) -> Surface {
        let at = |word: usize| self.reached[word & (MAX_WORDS - 1)];
        let (here, layer, row) = (at(word), self.shape.layer(), 1 << LOG);
        let beside = [
            here << 1,
            here >> 1,
            here << row | at(word.wrapping_sub(1)) >> (64 - row),
            here >> row | at(word + 1) << (64 - row),
            at(word.wrapping_sub(layer)),
            at(word + layer),
        ];
        let all = beside.iter().fold(u64::MAX, |all, beside| all & beside);
        let any = beside.iter().fold(0, |any, beside| any | beside);
        Surface {
            free: here & !all,
            solid: !here & !self.free[word & (MAX_WORDS - 1)] & any,
        }
    }

    /// Whether a voxel is reached; none outside is.
    pub(super) fn is_reached(&self, voxel: IVec3) -> bool {
        self.place_of(voxel)
            .is_some_and(|(word, bit)| self.reached[word] & bit != 0)
    }

    /// Word and bit of a voxel of the grid; none outside.
    fn place_of(&self, voxel: IVec3) -> Option<(usize, u64)> {
        let size = CELLS * self.shape.voxels();
        let offset = voxel - self.first * self.shape.voxels();
        let inside = offset.cmpge(IVec3::ZERO).all() && offset.cmplt(size).all();
        let bit = (offset.y << self.shape.log_width() | offset.x) as usize;
        let word = offset.z as usize * self.shape.layer() + bit / 64;
        (inside && word < MAX_WORDS).then_some((word, 1 << (bit % 64)))
    }
}

/// Reads the free voxels; false where all are.
fn read_free(
    occupancy: &(impl Occupancy + ?Sized),
    shape: CellShape,
    min: IVec3,
    free: &mut [u64],
) -> bool {
    let [mx, my, mz] = shape.voxels().to_array();
    let mut any_solid = 0;
    for block_z in 0..mz {
        for block_y in 0..my {
            for block_x in 0..mx {
                let corner = min + 8 * IVec3::new(block_x, block_y, block_z);
                let block = occupancy.smooth_block(corner);
                for (z, word) in block.0.into_iter().enumerate() {
                    any_solid |= word;
                    let layer = (8 * block_z as usize + z) * shape.layer();
                    let first = layer + block_y as usize * mx as usize;
                    spread_rows(!word, mx, block_x, free.get_mut(first..));
                }
            }
        }
    }
    any_solid != 0
}

/// Puts the eight rows of a block's layer in their places, `width` bytes apart.
fn spread_rows(rows: u64, width: i32, place: i32, words: Option<&mut [u64]>) {
    let Some(words) = words else { return };
    let put = |word: Option<&mut u64>, rows: u64| {
        if let Some(word) = word {
            *word |= rows << (8 * place);
        }
    };
    match width {
        1 => put(words.get_mut(0), rows),
        2 => {
            for half in 0..2 {
                let rows = rows >> (32 * half) & 0xffff_ffff;
                let rows = (rows | rows << 16) & 0x0000_ffff_0000_ffff;
                let rows = (rows | rows << 8) & 0x00ff_00ff_00ff_00ff;
                put(words.get_mut(half), rows);
            }
        }
        _ => {
            for pair in 0..4 {
                let rows = rows >> (16 * pair);
                put(words.get_mut(pair), rows & 0xff | (rows & 0xff00) << 24);
            }
        }
    }
}
