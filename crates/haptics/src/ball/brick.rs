//! One brick of 8×8×8 cells, dilated by a ball: the work that a cache spares.
//!
//! Rows along x are bytes, and a dilation is a union of rows: the row at (y, z) is the union,
//! over the rows of the shape, of the source row at (y + dy, z + dz) widened by the half-width
//! of that row. So all source rows are widened step by step, 16 or more in one operation, and
//! after each step the rows of the shape with just this half-width are taken in, eight rows
//! along y in one operation. Layers without a solid voxel are passed over.
//!
//! Frame: grid. Memory: as in `bit_brick.rs`; the source is the bricks around, BLOCKS along
//! each axis with the dilated one in the middle, kept as layers of rows per column of bricks.

use crate::ball::shape::BallShape;
use glam::IVec3;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::brick_grid::BRICK;
use palpate_volume::occupancy::Occupancy;

/// The cells of one brick, given by its first cell, a multiple of 8 along each axis.
pub(crate) fn dilated_brick(
    inner: &(impl Occupancy + ?Sized),
    shape: &BallShape,
    corner: IVec3,
) -> BitBrick {
    if shape.reach().max_element() <= BRICK {
        dilated::<3, 24>(inner, shape, corner)
    } else {
        dilated::<5, 40>(inner, shape, corner)
    }
}

/// Columns of bricks along x, each as layers along z of rows along y.
type Columns<const BLOCKS: usize, const ROWS: usize> = [[[u8; ROWS]; ROWS]; BLOCKS];

/// The same with BLOCKS bricks along each axis, which are ROWS = 8 · BLOCKS voxels.
fn dilated<const BLOCKS: usize, const ROWS: usize>(
    inner: &(impl Occupancy + ?Sized),
    shape: &BallShape,
    corner: IVec3,
) -> BitBrick {
    let mut source = [[[0; ROWS]; ROWS]; BLOCKS];
    if !read(inner, shape, corner, &mut source) {
        return BitBrick::EMPTY;
    }

    let mut rows = source[BLOCKS / 2];
    let mut brick = BitBrick::EMPTY;
    for width in 0..=shape.reach().x as usize {
        if width > 0 {
            widen(&mut rows, &source, shape, width);
        }
        take_in(&mut brick, &rows, shape, width);
        if brick == BitBrick::FULL {
            break;
        }
    }
    brick
}

/// Reads the bricks that the shape reaches; whether any voxel is solid.
fn read<const BLOCKS: usize, const ROWS: usize>(
    inner: &(impl Occupancy + ?Sized),
    shape: &BallShape,
    corner: IVec3,
    source: &mut Columns<BLOCKS, ROWS>,
) -> bool {
    let reach: IVec3 = (shape.reach() + (BRICK - 1)) >> 3_i32;
    let middle = (BLOCKS / 2) as i32;
    let reached = layers(ROWS, shape);
    let mut any = false;
    for z in -reach.z..=reach.z {
        for y in -reach.y..=reach.y {
            for x in -reach.x..=reach.x {
                let block = inner.block(corner + IVec3::new(x, y, z) * BRICK);
                if block == BitBrick::EMPTY {
                    continue;
                }
                let first_layer = 8 * (middle + z) as usize;
                let first_row = 8 * (middle + y) as usize;
                let column = &mut source[(middle + x) as usize];
                // no other layers are looked at
                let from = reached.start.max(first_layer);
                let to = reached.end.min(first_layer + 8).max(from);
                for (layer, rows) in (from..).zip(&mut column[from..to]) {
                    let word = block.0[(layer - first_layer) & 7];
                    any |= word != 0;
                    let rows = &mut rows[first_row..first_row + 8];
                    rows.copy_from_slice(&word.to_le_bytes());
                }
            }
        }
    }
    any
}

/// The first voxel of the middle brick, from the first of all.
const fn margin(rows: usize) -> usize {
    rows / 2 - 4
}

/// Widens all rows from `width` - 1 to `width` voxels on either side. Eight voxels of a row
/// stand for themselves; the two that come in from beside them are looked up.
fn widen<const BLOCKS: usize, const ROWS: usize>(
    rows: &mut [[u8; ROWS]; ROWS],
    source: &Columns<BLOCKS, ROWS>,
    shape: &BallShape,
    width: usize,
) {
    let [left, right] = [margin(ROWS) - width, margin(ROWS) + 7 + width];
    let [left_bit, right_bit] = [left, right].map(|x| 1_u8 << (x % 8));
    let [left, right] = [left, right].map(|x| &source[x / 8]);
    for z in layers(ROWS, shape) {
        for ((row, left), right) in rows[z].iter_mut().zip(&left[z]).zip(&right[z]) {
            let from_left = u8::from(left & left_bit != 0);
            let from_right = u8::from(right & right_bit != 0) << 7;
            *row |= *row << 1 | *row >> 1 | from_left | from_right;
        }
    }
}

/// Adds the rows of the shape that have just this half-width.
fn take_in<const ROWS: usize>(
    brick: &mut BitBrick,
    rows: &[[u8; ROWS]; ROWS],
    shape: &BallShape,
    width: usize,
) {
    for z in layers(ROWS, shape) {
        let layer = &rows[z];
        if *layer == [0; ROWS] {
            continue;
        }
        for (out, word) in brick.0.iter_mut().enumerate() {
            let beside = z.abs_diff(margin(ROWS) + out);
            let wider = shape.height(width + 1, beside);
            for y in wider + 1..=shape.height(width, beside) {
                let y = y as usize;
                *word |= eight_rows(layer, margin(ROWS) - y) | eight_rows(layer, margin(ROWS) + y);
            }
        }
    }
}

/// The layers that the shape reaches.
fn layers(rows: usize, shape: &BallShape) -> std::ops::Range<usize> {
    let reach = shape.reach().z as usize;
    margin(rows) - reach..margin(rows) + 8 + reach
}

/// Eight rows from the one at `y` on, as a word of a brick.
#[inline]
fn eight_rows<const ROWS: usize>(layer: &[u8; ROWS], y: usize) -> u64 {
    let rows = layer.get(y..).and_then(|rows| rows.first_chunk());
    rows.map_or(0, |rows| u64::from_le_bytes(*rows))
}
