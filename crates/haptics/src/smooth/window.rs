//! The voxels around the proxy as bits, seen from its side.
//!
//! A window holds 8×8×8 *cells* of 1, 2 or 4 voxels along each axis. Of its free voxels only
//! those count that the proxy reaches face to face inside the window; all others, such as the
//! far side of a thin wall or a pore inside a body, are filled. So a wall of one voxel is as
//! solid for the blur as a thick one, and what is behind it cannot be felt.
//!
//! Frame: grid. Memory: layers of rows along x, packed in words; a word holds whole rows.

use glam::IVec3;
use palpate_volume::occupancy::Occupancy;

/// Cells along each axis of a window.
pub(crate) const CELLS: i32 = 8;
/// Words of the largest window: 4×4×4 voxels a cell.
const MAX_WORDS: usize = 512;
/// Most passes of the flood, up and down each; ways that wind more are cut short, and what
/// lies beyond counts as filled.
const MAX_PASSES: usize = 12;

/// Which cells a window has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CellShape {
    /// Voxels along each axis of a cell: the power of two, 0, 1 or 2.
    pub(crate) log: [u32; 3],
}

impl CellShape {
    /// Voxels along each axis of a cell.
    pub(crate) fn voxels(self) -> IVec3 {
        IVec3::from_array(self.log.map(|log| 1 << log))
    }

    /// Solid voxels of a full cell.
    pub(crate) fn volume(self) -> i32 {
        1 << self.log.iter().sum::<u32>()
    }

    /// Voxels along x, a power of two.
    fn log_width(self) -> u32 {
        3 + self.log[0]
    }

    /// Words of a layer.
    fn layer(self) -> usize {
        1 << (self.log_width() + 3 + self.log[1] - 6)
    }

    /// Layers.
    fn layers(self) -> usize {
        8 << self.log[2]
    }
}

/// Solid voxels per cell: one word for each z and y, one byte for each x.
pub(crate) type CellCounts = [[u64; 8]; 8];

/// Counts the solid voxels of each cell from voxel `min` on, where all that `from` does not
/// reach through faces is solid. None where every voxel of the window is free.
pub(crate) fn cell_counts(
    occupancy: &(impl Occupancy + ?Sized),
    shape: CellShape,
    min: IVec3,
    from: IVec3,
) -> Option<CellCounts> {
    let mut free = [0_u64; MAX_WORDS];
    let words = shape.layer() * shape.layers();
    let free = free.get_mut(..words)?;
    if !read_free(occupancy, shape, min, free) {
        return None;
    }
    let mut reached = [0_u64; MAX_WORDS];
    let reached = reached.get_mut(..words)?;
    flood(shape, free, reached, from - min);
    Some(count(shape, reached))
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
                let block = occupancy.block(corner);
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

/// The free voxels that the voxel at `from`, counted from the corner, reaches through faces.
fn flood(shape: CellShape, free: &[u64], reached: &mut [u64], from: IVec3) {
    let rows = Rows::new(shape.log_width());
    let (layer, log_width) = (shape.layer(), shape.log_width());
    let last_row = 64 - (1_u32 << log_width);
    let row_words = layer;

    let bit = (from.y << log_width | from.x) as usize;
    let start = from.z as usize * layer + bit / 64;
    if let Some(word) = reached.get_mut(start) {
        *word = 1 << (bit % 64);
    }

    let words = free.len().min(reached.len());
    let feed = |reached: &[u64], i: usize, up: bool| {
        let at = |i: usize| reached.get(i).copied().unwrap_or(0);
        let in_layer = i % row_words;
        let mut seed = at(i);
        if up {
            if in_layer > 0 {
                seed |= at(i - 1) >> last_row;
            }
            if i >= layer {
                seed |= at(i - layer);
            }
        } else {
            if in_layer + 1 < row_words {
                seed |= at(i + 1) << last_row;
            }
            seed |= at(i + layer);
        }
        seed
    };
    for _ in 0..MAX_PASSES {
        let mut changed = 0;
        for i in 0..words {
            let before = reached[i];
            if before == free[i] {
                continue;
            }
            let grown = rows.grown(feed(reached, i, true), free[i]);
            changed |= grown ^ before;
            reached[i] = grown;
        }
        for i in (0..words).rev() {
            let before = reached[i];
            if before == free[i] {
                continue;
            }
            let grown = rows.grown(feed(reached, i, false), free[i]);
            changed |= grown ^ before;
            reached[i] = grown;
        }
        if changed == 0 {
            return;
        }
    }
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
