//! What the shares of voxels at the surface change in cells, kept while it stays what it is.
//!
//! Windows overlap, and one that the proxy enters has few cells that the last one had not. What a
//! cell counts beyond its bits follows from which of its voxels are at the surface, on which side
//! of it, and from the values there. So it is kept with those voxels, and what comes out is the
//! same, to the bit, with an empty cache.
//!
//! Frame: grid; cells by their number.

use super::cache::Source;
use super::tents::unit_of;
use super::window::{CELLS, CellShape, SurfaceCell};
use glam::IVec3;
use palpate_volume::occupancy::Occupancy;

/// Cells that are kept: those of one window have places of their own.
const PLACES: usize = (CELLS * CELLS * CELLS) as usize;

/// What is kept of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Kept {
    /// Its number, 21 bits for each axis: of a grid, more than it has voxels.
    number: u64,
    /// Its voxels at the surface, first those that are free.
    surface: u32,
    /// What it counts beyond its bits.
    change: i32,
}

impl Kept {
    /// No cell: where no voxel is at the surface, none is asked for.
    const NONE: Self = Self {
        number: 0,
        surface: 0,
        change: 0,
    };
}

/// What cells of one body count beyond their bits.
#[derive(Clone, Debug)]
pub(super) struct CellShares {
    /// What all was made from; none where nothing is to be used.
    source: Option<(Source, CellShape)>,
    cells: [Kept; PLACES],
}

impl CellShares {
    /// Of no body.
    pub(super) const EMPTY: Self = Self {
        source: None,
        cells: [Kept::NONE; PLACES],
    };

    /// Has all made anew.
    pub(super) fn forget(&mut self) {
        self.source = None;
    }

    /// Keeps what was made from the same, and nothing else.
    pub(super) fn keep(&mut self, source: Source, shape: CellShape) {
        if self.source != Some((source, shape)) {
            self.source = Some((source, shape));
            self.cells.fill(Kept::NONE);
        }
    }

    /// What a cell counts beyond its bits, where one voxel counts [`unit_of`].
    #[inline]
    pub(super) fn change(
        &mut self,
        occupancy: &(impl Occupancy + ?Sized),
        shape: CellShape,
        cell: &SurfaceCell,
    ) -> i32 {
        let number = number_of(cell.number);
        let surface = u32::from(cell.free) | u32::from(cell.solid) << 16;
        let kept = &mut self.cells[place_of(cell.number)];
        if (kept.number, kept.surface) != (number, surface) {
            let change = change_of(occupancy, shape, cell);
            *kept = Kept {
                number,
                surface,
                change,
            };
        }
        kept.change
    }
}

fn number_of(cell: IVec3) -> u64 {
    let [x, y, z] = cell.to_array().map(|number| number as u64 & 0x1f_ffff);
    x | y << 21 | z << 42
}

fn place_of(cell: IVec3) -> usize {
    let [x, y, z] = (cell & (CELLS - 1))
        .to_array()
        .map(|number| number as usize);
    (z << 6 | y << 3 | x) & (PLACES - 1)
}

fn change_of(occupancy: &(impl Occupancy + ?Sized), shape: CellShape, cell: &SurfaceCell) -> i32 {
    let mut change = 0.0_f32;
    for (voxel, solid) in cell.voxels(shape) {
        if let Some(share) = occupancy.share(voxel, solid) {
            change += share - f32::from(u8::from(solid));
        }
    }
    (change * f32::from(unit_of(shape.volume()))).round_ties_even() as i32
}
