//! The surface of a segment, patch by patch, that follows its edits.
//!
//! The first extraction is an update of everything: the same code. Every patch is a function of
//! the bits around it, whatever was there before and on however many threads, so an update gives
//! what a fresh extraction would, to the bit.
//! Source: thesis 5.2.2. There, borders are extended before smoothing and cut after it; here
//! vertices keep to their edge, so that nothing needs to be cut.

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use glam::{DVec3, IVec3};
use palpate_volume::grid::Grid;
use palpate_volume::voxel_box::VoxelBox;
use rayon::prelude::*;

use crate::block::{Blocks, PARTS, PatchId, patch_id};
use crate::field::{Beginning, Blur, FieldScratch, Zeros};
use crate::frame::Frame;
use crate::march::{MarchScratch, Placing, march};
use crate::patch::{Bounds, Patch};
use crate::place::Midpoints;
use crate::samples::{Samples, is_uniform};
use crate::settings::{Limits, SettingsError, SmoothingMode, SurfaceSettings};
use crate::voxel_source::VoxelSource;

/// A patch that is new, or another one than before, or gone.
#[derive(Clone, Debug)]
pub struct PatchChange {
    /// Which one.
    pub id: PatchId,
    /// The new patch; none where nothing of the surface is left there.
    pub patch: Option<Arc<Patch>>,
}

/// The surface of a segment. A clone shares the patches.
#[derive(Clone, Debug)]
pub struct SegmentSurface {
    settings: SurfaceSettings,
    grid: Grid,
    extraction: Arc<Extraction>,
    patches: BTreeMap<PatchId, Kept>,
}

/// A patch, and its box so that nobody has to ask all vertices for it.
#[derive(Clone, Debug)]
struct Kept {
    patch: Arc<Patch>,
    bounds: Option<Bounds>,
}

impl SegmentSurface {
    /// No patches yet: an update with the box of the whole grid makes them.
    ///
    /// # Errors
    /// Where the settings make no surface.
    pub fn new(grid: &Grid, settings: SurfaceSettings) -> Result<Self, SettingsError> {
        settings.check()?;
        Ok(Self {
            settings,
            grid: *grid,
            extraction: Arc::new(Extraction::new(grid, settings)),
            patches: BTreeMap::new(),
        })
    }

    /// Settings of the surface.
    pub fn settings(&self) -> &SurfaceSettings {
        &self.settings
    }

    /// From where positions are counted [patient, LPS mm]: where the grid frame is zero.
    pub fn origin(&self) -> DVec3 {
        self.grid.patient_from_grid().translation
    }

    /// All patches, by their number.
    pub fn patches(&self) -> impl ExactSizeIterator<Item = (PatchId, &Arc<Patch>)> {
        self.patches.iter().map(|(&id, kept)| (id, &kept.patch))
    }

    /// The smallest box of all vertices [mm from the origin]; none without a surface.
    pub fn bounds(&self) -> Option<Bounds> {
        let bounds = self.patches.values().filter_map(|kept| kept.bounds);
        bounds.reduce(Bounds::union)
    }

    /// Area [mm²].
    pub fn area(&self) -> f64 {
        self.patches().map(|(_, patch)| patch.area()).sum()
    }

    /// Volume enclosed [mm³].
    pub fn volume(&self) -> f64 {
        self.patches().map(|(_, patch)| patch.volume()).sum()
    }

    /// Makes the patches again that a change of the voxels in `dirty` can have changed, in
    /// parallel; returns those that differ, by rising number.
    ///
    /// # Panics
    /// Where the voxels are those of another grid.
    pub fn update(&mut self, voxels: &VoxelSource<'_>, dirty: &VoxelBox) -> Vec<PatchChange> {
        assert_eq!(
            voxels.bits.dimensions(),
            self.grid.dimensions(),
            "voxels of another grid"
        );
        if let Some((scan, _)) = voxels.values {
            assert_eq!(
                scan.dimensions(),
                self.grid.dimensions(),
                "values of another grid"
            );
        }
        let extraction = &self.extraction;
        let blocks = extraction.blocks.touched_by(*dirty, &self.settings);
        let made: Vec<Vec<(PatchId, Option<Patch>)>> = blocks
            .par_iter()
            .map_init(Scratch::default, |scratch, &block| {
                let was_parted = self.is_parted(block);
                extraction.patches_of(voxels, block, was_parted, dirty, scratch)
            })
            .collect();

        let mut changes = Vec::new();
        for (id, patch) in made.into_iter().flatten() {
            self.exchange(id, patch, &mut changes);
        }
        changes.sort_by_key(|change| change.id);
        changes
    }

    /// Takes other limits of the intensities; an update of everything makes the surface follow.
    pub fn set_limits(&mut self, limits: Option<Limits>) {
        self.settings.limits = limits;
        self.extraction = Arc::new(Extraction::new(&self.grid, self.settings));
    }

    /// Whether a block has patches in its octants.
    fn is_parted(&self, block: IVec3) -> bool {
        let octants = patch_id(block, 1)..=patch_id(block, PARTS);
        self.patches.range(octants).next().is_some()
    }

    /// Puts a patch, or none, in the place of the old one.
    fn exchange(&mut self, id: PatchId, patch: Option<Patch>, changes: &mut Vec<PatchChange>) {
        let Some(patch) = patch else {
            if self.patches.remove(&id).is_some() {
                changes.push(PatchChange { id, patch: None });
            }
            return;
        };
        if self.patches.get(&id).is_some_and(|old| *old.patch == patch) {
            return;
        }
        let (bounds, patch) = (patch.bounds(), Arc::new(patch));
        let kept = Kept {
            patch: Arc::clone(&patch),
            bounds,
        };
        self.patches.insert(id, kept);
        changes.push(PatchChange {
            id,
            patch: Some(patch),
        });
    }
}

/// What a thread keeps between patches.
#[derive(Debug, Default)]
struct Scratch {
    samples: Samples,
    field: FieldScratch,
    march: MarchScratch,
}

/// All that turns voxels into patches and never changes.
#[derive(Debug)]
struct Extraction {
    settings: SurfaceSettings,
    blocks: Blocks,
    frame: Frame,
    /// Made when first asked for: most surfaces are smoothed.
    midpoints: OnceLock<Midpoints>,
    blur: Blur,
}

impl Extraction {
    fn new(grid: &Grid, settings: SurfaceSettings) -> Self {
        let frame = Frame::new(grid);
        Self {
            settings,
            blocks: Blocks::new(grid.dimensions(), i32::from(settings.step)),
            frame,
            midpoints: OnceLock::new(),
            blur: Blur::new(grid.spacing(), settings.smoothing),
        }
    }

    /// The patches of a block: of all of it, or of each octant where it is dense. Octants that a
    /// change of the voxels in `dirty` cannot change are left out where they are there already.
    fn patches_of(
        &self,
        voxels: &VoxelSource<'_>,
        block: IVec3,
        was_parted: bool,
        dirty: &VoxelBox,
        scratch: &mut Scratch,
    ) -> Vec<(PatchId, Option<Patch>)> {
        let is_dense = self.is_dense(voxels, block, scratch);
        let is_changed = |part: u8| {
            part == 0
                || was_parted != is_dense
                || self.blocks.is_touched(block, part, *dirty, &self.settings)
        };
        (0..=PARTS)
            .filter(|part| is_changed(*part))
            .map(|part| {
                let is_made = is_dense == (part > 0);
                let patch = || self.patch_of(voxels, block, part, scratch);
                (patch_id(block, part), is_made.then(patch).flatten())
            })
            .collect()
    }

    /// Whether a block has more vertices than one patch may.
    fn is_dense(&self, voxels: &VoxelSource<'_>, block: IVec3, scratch: &mut Scratch) -> bool {
        let (Some(most), Some(own)) = (
            self.settings.most_vertices,
            self.blocks.samples_of(block, 0),
        ) else {
            return false;
        };
        let step = i32::from(self.settings.step);
        if is_uniform(voxels.bits, step, own) {
            return false;
        }
        let first = block.x * crate::settings::PATCH_CELLS;
        let samples = &mut scratch.samples;
        samples.load(voxels.bits, step, own, first);
        samples.crossings(own) > most
    }

    /// The surface in a block or an octant of it.
    fn patch_of(
        &self,
        voxels: &VoxelSource<'_>,
        block: IVec3,
        part: u8,
        scratch: &mut Scratch,
    ) -> Option<Patch> {
        let step = i32::from(self.settings.step);
        let own = self.blocks.samples_of(block, part)?;
        if is_uniform(voxels.bits, step, own) {
            return None;
        }
        let Scratch {
            samples,
            field,
            march: scratch,
        } = scratch;
        let margin = self.settings.margin();
        let first = block.x * crate::settings::PATCH_CELLS;
        samples.load(voxels.bits, step, own.dilate(margin), first);

        let limits = self.settings.limits.filter(|_| voxels.values.is_some());
        let patch = if self.settings.smoothing == 0 && limits.is_none() {
            let midpoints = self.midpoints.get_or_init(|| Midpoints::new(&self.frame));
            march(
                samples,
                own,
                Placing {
                    frame: &self.frame,
                    step: f64::from(step),
                    placement: midpoints,
                },
                scratch,
            )
        } else {
            let active = samples.crossed(own)?;
            let alone = self.settings.mode == SmoothingMode::Local && self.settings.smoothing > 0;
            if alone {
                samples.isolate(own);
            }
            let depths = |first: IVec3, depths: &mut [f32]| {
                let Some(limits) = limits else { return };
                if alone {
                    depths_within(own, first, depths, |first, depths| {
                        voxels.depths(limits, step, first, depths);
                    });
                } else {
                    voxels.depths(limits, step, first, depths);
                }
            };
            let beginning = match limits {
                None => Beginning::Bits,
                Some(_) => Beginning::Depths(&depths),
            };
            let field = field.smooth(&self.blur, samples, active, &beginning);
            let zeros = Zeros {
                field,
                frame: &self.frame,
                keep_thin: self.settings.smoothing > 0,
            };
            march(
                samples,
                own,
                Placing {
                    frame: &self.frame,
                    step: f64::from(step),
                    placement: &zeros,
                },
                scratch,
            )
        };
        (!patch.is_empty()).then_some(patch)
    }
}

/// A row of depths where a patch sees but its own samples: whatever lies beyond is as its border.
fn depths_within(
    own: VoxelBox,
    first: IVec3,
    depths: &mut [f32],
    depths_of: impl Fn(IVec3, &mut [f32]),
) {
    for (x, depth) in (first.x..).zip(depths) {
        let seen = first.with_x(x).clamp(own.min, own.max - 1);
        depths_of(seen, std::slice::from_mut(depth));
    }
}
