//! The scan's own values. They never change; voxel edits stand in an `Overlay`.
//!
//! Memory: i16, x fastest, then y, then z; shared between clones. Physical value = slope ·
//! stored + intercept, in the scan's unit (HU where it is known to be CT).

use std::sync::Arc;

use glam::{IVec3, UVec3};
use rayon::prelude::*;
use thiserror::Error;

use crate::grid::{GridError, check_dimensions, is_inside, voxel_count, voxel_index};

/// Values that one task of a parallel pass reads: 128 KiB.
const CHUNK: usize = 1 << 16;

/// Number of different stored values.
const STORED_VALUES: usize = 1 << 16;

/// Values that are no scan.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum IntensitiesError {
    /// Not one value per voxel.
    #[error("{given} values given for a grid of {dimensions}; allowed: {allowed}")]
    Length {
        /// Values given.
        given: usize,
        /// Voxels of the grid.
        allowed: usize,
        /// Voxels along each axis.
        dimensions: UVec3,
    },
    /// The rescaling is not invertible.
    #[error("slope {slope} and intercept {intercept} given; allowed: finite, slope not 0")]
    Rescale {
        /// Physical units per stored unit.
        slope: f64,
        /// Physical value of stored 0.
        intercept: f64,
    },
    /// The dimensions are those of no grid.
    #[error(transparent)]
    Grid(#[from] GridError),
}

/// Stored values of a scan and what they mean. A clone shares them.
#[derive(Clone, Debug)]
pub struct Intensities {
    dimensions: UVec3,
    values: Arc<[i16]>,
    slope: f64,
    intercept: f64,
}

/// Voxels by value, in bins of equal width.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Physical value where the first bin begins.
    pub low: f64,
    /// Physical value where the last bin ends.
    pub high: f64,
    /// Voxels in each bin, by rising physical value.
    pub counts: Vec<u64>,
}

impl Intensities {
    /// Takes stored values, x fastest.
    ///
    /// # Errors
    /// Where there is not one value per voxel, or the rescaling is not invertible.
    pub fn new(
        dimensions: UVec3,
        values: impl Into<Arc<[i16]>>,
        slope: f64,
        intercept: f64,
    ) -> Result<Self, IntensitiesError> {
        check_dimensions(dimensions)?;
        let (values, allowed) = (values.into(), voxel_count(dimensions));
        if values.len() != allowed {
            return Err(IntensitiesError::Length {
                given: values.len(),
                allowed,
                dimensions,
            });
        }
        if !slope.is_finite() || slope == 0.0 || !intercept.is_finite() {
            return Err(IntensitiesError::Rescale { slope, intercept });
        }
        Ok(Self {
            dimensions,
            values,
            slope,
            intercept,
        })
    }

    /// Voxels along x, y and z.
    pub fn dimensions(&self) -> UVec3 {
        self.dimensions
    }

    /// All stored values, x fastest.
    pub fn values(&self) -> &Arc<[i16]> {
        &self.values
    }

    /// Physical units per stored unit; not 0, maybe negative.
    pub fn slope(&self) -> f64 {
        self.slope
    }

    /// Physical value of stored 0.
    pub fn intercept(&self) -> f64 {
        self.intercept
    }

    /// Physical value of a stored one.
    #[inline]
    pub fn physical(&self, stored: i16) -> f64 {
        self.slope * f64::from(stored) + self.intercept
    }

    /// Stored value of a voxel; none outside the grid.
    #[inline]
    pub fn stored(&self, voxel: IVec3) -> Option<i16> {
        is_inside(self.dimensions, voxel).then(|| self.values[voxel_index(self.dimensions, voxel)])
    }

    /// Physical value of a voxel; none outside the grid.
    #[inline]
    pub fn value(&self, voxel: IVec3) -> Option<f64> {
        self.stored(voxel).map(|stored| self.physical(stored))
    }

    /// Smallest and largest stored value.
    pub fn stored_range(&self) -> (i16, i16) {
        self.values
            .par_chunks(CHUNK)
            .map(|values| {
                values
                    .iter()
                    .fold((i16::MAX, i16::MIN), |(low, high), &stored| {
                        (low.min(stored), high.max(stored))
                    })
            })
            .reduce(|| (i16::MAX, i16::MIN), |a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// Smallest and largest physical value.
    pub fn range(&self) -> (f64, f64) {
        let (low, high) = self.stored_range();
        let ends = [self.physical(low), self.physical(high)];
        (ends[0].min(ends[1]), ends[0].max(ends[1]))
    }

    /// Counts voxels in bins of equal width, in parallel. Each stored value fills the unit
    /// around it, so that the outer bins reach half a unit beyond [`Self::range`].
    ///
    /// # Panics
    /// Where no bins are asked for.
    pub fn histogram(&self, bins: usize) -> Histogram {
        assert!(bins > 0, "a histogram has at least one bin");
        let by_stored = self.counts_by_stored();
        let occupied = |&(_, &voxels): &(usize, &u64)| voxels > 0;
        let numbered = || by_stored.iter().enumerate();
        let first = numbered().find(occupied).map_or(0, |(place, _)| place);
        let last = numbered().rfind(occupied).map_or(0, |(place, _)| place);

        // the bin of a value is that of its middle, counted in half units from the low end
        let (units, falling) = (last - first + 1, self.slope < 0.0);
        let mut counts = vec![0; bins];
        for (unit, &voxels) in by_stored[first..=last].iter().enumerate() {
            let unit = if falling { units - 1 - unit } else { unit };
            counts[(2 * unit + 1) * bins / (2 * units)] += voxels;
        }
        let edge = |place: f64| self.slope * (place + f64::from(i16::MIN)) + self.intercept;
        let (mut low, mut high) = (edge(first as f64 - 0.5), edge(last as f64 + 0.5));
        if falling {
            (low, high) = (high, low);
        }
        Histogram { low, high, counts }
    }

    /// Voxels of each stored value, from the smallest.
    fn counts_by_stored(&self) -> Vec<u64> {
        // a large share for each task, since every task has a table of its own
        let share = self.values.len().div_ceil(rayon::current_num_threads());
        self.values
            .par_chunks(share.max(CHUNK))
            .map(|values| {
                let mut counts = vec![0u64; STORED_VALUES];
                for &stored in values {
                    counts[(i32::from(stored) - i32::from(i16::MIN)) as usize] += 1;
                }
                counts
            })
            .reduce(
                || vec![0; STORED_VALUES],
                |mut sum, counts| {
                    for (sum, voxels) in sum.iter_mut().zip(counts) {
                        *sum += voxels;
                    }
                    sum
                },
            )
    }
}
