//! What is touched: segments of one scan, as they are or amid a larger one.
//!
//! Frame: grid of the scan; a larger grid is placed so that every voxel stays where it is.

use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_engine::touch::{Part, ScanValues, Threshold, ThresholdRange};
use palpate_volume::bits::Bits;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::{Grid, GridError};
use palpate_volume::intensities::Intensities;
use palpate_volume::occupancy::Occupancy;

/// Segments where the scan has them.
#[derive(Clone, Debug)]
pub struct Ground {
    /// Where the scan stands.
    pub grid: Grid,
    segments: Vec<Bits>,
    /// What made them, as far as that is known.
    thresholds: Vec<Option<Threshold>>,
}

impl Ground {
    /// These segments of a scan, each of its dimensions, 255 at most.
    #[must_use]
    pub fn new(grid: Grid, segments: Vec<Bits>) -> Self {
        Self {
            grid,
            segments,
            thresholds: Vec::new(),
        }
    }

    /// The same where thresholds on the scan made some of the segments.
    #[must_use]
    pub fn made_by(self, scan: &Intensities, ranges: &[Option<ThresholdRange>]) -> Self {
        let values = ScanValues::of(scan);
        let threshold = |range: &Option<ThresholdRange>| {
            let values = values.clone();
            range.map(|range| Threshold { range, values })
        };
        Self {
            thresholds: ranges.iter().map(threshold).collect(),
            ..self
        }
    }

    /// The same, of whose segments nothing is known but their bits.
    #[must_use]
    pub fn of_bits(&self) -> Self {
        Self::new(self.grid, self.segments.clone())
    }

    /// As the servo wants them: numbered from 1.
    #[must_use]
    pub fn parts(&self) -> Vec<Part> {
        (1..=u8::MAX)
            .zip(&self.segments)
            .enumerate()
            .map(|(place, (number, bits))| Part {
                id: SegmentId(number),
                bits: bits.clone(),
                moved: None,
                threshold: self.thresholds.get(place).cloned().flatten(),
                fractions: None,
                punctured: false,
                rigid: None,
            })
            .collect()
    }

    /// The same voxels in the middle of a larger grid, at the same place of the scene; of what
    /// made them nothing is known there.
    ///
    /// # Errors
    /// Where no grid has these dimensions.
    pub fn embedded(&self, dimensions: UVec3) -> Result<Self, GridError> {
        let room = dimensions.as_ivec3() - self.grid.dimensions().as_ivec3();
        let offset = (room / 2).max(IVec3::ZERO);
        let spacing = self.grid.spacing();
        let patient_from_grid = self.grid.patient_from_grid();
        // the middle of the voxel that is voxel 0 of the larger grid
        let first = DVec3::splat(0.5) - offset.as_dvec3();
        let origin = patient_from_grid.transform_point3(first);
        let direction = patient_from_grid.matrix3 * DMat3::from_diagonal(1.0 / spacing);
        let grid = Grid::new(dimensions, spacing, origin, direction)?;
        let segments = self
            .segments
            .iter()
            .map(|bits| Bits::from_bricks(dimensions, |brick| bits.block(brick.min - offset)))
            .collect();
        Ok(Self::new(grid, segments))
    }
}
