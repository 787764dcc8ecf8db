//! The voxels around the proxy as bits, seen from its side.
//!
//! A window holds 8×8×8 *cells* of 1, 2 or 4 voxels along each axis. Of its free voxels only
//! those count that the proxy reaches face to face inside the window; all others, such as the
//! far side of a thin wall or a pore inside a body, are filled. So a wall of one voxel is as
//! solid for the blur as a thick one, and what is behind it cannot be felt.
//!
//! Frame: grid. Memory: layers of rows along x, packed in words; a word holds whole rows.

use glam::{DVec3, IVec3};
use palpate_volume::occupancy::Occupancy;
use std::f64::consts::SQRT_2;

/// Cells along each axis of a window.
pub(crate) const CELLS: i32 = 8;
/// Words of the largest window, of cells of 4×4×1 voxels.
const MAX_WORDS: usize = 128;
/// Most passes of the flood, up and down each; ways that wind more are cut short, and what
/// lies beyond counts as filled.
const MAX_PASSES: usize = 12;

/// How many voxels a cell has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CellShape {
    /// Along each axis, as a power of two: 0, 1 or 2.
    log: [u32; 3],
}

impl CellShape {
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
    pub(crate) fn volume(self) -> i32 {
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

/// Solid voxels per cell: one word for each z and y, one byte for each x.
pub(crate) type CellCounts = [[u64; 8]; 8];

/// A voxel on either side of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SurfaceVoxel {
    /// In the grid.
    pub(crate) voxel: IVec3,
    /// Its cell in the window: x, y, z.
    pub(crate) cell: [usize; 3],
    /// On which side it is.
    pub(crate) solid: bool,
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
    reached: [u64; MAX_WORDS],
}

impl Window {
    /// No window.
    pub(crate) const NONE: Self = Self {
        shape: CellShape { log: [0; 3] },
        first: IVec3::ZERO,
        seed: None,
        complete: false,
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

    /// Reads the window from cell `first` on and counts the solid voxels of its cells, where
    /// all that `seed` does not reach through faces is solid; tells the voxels on both sides of
    /// the surface to `at_surface`. None where every voxel of the window is free, and where the
    /// seed itself is solid.
    pub(crate) fn read(
        &mut self,
        occupancy: &(impl Occupancy + ?Sized),
        shape: CellShape,
        first: IVec3,
        seed: IVec3,
        mut at_surface: Option<impl FnMut(SurfaceVoxel)>,
    ) -> Option<CellCounts> {
        (self.shape, self.first, self.seed) = (shape, first, Some(seed));
        let mut free = [0_u64; MAX_WORDS];
        let min = first * shape.voxels();
        let any_solid = read_free(occupancy, shape, min, &mut free);
        if !any_solid {
            self.reached = free;
            self.complete = true;
            return None;
        }
        self.reached = [0; MAX_WORDS];
        let (word, bit) = self.place_of(seed)?;
        if free[word] & bit == 0 {
            self.complete = false;
            return None;
        }
        self.reached[word] = bit;
        let words = shape.words();
        self.complete = flood(shape, &free[..words], &mut self.reached[..words]);
        if let Some(at_surface) = &mut at_surface {
            self.visit_surface(&free[..words], at_surface);
        }
        Some(count(shape, &self.reached[..words]))
    }

    /// Tells the voxels that are reached next to solid ones, and solid ones next to those that
    /// are reached; of the cells inside the window, since the others hardly count.
    fn visit_surface(&self, free: &[u64], tell: &mut impl FnMut(SurfaceVoxel)) {
        let shape = self.shape;
        let rows = Rows::new(shape.log_width());
        let layer = shape.layer();
        let min = self.first * shape.voxels();
        let words = free.len();
        let reached = |i: usize| self.reached[i];
        for (i, &free) in free.iter().enumerate() {
            let in_layer = i & (layer - 1);
            let here = reached(i);
            let [solid, open] = [!here, here];
            // what is next to a voxel of the other kind; beyond the window nothing is
            let beside = |kind: fn(u64) -> u64| {
                let word = kind(here);
                let mut near = rows.spread(word);
                if in_layer > 0 {
                    near |= rows.last_to_first(kind(reached(i - 1)));
                }
                if in_layer + 1 < layer {
                    near |= rows.first_to_last(kind(reached(i + 1)));
                }
                if i >= layer {
                    near |= kind(reached(i - layer));
                }
                if i + layer < words {
                    near |= kind(reached(i + layer));
                }
                near
            };
            let mut left = open & beside(|word| !word) | solid & !free & beside(|word| word);
            while left != 0 {
                let bit = left.trailing_zeros();
                left &= left - 1;
                let in_rows = in_layer as i32 * 64 + bit as i32;
                let width = 1 << shape.log_width();
                let offset = IVec3::new(
                    in_rows & (width - 1),
                    in_rows >> shape.log_width(),
                    (i / layer) as i32,
                );
                let cell = shape.cell_of_half(2 * offset);
                let inside = cell.cmpge(IVec3::ONE).all() && cell.cmplt(IVec3::splat(7)).all();
                if inside {
                    tell(SurfaceVoxel {
                        voxel: min + offset,
                        cell: cell.to_array().map(|cell| cell as usize),
                        solid: solid >> bit & 1 == 1,
                    });
                }
            }
        }
    }

    fn is_reached(&self, voxel: IVec3) -> bool {
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

/// How bits spread inside a word of rows.
struct Rows {
    log_width: u32,
    not_first: u64,
    not_last: u64,
}

impl Rows {
    fn new(log_width: u32) -> Self {
        let first = match log_width {
            3 => 0x0101_0101_0101_0101,
            4 => 0x0001_0001_0001_0001,
            _ => 0x0000_0001_0000_0001_u64,
        };
        let width = 1 << log_width;
        Self {
            log_width,
            not_first: !first,
            not_last: !(first << (width - 1)),
        }
    }

    /// The neighbours of voxels in a word, along the rows and from row to row.
    fn spread(&self, word: u64) -> u64 {
        let row = 1_u32 << self.log_width;
        let along = (word & self.not_last) << 1 | (word & self.not_first) >> 1;
        along | word << row | word >> row
    }

    /// The last row of a word in the place of the first.
    fn last_to_first(&self, word: u64) -> u64 {
        word >> (64 - (1_u32 << self.log_width))
    }

    /// The first row of a word in the place of the last.
    fn first_to_last(&self, word: u64) -> u64 {
        word << (64 - (1_u32 << self.log_width))
    }

    /// All of `free` that `seed` reaches along the rows and from row to row of a word.
    fn grown(&self, seed: u64, free: u64) -> u64 {
        let seed = seed & free;
        if seed == 0 || seed == free {
            return seed;
        }
        // along the rows, in steps that double
        let (mut up, mut down) = (seed, seed);
        let (mut pass_up, mut pass_down) = (free & self.not_first, free & self.not_last);
        for log in 0..self.log_width {
            let step = 1 << log;
            up |= pass_up & (up << step);
            down |= pass_down & (down >> step);
            pass_up &= pass_up << step;
            pass_down &= pass_down >> step;
        }
        let seed = up | down;

        // from row to row
        let (mut up, mut down) = (seed, seed);
        let (mut pass_up, mut pass_down) = (free, free);
        for log in self.log_width..6 {
            let step = 1 << log;
            up |= pass_up & (up << step);
            down |= pass_down & (down >> step);
            pass_up &= pass_up << step;
            pass_down &= pass_down >> step;
        }
        up | down
    }
}

/// Grows what is reached to all free voxels that are connected to it through faces; false
/// where there was no end to it.
fn flood(shape: CellShape, free: &[u64], reached: &mut [u64]) -> bool {
    let rows = Rows::new(shape.log_width());
    let layer = shape.layer();
    let words = free.len().min(reached.len());
    for _ in 0..MAX_PASSES {
        let mut changed = 0;
        // up, each word fed by the rows and layers before it
        for i in 0..words {
            let in_layer = i & (layer - 1);
            let row = if in_layer > 0 { reached[i - 1] } else { 0 };
            let below = if i >= layer { reached[i - layer] } else { 0 };
            let seed = reached[i] | rows.last_to_first(row) | below;
            let grown = rows.grown(seed, free[i]);
            changed |= grown ^ reached[i];
            reached[i] = grown;
        }
        // and down again
        for i in (0..words).rev() {
            let in_layer = i & (layer - 1);
            let row = if in_layer + 1 < layer {
                reached[i + 1]
            } else {
                0
            };
            let above = if i + layer < words {
                reached[i + layer]
            } else {
                0
            };
            let seed = reached[i] | rows.first_to_last(row) | above;
            let grown = rows.grown(seed, free[i]);
            changed |= grown ^ reached[i];
            reached[i] = grown;
        }
        if changed == 0 {
            return true;
        }
    }
    false
}

/// Set bits of a byte in groups of 1, 2 or 4, each sum in a byte of its own.
static GROUPS: [[u64; 256]; 3] = groups();

const fn groups() -> [[u64; 256]; 3] {
    let mut table = [[0; 256]; 3];
    let mut log = 0;
    while log < 3 {
        let mut byte = 0;
        while byte < 256 {
            let mut bit = 0;
            while bit < 8 {
                table[log][byte] += (byte as u64 >> bit & 1) << (8 * (bit >> log));
                bit += 1;
            }
            byte += 1;
        }
        log += 1;
    }
    table
}

/// Voxels of each cell that are not reached.
fn count(shape: CellShape, reached: &[u64]) -> CellCounts {
    let mut counts = [[0_u64; 8]; 8];
    let [log_x, log_y, log_z] = shape.log;
    let groups = &GROUPS[log_x as usize];
    let (layer, rows_per_word) = (shape.layer(), 8 >> log_x);
    let lanes = 64 >> log_x;
    for z in 0..shape.layers() {
        for word in 0..layer {
            let mut solid = !reached[z * layer + word];
            for row in 0..rows_per_word {
                let y = word * rows_per_word + row;
                let mut cells = 0;
                for byte in 0..1 << log_x {
                    let group = groups[(solid & 0xff) as usize];
                    cells |= group << ((byte * lanes) & 63);
                    solid >>= 8;
                }
                counts[(z >> log_z) & 7][(y >> log_y) & 7] += cells;
            }
        }
    }
    counts
}
