//! The scan's values as touch reads them, where a threshold made a segment.
//!
//! They are the scan's own: what voxel edits put over them is not read, since a voxel whose bit
//! and value disagree counts as its bit says anyway. So they never change, and only pointers to
//! them are handed on. While a recording runs, the bricks that are read are marked, so that it can
//! keep just those; a replay has no others.
//!
//! Frame: grid; values as stored.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

use glam::{IVec3, UVec3};
use palpate_haptics::smooth::occupancy_fractions::{Around, Limits, Stored};
use palpate_volume::brick_grid::{BRICK, BrickGrid, BrickSwap};
use palpate_volume::intensities::Intensities;
use palpate_volume::intensity_brick::IntensityBrick;
use palpate_volume::overlay::Overlay;

/// Threshold that a segment is, in physical units: low and high, both included.
pub type ThresholdRange = (f64, f64);

/// Values of a scan. A clone shares them, and the marks.
#[derive(Clone, Debug)]
pub struct ScanValues {
    kept: Kept,
    /// Voxels along each axis.
    dimensions: UVec3,
    /// Physical units per stored unit, and the physical value of stored 0.
    rescale: (f64, f64),
    marks: Arc<Marks>,
}

/// Which bricks were read.
#[derive(Debug)]
struct Marks {
    /// Whether somebody wants to know.
    wanted: AtomicBool,
    /// One bit for each brick.
    read: Box<[AtomicU64]>,
}

/// Which of them there are.
#[derive(Clone, Debug)]
enum Kept {
    All(Intensities),
    Some(Arc<BrickGrid<IntensityBrick>>),
}

/// A brick of values and its place in the directory.
pub type ValueBrick = (u32, Arc<IntensityBrick>);

impl ScanValues {
    /// All values of a scan.
    #[must_use]
    pub fn of(scan: &Intensities) -> Self {
        let dimensions = scan.dimensions();
        Self {
            kept: Kept::All(scan.clone()),
            dimensions,
            rescale: (scan.slope(), scan.intercept()),
            marks: no_marks(dimensions),
        }
    }

    /// Some bricks of a scan; all other values are 0.
    #[must_use]
    pub fn of_bricks(
        dimensions: UVec3,
        rescale: (f64, f64),
        bricks: impl IntoIterator<Item = ValueBrick>,
    ) -> Self {
        let mut grid = BrickGrid::empty(dimensions);
        for (index, brick) in bricks {
            let brick = Some(brick);
            grid.swap(&mut BrickSwap { index, brick });
        }
        Self {
            kept: Kept::Some(Arc::new(grid)),
            dimensions,
            rescale,
            marks: no_marks(dimensions),
        }
    }

    /// Marks all bricks that are read from now on; marks of others are forgotten.
    pub fn begin_marking(&self) {
        for word in &self.marks.read {
            word.store(0, Relaxed);
        }
        self.marks.wanted.store(true, Relaxed);
    }

    /// Ends that, and gives the same values with the marks as they are.
    #[must_use]
    pub fn end_marking(&self) -> Self {
        self.marks.wanted.store(false, Relaxed);
        let read = self.marks.read.iter().map(|word| word.load(Relaxed).into());
        let marks = Marks {
            wanted: false.into(),
            read: read.collect(),
        };
        Self {
            marks: Arc::new(marks),
            ..self.clone()
        }
    }

    /// Voxels along x, y and z.
    #[must_use]
    pub fn dimensions(&self) -> UVec3 {
        self.dimensions
    }

    /// Physical units per stored unit, and the physical value of stored 0.
    #[must_use]
    pub fn rescale(&self) -> (f64, f64) {
        self.rescale
    }

    /// The occupancy fraction of a voxel; see `Occupancy::share`.
    #[inline]
    #[must_use]
    pub fn share(&self, limits: &Limits, voxel: IVec3, solid: bool) -> Option<f32> {
        if self.marks.wanted.load(Relaxed) {
            self.mark(voxel);
        }
        let around = match &self.kept {
            Kept::All(scan) => Around::of(scan, voxel),
            Kept::Some(bricks) => Around::of_stored(self.stored_in_bricks(bricks, voxel)),
        };
        limits.fraction(&around, solid)
    }

    /// What those of some voxels are beyond their bits; see `Occupancy::fraction_changes`.
    #[inline]
    pub fn fraction_changes(&self, limits: &Limits, voxels: &[(IVec3, bool)], changes: &mut [f32]) {
        if self.marks.wanted.load(Relaxed) {
            voxels.iter().for_each(|(voxel, _)| self.mark(*voxel));
        }
        match &self.kept {
            Kept::All(scan) => {
                limits.fraction_changes(|voxel| Around::stored(scan, voxel), voxels, changes);
            }
            Kept::Some(bricks) => {
                limits.fraction_changes(
                    |voxel| self.stored_in_bricks(bricks, voxel),
                    voxels,
                    changes,
                );
            }
        }
    }

    /// The values around a voxel where only some bricks are kept.
    #[inline(never)]
    fn stored_in_bricks(&self, bricks: &BrickGrid<IntensityBrick>, voxel: IVec3) -> Stored {
        let last = self.dimensions.as_ivec3() - 1;
        Around::stored_from(voxel, |voxel| {
            let voxel = voxel.clamp(IVec3::ZERO, last);
            bricks.at(voxel).map_or(0, |brick| brick.stored(voxel))
        })
    }

    /// The bricks that are marked, or all where there are only some; by rising place.
    #[must_use]
    pub fn read_bricks(&self) -> Vec<ValueBrick> {
        match &self.kept {
            Kept::Some(bricks) => (0..)
                .zip(bricks.entries())
                .filter_map(|(index, brick)| Some((index, Arc::clone(brick.as_ref()?))))
                .collect(),
            Kept::All(scan) => {
                let whole = Overlay::empty(self.dimensions);
                let brick = |index| (index, Arc::new(whole.brick(scan, index)));
                self.marked().map(brick).collect()
            }
        }
    }

    fn marked(&self) -> impl Iterator<Item = u32> {
        (0..).zip(&self.marks.read).flat_map(|(place, word)| {
            let word = word.load(Relaxed);
            let set = (0..64_u32).filter(move |bit| word >> bit & 1 == 1);
            set.map(move |bit| 64 * place + bit)
        })
    }

    /// Marks the bricks of a voxel and of its neighbours.
    #[cold]
    #[inline(never)]
    fn mark(&self, voxel: IVec3) {
        let last = self.dimensions.as_ivec3() - 1;
        let here = voxel.clamp(IVec3::ZERO, last);
        self.mark_brick_of(here);
        for axis in [IVec3::X, IVec3::Y, IVec3::Z] {
            for beside in [here - axis, here + axis] {
                let beside = beside.clamp(IVec3::ZERO, last);
                if beside / BRICK != here / BRICK {
                    self.mark_brick_of(beside);
                }
            }
        }
    }

    fn mark_brick_of(&self, voxel: IVec3) {
        let size = self.dimensions.map(|count| count.div_ceil(BRICK as u32));
        let brick = (voxel / BRICK).as_uvec3();
        let index = (brick.z * size.y + brick.y) * size.x + brick.x;
        if let Some(word) = self.marks.read.get(index as usize / 64) {
            word.fetch_or(1 << (index % 64), Relaxed);
        }
    }
}

fn no_marks(dimensions: UVec3) -> Arc<Marks> {
    let bricks = dimensions.map(|count| count.div_ceil(BRICK as u32));
    let count = bricks.as_usizevec3().element_product();
    Arc::new(Marks {
        wanted: false.into(),
        read: (0..count.div_ceil(64)).map(|_| AtomicU64::new(0)).collect(),
    })
}

/// The threshold that made a segment.
#[derive(Clone, Debug)]
pub struct Threshold {
    /// Lowest and highest value, physical.
    pub range: ThresholdRange,
    /// The values.
    pub values: ScanValues,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values that rise along all axes, in a grid that is no multiple of a brick.
    fn scan() -> Intensities {
        let dimensions = UVec3::new(19, 11, 21);
        let values: Vec<i16> = (0..19 * 11 * 21).map(|i| (i * 37 % 1000) as i16).collect();
        Intensities::new(dimensions, values, 1.0, 0.0).expect("one value per voxel")
    }

    #[test]
    fn bricks_that_were_read_tell_the_same_shares_as_the_scan() {
        let scan = scan();
        let values = ScanValues::of(&scan);
        let limits = Limits::new((1.0, 0.0), [(400.0, 900.0)]);
        let asked = [
            IVec3::new(3, 4, 5),
            IVec3::new(8, 7, 15),
            IVec3::new(18, 10, 20),
            IVec3::new(-1, 0, 0),
            IVec3::new(19, 10, 7),
        ];
        let share = |values: &ScanValues| {
            asked.map(|voxel| [true, false].map(|solid| values.share(&limits, voxel, solid)))
        };
        let changes = |values: &ScanValues| {
            let mut changes = [[f32::NAN; 5]; 2];
            for (changes, solid) in changes.iter_mut().zip([true, false]) {
                values.fraction_changes(&limits, &asked.map(|voxel| (voxel, solid)), changes);
            }
            changes
        };
        let before = share(&values);
        let changes_before = changes(&values);
        assert!(values.read_bricks().is_empty());
        values.begin_marking();
        assert_eq!(changes(&values), changes_before);
        let marked = values.read_bricks().len();
        assert_eq!(share(&values), before);
        assert_eq!(values.read_bricks().len(), marked);
        assert!(before.iter().flatten().any(Option::is_some));

        let bricks = values.read_bricks();
        let all = 3 * 2 * 3;
        assert!(!bricks.is_empty() && bricks.len() < all, "{}", bricks.len());
        let kept = ScanValues::of_bricks(scan.dimensions(), values.rescale(), bricks);
        assert_eq!(share(&kept), before);
        assert_eq!(changes(&kept), changes_before);

        // marks end with the recording, and begin anew with the next
        let ended = values.end_marking();
        values.begin_marking();
        assert!(values.read_bricks().is_empty());
        assert!(!ended.read_bricks().is_empty());
    }
}
