//! A scan as it is drawn: its voxels at one edit, and what is known of its bricks.

use std::collections::BTreeSet;
use std::sync::Arc;

use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;
use thiserror::Error;

use crate::appearance::Blend;
use crate::bricks::BrickRanges;
use crate::displaced::{Displaced, Displacements};
use crate::field::Field;
use crate::second::{Second, SecondAppearance, SecondScan};
use crate::surfaces::{OnePatch, SegmentSurface, other_patches};

/// A scan that cannot be drawn.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum SceneError {
    /// Places in memory would not fit into 31 bits.
    #[error("a scan of {given} voxels given; allowed: {allowed}")]
    TooLarge {
        /// Its voxels.
        given: usize,
        /// The most that can be drawn.
        allowed: usize,
    },
}

/// Most voxels of a scan, one less than places that the ray caster can count, for the value beside the last.
const MOST_VOXELS: usize = i32::MAX as usize - 1;

/// A scan and its segments as they are drawn. Values are shared with the session, not copied.
#[derive(Clone, Debug)]
pub struct Scene {
    voxels: Voxels,
    pub(crate) field: Field,
    pub(crate) ranges: BrickRanges,
    pub(crate) displaced: Option<Displaced>,
    pub(crate) surfaces: Vec<SegmentSurface>,
    pub(crate) second: Option<Box<Second>>,
}

impl Scene {
    /// Takes voxels as they are now; reads each value once.
    ///
    /// # Errors
    /// Where there are too many.
    pub fn new(voxels: Voxels) -> Result<Self, SceneError> {
        // a scan of one column is held twice as wide
        let given = voxels.grid().voxel_count();
        let columns = voxels.grid().dimensions().x as usize;
        let held = if columns > 1 { given } else { 2 * given };
        if held > MOST_VOXELS {
            return Err(SceneError::TooLarge {
                given,
                allowed: MOST_VOXELS,
            });
        }
        let field = field_of(&voxels);
        let ranges = BrickRanges::new(&field);
        Ok(Self {
            voxels,
            field,
            ranges,
            displaced: None,
            surfaces: Vec::new(),
            second: None,
        })
    }

    /// Takes the voxels of a later edit of the same scan; reads only the bricks that were changed. Returns a box that
    /// holds all voxels whose value or segment is another.
    ///
    /// # Panics
    /// Where they are those of another scan.
    pub fn follow(&mut self, voxels: Voxels) -> VoxelBox {
        assert_eq!(
            voxels.grid().dimensions(),
            self.voxels.grid().dimensions(),
            "voxels of another scan"
        );
        let changed = changed_bricks(&self.voxels, &voxels);
        let segments = changed_segments(&self.voxels, &voxels);
        let before = std::mem::replace(&mut self.field, field_of(&voxels));
        self.voxels = voxels;
        for voxels in &changed {
            self.ranges.renew(&self.field, voxels.min, voxels.max - 1);
        }
        let whole = self.voxels.grid().bounds();
        changed
            .iter()
            .map(|brick| other_values(&before, &self.field, &brick.intersect(&whole)))
            .fold(segments, |all, voxels| all.union(&voxels))
            .intersect(&whole)
    }

    /// Has tissue stand beside its voxels by all of these together; without any: in them. Returns a box that holds all
    /// voxels that look different by it.
    ///
    /// # Panics
    /// Where there is no node, or not one displacement for each.
    pub fn displace(&mut self, displacements: &[Displacements<'_>]) -> VoxelBox {
        let now = Displaced::new(displacements, self.field.spacing());
        let before = std::mem::replace(&mut self.displaced, now);
        Displaced::differing(before.as_ref(), self.displaced.as_ref())
    }

    /// Takes the surfaces of segments as they are now. Returns a box of voxels that holds all triangles that are others;
    /// none where whole surfaces have come, gone or moved.
    pub fn set_surfaces(&mut self, surfaces: Vec<SegmentSurface>) -> Option<VoxelBox> {
        let before = std::mem::replace(&mut self.surfaces, surfaces);
        let patches = other_patches(&before, &self.surfaces)?;
        let farthest = self.displaced.as_ref().map_or(0.0, Displaced::farthest);
        let grid = self.grid().grid_from_patient();
        let around = |patch: OnePatch<'_>| patch.voxels(&grid).dilate(farthest.ceil() as i32);
        Some(
            patches
                .into_iter()
                .fold(VoxelBox::EMPTY, |all, patch| all.union(&around(patch))),
        )
    }

    /// Shows a second scan through this one, in a mode; none: this one alone.
    pub fn show_second(
        &mut self,
        shown: Option<(Arc<SecondScan>, SecondAppearance)>,
        blend: Blend,
    ) {
        let grid = self.grid();
        self.second = shown.map(|(scan, look)| Box::new(Second::new(scan, &look, grid, blend)));
    }

    /// Where the voxels stand.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        self.voxels.grid()
    }

    /// The voxels that are drawn.
    #[must_use]
    pub fn voxels(&self) -> &Voxels {
        &self.voxels
    }
}

fn field_of(voxels: &Voxels) -> Field {
    let spacing = voxels.grid().spacing().as_vec3();
    Field::new(voxels.intensities(), voxels.overlay(), spacing)
}

/// The bricks whose values were changed by edits.
fn changed_bricks(before: &Voxels, now: &Voxels) -> Vec<VoxelBox> {
    let (before, now) = (before.overlay().bricks(), now.overlay().bricks());
    (0..now.len() as u32)
        .filter(|&index| match (before.get(index), now.get(index)) {
            (Some(one), Some(other)) => !Arc::ptr_eq(one, other),
            (one, other) => one.is_some() != other.is_some(),
        })
        .map(|index| now.box_of(index))
        .collect()
}

/// A box that holds all voxels of a box whose value is another.
fn other_values(before: &Field, now: &Field, voxels: &VoxelBox) -> VoxelBox {
    let others = voxels
        .voxels()
        .filter(|&voxel| before.stored(voxel) != now.stored(voxel));
    others.fold(VoxelBox::EMPTY, |all, voxel| {
        all.union(&VoxelBox::new(voxel, voxel + 1))
    })
}

/// A box that holds all voxels of the scan whose segment is another.
fn changed_segments(before: &Voxels, now: &Voxels) -> VoxelBox {
    let mut changed = VoxelBox::EMPTY;
    let ids: BTreeSet<_> = before
        .segments()
        .chain(now.segments())
        .map(|(id, _)| id)
        .collect();
    for id in ids {
        let part = match (on_scan(before, id), on_scan(now, id)) {
            (Some(one), Some(other)) => one.occupancy().difference(other.occupancy()),
            (Some(only), None) | (None, Some(only)) => {
                only.bounding_box().unwrap_or(VoxelBox::EMPTY)
            }
            (None, None) => VoxelBox::EMPTY,
        };
        changed = changed.union(&part);
    }
    changed
}

/// A segment whose voxels are those of the scan.
fn on_scan(voxels: &Voxels, id: SegmentId) -> Option<&Segment> {
    let segment = voxels.segment(id)?;
    segment.own_grid().is_none().then_some(segment)
}
