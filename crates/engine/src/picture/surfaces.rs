//! The surfaces of the segments that are shown as such, and what changed in the picture since it
//! was last asked for.
//!
//! Updates come from the simulation in order. What an edit changes in voxels and in surfaces goes
//! out together, so that the page shows both in one frame. All updates that wait are taken at once:
//! on a slow machine surfaces follow several edits in one go (thesis 5.2.2).
//! Frame: patient, LPS mm.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::time::SystemTime;

use glam::{DAffine3, DVec3};
use palpate_surface::settings::PATCH_CELLS;
use palpate_surface::{Patch, PatchChange, PatchId};
use palpate_volume::bits::Bits;
use palpate_volume::edit::SegmentId;
use palpate_volume::intensities::Intensities;
use palpate_volume::voxel_box::VoxelBox;

use crate::deformable::Displacements;
use crate::picture::packed_patch::{Lattice, PackedPatch};
use crate::picture::scene_updates::{EditUpdate, SceneUpdate};
use crate::scene::{IncrementalSurface, SegmentVoxels, SurfaceOptions};

/// What changed in the surface of a segment.
#[derive(Clone, Debug, Default)]
pub struct SurfaceChange {
    /// Whether all patches that were told before are to be forgotten.
    pub whole: bool,
    /// Patches that are gone.
    pub dropped: Vec<PatchId>,
    /// Patches that are new or other ones.
    pub patches: Vec<(PatchId, Arc<PackedPatch>)>,
}

/// What changed in the picture at once.
#[derive(Clone, Debug, Default)]
pub struct PictureChange {
    /// The newest edit in it.
    pub edit: u64,
    /// When the oldest one in it was applied; none where there is no edit in it.
    pub applied: Option<SystemTime>,
    /// Boxes of voxels with their stored values and labels.
    pub voxels: Vec<VoxelChange>,
    /// Surfaces, by segment.
    pub surfaces: BTreeMap<SegmentId, SurfaceChange>,
    /// Where tissue stands beside its voxels by now; none where that is as before.
    pub displacements: Option<ShownDisplacements>,
}

/// Where tissue stands beside its voxels: displacements that add up, at most [`MOST_BOXES`] of them; none where all
/// stands in its voxels.
pub type ShownDisplacements = Vec<Arc<Displacements>>;

/// Boxes of displacements: that of what is pressed, and that of the body behind.
pub const MOST_BOXES: usize = 2;

/// The surface of a segment, where it stands.
#[derive(Clone, Debug)]
pub struct ShownSurface {
    /// The segment.
    pub id: SegmentId,
    /// From where its positions are counted, where the scan has it.
    pub origin: DVec3,
    /// Its parts.
    pub patches: Vec<Arc<Patch>>,
    /// From the scan to the scene [mm].
    pub pose: DAffine3,
}

/// New voxels of a box.
#[derive(Clone, Debug)]
pub struct VoxelChange {
    /// The box.
    pub region: VoxelBox,
    /// Stored values, x fastest; none where they stay as they are.
    pub stored: Option<Vec<i16>>,
    /// Numbers of segments, x fastest; none where they stay as they are.
    pub labels: Option<Vec<u8>>,
}

/// A segment that is shown as a surface.
#[derive(Debug)]
struct Shown {
    kept: IncrementalSurface,
    lattice: Lattice,
    packed: BTreeMap<PatchId, Arc<PackedPatch>>,
    change: SurfaceChange,
}

/// All surfaces of a scan.
#[derive(Debug)]
pub struct Surfaces {
    scan: Intensities,
    shown: BTreeMap<SegmentId, Shown>,
    displacements: ShownDisplacements,
    next: PictureChange,
    /// Whether anybody ever asked: else nothing is kept.
    watched: bool,
    changes: VecDeque<PictureChange>,
}

impl Surfaces {
    /// No segment of a scan is shown as a surface.
    #[must_use]
    pub fn new(scan: Intensities) -> Self {
        Self {
            scan,
            shown: BTreeMap::new(),
            displacements: Vec::new(),
            next: PictureChange::default(),
            watched: false,
            changes: VecDeque::new(),
        }
    }

    /// Takes an update; [`Self::follow`] makes what it changes.
    pub fn take(&mut self, updates: SceneUpdate) {
        match updates {
            SceneUpdate::Edit(edit) => self.take_edit(edit),
            SceneUpdate::Segment(id, Some(voxels)) => self.take_segment(id, voxels),
            // undo may bring it back, and it is still to be shown as a surface then
            SceneUpdate::Segment(id, None) => self.empty(id),
            SceneUpdate::Show(id, None) => self.hide(id),
            SceneUpdate::Show(id, Some((options, voxels))) => self.show(id, options, voxels),
            SceneUpdate::Displacements(now) => {
                self.displacements.clone_from(&now);
                self.next.displacements = Some(now);
            }
            SceneUpdate::Together(several) => {
                several.into_iter().for_each(|updates| self.take(updates))
            }
        }
    }

    /// Makes the surfaces follow all updates that were taken.
    pub fn follow(&mut self) {
        for (&id, shown) in &mut self.shown {
            shown.follow(&self.scan);
            let change = std::mem::take(&mut shown.change);
            if !change.is_empty() {
                self.next.surfaces.insert(id, change);
            }
        }
        let change = std::mem::take(&mut self.next);
        if self.watched && !change.is_empty() {
            self.changes.push_back(change);
        }
    }

    /// What changed since the call before, oldest first; the first call begins to watch.
    pub fn changes(&mut self) -> Vec<PictureChange> {
        self.watched = true;
        self.changes.drain(..).collect()
    }

    /// All surfaces as they are, for whoever has seen none of the changes.
    #[must_use]
    pub fn whole(&self) -> PictureChange {
        let made = self
            .shown
            .iter()
            .filter(|(_, shown)| !shown.packed.is_empty());
        let surfaces = made.map(|(&id, shown)| {
            let change = SurfaceChange {
                whole: true,
                dropped: Vec::new(),
                patches: shown.patches(),
            };
            (id, change)
        });
        PictureChange {
            surfaces: surfaces.collect(),
            displacements: Some(self.displacements.clone()),
            ..PictureChange::default()
        }
    }

    /// The surfaces of all segments that are shown; their patches are shared.
    #[must_use]
    pub fn shown(&self) -> Vec<ShownSurface> {
        let shown = self.shown.iter();
        shown
            .map(|(&id, shown)| {
                let surface = shown.kept.surface();
                ShownSurface {
                    id,
                    origin: surface.origin(),
                    patches: surface.patches().map(|(_, patch)| patch.clone()).collect(),
                    pose: DAffine3::IDENTITY,
                }
            })
            .collect()
    }

    /// The surface that is kept of a segment that is shown, where it is made in this way.
    #[must_use]
    pub fn kept(&self, id: SegmentId, options: &SurfaceOptions) -> Option<&IncrementalSurface> {
        let kept = self.shown.get(&id).map(|shown| &shown.kept);
        kept.filter(|kept| kept.options() == options)
    }

    fn take_edit(&mut self, updates: EditUpdate) {
        let EditUpdate {
            edit,
            applied,
            dirty,
            segments,
            stored,
            labels,
        } = updates;
        for (id, mut swaps) in segments {
            let Some(shown) = self.shown.get_mut(&id) else {
                continue;
            };
            shown.kept.swap(&mut swaps, &dirty);
        }
        self.next.edit = edit;
        self.next.applied.get_or_insert(applied);
        if stored.is_some() || labels.is_some() {
            self.next.voxels.push(VoxelChange {
                region: dirty,
                stored,
                labels,
            });
        }
    }

    fn empty(&mut self, id: SegmentId) {
        if let Some(shown) = self.shown.get_mut(&id) {
            let grid = *shown.kept.grid();
            shown.kept.replace(SegmentVoxels {
                bits: Bits::empty(grid.dimensions()),
                made_by: None,
                grid,
            });
        }
    }

    fn take_segment(&mut self, id: SegmentId, voxels: SegmentVoxels) {
        let Some(shown) = self.shown.get_mut(&id) else {
            return;
        };
        if *shown.kept.grid() == voxels.grid {
            shown.kept.replace(voxels);
        } else {
            // another segment under the same number
            let options = *shown.kept.options();
            self.show(id, options, voxels);
        }
    }

    fn show(&mut self, id: SegmentId, options: SurfaceOptions, voxels: SegmentVoxels) {
        let spacing = voxels.grid.spacing();
        let Ok(kept) = IncrementalSurface::new(options, voxels) else {
            // the simulation has refused such settings
            return;
        };
        let edge = f64::from((PATCH_CELLS + 2) * i32::from(options.settings.step));
        let longest = edge * spacing.length();
        let shown = Shown {
            lattice: Lattice::new(kept.surface().origin(), longest),
            kept,
            packed: BTreeMap::new(),
            change: SurfaceChange {
                whole: true,
                ..SurfaceChange::default()
            },
        };
        self.shown.insert(id, shown);
    }

    fn hide(&mut self, id: SegmentId) {
        if self.shown.remove(&id).is_some() {
            let gone = SurfaceChange {
                whole: true,
                ..SurfaceChange::default()
            };
            self.next.surfaces.insert(id, gone);
        }
    }
}

impl Shown {
    fn follow(&mut self, scan: &Intensities) {
        for PatchChange { id, patch } in self.kept.follow(scan) {
            match patch.and_then(|patch| self.lattice.pack(&patch)) {
                Some(packed) => {
                    let packed = Arc::new(packed);
                    self.packed.insert(id, Arc::clone(&packed));
                    self.change.patches.push((id, packed));
                }
                None => {
                    self.packed.remove(&id);
                    self.change.dropped.push(id);
                }
            }
        }
    }

    fn patches(&self) -> Vec<(PatchId, Arc<PackedPatch>)> {
        let shared = |(&id, patch): (&PatchId, &Arc<PackedPatch>)| (id, Arc::clone(patch));
        self.packed.iter().map(shared).collect()
    }
}

impl PictureChange {
    fn is_empty(&self) -> bool {
        self.voxels.is_empty() && self.surfaces.is_empty() && self.displacements.is_none()
    }
}

impl SurfaceChange {
    fn is_empty(&self) -> bool {
        !self.whole && self.dropped.is_empty() && self.patches.is_empty()
    }
}
