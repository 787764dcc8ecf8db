//! The voxels around a patch as rows of 64 bits.
//!
//! A sample is a block of step³ voxels, solid where at least half of it is; with a step of 1 it
//! is the voxel. Sample s stands at (s + 0.5) · step of the grid frame; beyond the grid all are
//! free, so that a segment is closed where it touches the border.
//! Memory: one word per row along x, rows by y, then z; bit 0 is sample `origin.x`.

use glam::{IVec3, UVec3};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BRICK;
use palpate_volume::voxel_box::VoxelBox;

/// Samples before a patch in its rows: room for the largest margin, and whole bricks.
const BEFORE: i32 = 16;

/// Rows of samples.
#[derive(Clone, Debug, Default)]
pub(crate) struct Samples {
    /// Sample of bit 0 of the first row.
    origin: IVec3,
    /// Rows along y and z.
    rows: [i32; 2],
    words: Vec<u64>,
}

impl Samples {
    /// Reads the samples of a box, none wider than a row along x; `first` is the patch's own
    /// first sample along x without the border.
    pub(crate) fn load(&mut self, bits: &Bits, step: i32, wanted: VoxelBox, first: i32) {
        let size = wanted.size();
        self.origin = IVec3::new(first - BEFORE, wanted.min.y, wanted.min.z);
        self.rows = [size.y as i32, size.z as i32];
        self.words.clear();
        self.words.resize(size.y as usize * size.z as usize, 0);

        let per_brick = BRICK / step;
        let rows = VoxelBox::new(
            self.origin,
            IVec3::new(self.origin.x + 64, wanted.max.y, wanted.max.z),
        );
        for brick in bricks_of(bits, step, rows).voxels() {
            let Some(stored) = bits.bricks().at(brick * BRICK) else {
                continue;
            };
            if step == 1 {
                self.put(stored, brick * per_brick, per_brick);
            } else {
                self.put(&coarse(stored, step), brick * per_brick, per_brick);
            }
        }
    }

    /// Writes the corner of `count`³ samples of a brick to where it belongs.
    fn put(&mut self, brick: &BitBrick, corner: IVec3, count: i32) {
        let place = corner - self.origin;
        let mask = (1u64 << count) - 1;
        let [ny, nz] = self.rows;
        for z in (-place.z).max(0)..count.min(nz - place.z) {
            let word = brick.0[z as usize];
            let row = (place.z + z) * ny + place.y;
            for y in (-place.y).max(0)..count.min(ny - place.y) {
                self.words[(row + y) as usize] |= (word >> (8 * y) & mask) << place.x;
            }
        }
    }

    /// Sample of bit 0 of the first row.
    pub(crate) fn origin(&self) -> IVec3 {
        self.origin
    }

    /// The row through a sample; rows that were not read must not be asked for.
    #[inline]
    pub(crate) fn row(&self, y: i32, z: i32) -> u64 {
        let place = (z - self.origin.z) * self.rows[0] + (y - self.origin.y);
        self.words[place as usize]
    }

    /// Whether a sample is solid; it must have been read.
    #[inline]
    pub(crate) fn is_solid(&self, sample: IVec3) -> bool {
        self.row(sample.y, sample.z) >> (sample.x - self.origin.x) & 1 != 0
    }

    /// 0.5 for each solid sample of a row from `first` on, -0.5 for each free one.
    pub(crate) fn halves(&self, first: IVec3, values: &mut [f32]) {
        let word = self.row(first.y, first.z) >> (first.x - self.origin.x);
        for (bit, value) in values.iter_mut().enumerate() {
            *value = (word >> bit & 1) as f32 - 0.5;
        }
    }

    /// The smallest box of samples that holds every crossed edge between those of `own`.
    pub(crate) fn crossed(&self, own: VoxelBox) -> Option<VoxelBox> {
        let shift = own.min.x - self.origin.x;
        let wanted = u64::MAX >> (64 - own.size().x);
        let row = |y: i32, z: i32| self.row(y, z) >> shift & wanted;
        let mut all = VoxelBox::EMPTY;
        for z in own.min.z..own.max.z {
            for y in own.min.y..own.max.y {
                let here = row(y, z);
                let next_y = row((y + 1).min(own.max.y - 1), z);
                let next_z = row(y, (z + 1).min(own.max.z - 1));
                let along = (here ^ here >> 1) & wanted >> 1;
                let crossed = along | along << 1 | here ^ next_y | here ^ next_z;
                if crossed != 0 {
                    let [first, last] = [crossed.trailing_zeros(), 63 - crossed.leading_zeros()]
                        .map(|bit| own.min.x + bit as i32);
                    let corner = IVec3::new(last, y + 1, z + 1).min(own.max - 1);
                    let ends = VoxelBox::new(IVec3::new(first, y, z), corner + 1);
                    all = all.union(&ends);
                }
            }
        }
        (!all.is_empty()).then_some(all)
    }

    /// How many edges between the samples of `own` are crossed: each holds a vertex.
    pub(crate) fn crossings(&self, own: VoxelBox) -> u32 {
        let shift = own.min.x - self.origin.x;
        let wanted = u64::MAX >> (64 - own.size().x);
        let row = |y: i32, z: i32| self.row(y, z) >> shift & wanted;
        let mut count = 0;
        for z in own.min.z..own.max.z {
            for y in own.min.y..own.max.y {
                let here = row(y, z);
                count += ((here ^ here >> 1) & wanted >> 1).count_ones();
                if y + 1 < own.max.y {
                    count += (here ^ row(y + 1, z)).count_ones();
                }
                if z + 1 < own.max.z {
                    count += (here ^ row(y, z + 1)).count_ones();
                }
            }
        }
        count
    }

    /// Shows nothing but the samples of `own`: whatever lies beyond looks like its border.
    pub(crate) fn isolate(&mut self, own: VoxelBox) {
        let (low, high) = (own.min.x - self.origin.x, own.max.x - 1 - self.origin.x);
        let spread = |word: u64| {
            let below = (1u64 << low) - 1;
            let above = !(u64::MAX >> (63 - high));
            let fill = |bit: i32, mask: u64| if word >> bit & 1 != 0 { mask } else { 0 };
            word & !below & !above | fill(low, below) | fill(high, above)
        };
        let [ny, nz] = self.rows;
        let old = self.words.clone();
        for z in 0..nz {
            for y in 0..ny {
                let near = IVec3::new(0, y, z) + self.origin;
                let near = near.clamp(own.min, own.max - 1) - self.origin;
                self.words[(z * ny + y) as usize] = spread(old[(near.z * ny + near.y) as usize]);
            }
        }
    }
}

/// Samples of a grid along each axis.
pub(crate) fn sample_count(dimensions: UVec3, step: i32) -> IVec3 {
    (dimensions.as_ivec3() + (step - 1)) / step
}

/// Whether every sample of a box is free, or every one solid, by a look at the bricks alone.
pub(crate) fn is_uniform(bits: &Bits, step: i32, samples: VoxelBox) -> bool {
    let inside = VoxelBox::new(IVec3::ZERO, sample_count(bits.dimensions(), step));
    let bricks = bricks_of(bits, step, samples);
    if inside.contains_box(&samples) && all_full(bits, bricks) {
        return true;
    }
    bricks
        .voxels()
        .all(|brick| bits.bricks().at(brick * BRICK).is_none())
}

fn all_full(bits: &Bits, bricks: VoxelBox) -> bool {
    bricks
        .voxels()
        .all(|brick| bits.bricks().at(brick * BRICK) == Some(&BitBrick::FULL))
}

/// The bricks of the grid that hold the samples of a box.
fn bricks_of(bits: &Bits, step: i32, samples: VoxelBox) -> VoxelBox {
    let per_brick = BRICK / step;
    let low = samples.min.div_euclid(IVec3::splat(per_brick));
    let high = (samples.max - 1).div_euclid(IVec3::splat(per_brick)) + 1;
    VoxelBox::new(low, high).intersect(&VoxelBox::of_dimensions(bits.bricks().size()))
}

/// A brick of blocks of step³ voxels, in the corner of the brick returned.
fn coarse(brick: &BitBrick, step: i32) -> BitBrick {
    let (step, count) = (step as usize, (BRICK / step) as usize);
    // a block of step columns and rows, in one plane
    let square = (0..step).fold(0u64, |all, row| all | ((1 << step) - 1) << (8 * row));
    let mut blocks = BitBrick::EMPTY;
    for z in 0..count {
        for y in 0..count {
            for x in 0..count {
                let mask = square << (step * (8 * y + x));
                let planes = &brick.0[step * z..step * (z + 1)];
                let solid: u32 = planes.iter().map(|word| (word & mask).count_ones()).sum();
                let is_solid = 2 * solid as usize >= step.pow(3);
                blocks.0[z] |= u64::from(is_solid) << (8 * y + x);
            }
        }
    }
    blocks
}
