//! How much of the light passes each cell over the length of its edge, and what passes at places that lie
//! beside all cells of a row alike: the same four rows with the same weights.

use std::ops::Range;

use glam::{IVec3, Vec3};
use palpate_volume::voxel_box::VoxelBox;
use rayon::prelude::*;

/// Fractions of the light.
#[derive(Clone, Debug)]
pub(super) struct Clarity {
    counts: IVec3,
    /// x fastest; each row has a copy of its end beside each end.
    rows: Vec<f32>,
    /// Whether all of the light passes a row.
    are_clear: Vec<bool>,
}

/// What passes beside the cells of a row.
pub(super) enum Beside {
    /// All of the light, outside of the scan.
    Outside,
    /// All of the light.
    All,
    /// What was written for these cells.
    Some(Range<usize>),
}

/// Memory for a row of cells.
pub(super) struct Scratch {
    /// What passes beside each cell, from the first on.
    pub passing: Vec<f32>,
    /// What has passed so far, and sums of it, by cell.
    pub clear: Vec<f32>,
    pub sum: Vec<f32>,
}

impl Scratch {
    pub fn new(columns: usize) -> Self {
        Self {
            passing: vec![0.0; columns],
            clear: vec![1.0; columns],
            sum: vec![0.0; columns],
        }
    }

    /// The light that was last worked out, by cell.
    pub fn found(&self) -> &[f32] {
        &self.sum
    }
}

impl Clarity {
    /// All of the light passes.
    pub fn whole(counts: IVec3) -> Self {
        let rows = (counts.y * counts.z) as usize;
        Self {
            counts,
            rows: vec![1.0; rows * (counts.x as usize + 2)],
            are_clear: vec![true; rows],
        }
    }

    /// Changes rows of a box of cells, all at once: `change` is given the row's place and its cells.
    pub fn change(
        &mut self,
        region: &VoxelBox,
        change: impl Fn((i32, i32), &mut [f32]) -> Result<(), ()> + Sync,
    ) -> Option<()> {
        let columns = self.counts.x as usize;
        let rows = self.rows.par_chunks_mut(columns + 2);
        let rows = rows.zip(&mut self.are_clear).enumerate();
        let height = self.counts.y;
        let changed: Result<(), ()> = rows.try_for_each(|(index, (row, is_clear))| {
            let (y, z) = (index as i32 % height, index as i32 / height);
            let is_in = (region.min.y..region.max.y).contains(&y)
                && (region.min.z..region.max.z).contains(&z);
            if is_in {
                change((y, z), &mut row[1..=columns])?;
                row[0] = row[1];
                row[columns + 1] = row[columns];
                *is_clear = row.iter().all(|&share| share == 1.0);
            }
            Ok(())
        });
        changed.ok()
    }

    fn row_index(&self, y: i32, z: i32) -> usize {
        (y + self.counts.y * z) as usize
    }

    /// What passes at places that lie so far from the middles of a row's cells [cells], of those of `span`.
    #[inline(always)]
    pub fn beside(
        &self,
        (y, z): (i32, i32),
        offset: Vec3,
        span: &Range<usize>,
        scratch: &mut Scratch,
    ) -> Beside {
        let Some(y) = Between::new(y, offset.y, self.counts.y) else {
            return Beside::Outside;
        };
        let Some(z) = Between::new(z, offset.z, self.counts.z) else {
            return Beside::Outside;
        };
        let cells = cells_inside(offset.x, self.counts.x, span);
        if cells.is_empty() {
            return Beside::Outside;
        }
        let rows = [
            self.row_index(y.first, z.first),
            self.row_index(y.second, z.first),
            self.row_index(y.first, z.second),
            self.row_index(y.second, z.second),
        ];
        if rows.iter().all(|&row| self.are_clear[row]) {
            return Beside::All;
        }
        let weights = [
            (1.0 - y.share) * (1.0 - z.share),
            y.share * (1.0 - z.share),
            (1.0 - y.share) * z.share,
            y.share * z.share,
        ];
        self.mix(rows, weights, (offset.x, &cells), scratch);
        Beside::Some(cells)
    }

    #[inline(always)]
    fn mix(
        &self,
        rows: [usize; 4],
        weights: [f32; 4],
        (offset, cells): (f32, &Range<usize>),
        scratch: &mut Scratch,
    ) {
        let width = self.counts.x as usize + 2;
        let whole = offset.floor();
        let share = offset - whole;
        // one more for the copy of the first cell
        let start = (cells.start as i32 + whole as i32 + 1) as usize;
        let count = cells.len();
        let a = &self.rows[rows[0] * width + start..][..=count];
        let b = &self.rows[rows[1] * width + start..][..=count];
        let c = &self.rows[rows[2] * width + start..][..=count];
        let d = &self.rows[rows[3] * width + start..][..=count];
        let mean = |i: usize| {
            weights[0] * a[i] + weights[1] * b[i] + weights[2] * c[i] + weights[3] * d[i]
        };
        for (i, passing) in scratch.passing[..count].iter_mut().enumerate() {
            let (first, second) = (mean(i), mean(i + 1));
            *passing = first + (second - first) * share;
        }
    }
}

/// The two cells of a line between whose middles a place lies, and the fraction of the way to the second.
struct Between {
    first: i32,
    second: i32,
    share: f32,
}

impl Between {
    /// None outside of the scan; within it the outermost cells go on.
    #[inline(always)]
    fn new(cell: i32, offset: f32, count: i32) -> Option<Self> {
        let place = cell as f32 + offset;
        let whole = place.floor();
        let first = whole as i32;
        (-0.5 <= place && place <= count as f32 - 0.5).then(|| Self {
            first: first.max(0),
            second: (first + 1).min(count - 1),
            share: place - whole,
        })
    }
}

/// Cells of a span beside which a place lies in the scan, and between cells or their copies.
#[inline(always)]
fn cells_inside(offset: f32, count: i32, span: &Range<usize>) -> Range<usize> {
    let whole = offset.floor() as i32;
    let low = ((-0.5 - offset).ceil() as i32).max(-1 - whole);
    let high = ((count as f32 - 0.5 - offset).floor() as i32 + 1).min(count - whole);
    let low = low.clamp(span.start as i32, span.end as i32);
    let high = high.clamp(low, span.end as i32);
    low as usize..high as usize
}
