//! The surface of a segment that is kept, and follows its voxels by the boxes in which they change.
//!
//! Where a threshold made the segment, the scan's values may say where between voxels the surface
//! is. They are the scan's own, as touch reads them: a voxel whose bit and value disagree was
//! edited, and counts as its bit says. So edits need nothing but bits.

use palpate_surface::{
    Limits, PatchChange, SegmentSurface, SettingsError, SurfaceSettings, VoxelSource,
};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::voxel_box::VoxelBox;

use crate::touch::ThresholdRange;

/// A patch with more vertices is parted into octants, so that an edit sends less of it.
const MOST_VERTICES: u32 = 6000;

/// What a surface is made from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SurfaceSource {
    /// The scan's values where a threshold made the segment, else its bits.
    #[default]
    Intensities,
    /// The bits.
    Bits,
}

/// How the surface of a segment is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceOptions {
    /// Smoothing, step and patches; its limits are those of the segment's threshold.
    pub settings: SurfaceSettings,
    /// What it is made from.
    pub source: SurfaceSource,
}

impl Default for SurfaceOptions {
    fn default() -> Self {
        let usual = SurfaceSettings::default();
        Self::new(usual.smoothing, usual.step, SurfaceSource::default())
    }
}

impl SurfaceOptions {
    /// With a degree of smoothing and a step [voxels].
    #[must_use]
    pub fn new(smoothing: u8, step: u8, source: SurfaceSource) -> Self {
        let settings = SurfaceSettings {
            smoothing,
            step,
            most_vertices: Some(MOST_VERTICES),
            ..SurfaceSettings::default()
        };
        Self { settings, source }
    }

    fn limits(&self, made_by: Option<ThresholdRange>) -> Option<Limits> {
        // a threshold of one value has no inside
        made_by
            .filter(|(low, high)| self.source == SurfaceSource::Intensities && low < high)
            .map(|(low, high)| Limits { low, high })
    }
}

/// All voxels of a segment, and the threshold that made them, if one did.
#[derive(Clone, Debug)]
pub struct SegmentVoxels {
    /// The grid that they stand on.
    pub grid: Grid,
    /// The voxels.
    pub bits: Bits,
    /// The threshold.
    pub made_by: Option<ThresholdRange>,
}

/// A surface and the voxels that it is to follow. A clone shares bricks and patches.
#[derive(Clone, Debug)]
pub struct IncrementalSurface {
    options: SurfaceOptions,
    voxels: SegmentVoxels,
    surface: SegmentSurface,
    /// The box of voxels that the surface does not follow yet.
    dirty: VoxelBox,
}

impl IncrementalSurface {
    /// Of these voxels; nothing is made before [`Self::follow`].
    ///
    /// # Errors
    /// Where such a surface cannot be made.
    pub fn new(options: SurfaceOptions, voxels: SegmentVoxels) -> Result<Self, SettingsError> {
        let settings = SurfaceSettings {
            limits: options.limits(voxels.made_by),
            ..options.settings
        };
        Ok(Self {
            options,
            surface: SegmentSurface::new(&voxels.grid, settings)?,
            dirty: voxels.grid.bounds(),
            voxels,
        })
    }

    /// How it is made.
    #[must_use]
    pub fn options(&self) -> &SurfaceOptions {
        &self.options
    }

    /// The surface, as far as it follows.
    #[must_use]
    pub fn surface(&self) -> &SegmentSurface {
        &self.surface
    }

    /// Whether these are the voxels that it is to follow.
    #[must_use]
    pub fn has(&self, voxels: &SegmentVoxels) -> bool {
        let same_threshold = self.voxels.made_by == voxels.made_by;
        let same_grid = self.voxels.grid == voxels.grid;
        same_threshold && same_grid && self.voxels.bits.difference(&voxels.bits).is_empty()
    }

    /// Exchanges bricks, which differ in the box `dirty` only.
    pub fn swap(&mut self, swaps: &mut [BrickSwap<BitBrick>], dirty: &VoxelBox) {
        let bits = &mut self.voxels.bits;
        swaps.iter_mut().for_each(|swap| bits.swap(swap));
        self.dirty = self.dirty.union(dirty);
    }

    /// The grid that the voxels stand on.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.voxels.grid
    }

    /// Takes other voxels of the same grid in the place of all.
    pub fn replace(&mut self, voxels: SegmentVoxels) {
        let limits = self.options.limits(voxels.made_by);
        let dirty = if limits == self.surface.settings().limits {
            self.voxels.bits.difference(&voxels.bits)
        } else {
            self.surface.set_limits(limits);
            VoxelBox::of_dimensions(voxels.bits.dimensions())
        };
        self.dirty = self.dirty.union(&dirty);
        self.voxels = voxels;
    }

    /// Makes the surface follow its voxels; gives the patches that differ.
    pub fn follow(&mut self, scan: &Intensities) -> Vec<PatchChange> {
        let dirty = std::mem::replace(&mut self.dirty, VoxelBox::EMPTY);
        if dirty.is_empty() {
            return Vec::new();
        }
        let source = VoxelSource {
            bits: &self.voxels.bits,
            // only where they limit anything: a segment with a grid of its own has none
            values: self.surface.settings().limits.map(|_| (scan, None)),
        };
        self.surface.update(&source, &dirty)
    }
}
