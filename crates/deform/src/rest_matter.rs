//! What a voxel is at rest: its matter before a model moved anything.
//!
//! The voxels of a session are the true ones, those that the model itself moved among them. A
//! ledger keeps what these were, so that matter comes back to the bit, and notices where
//! somebody else has changed them since: that counts from then on.

use std::collections::BTreeMap;

use glam::{DVec3, IVec3};
use palpate_volume::matter::{Matter, SegmentSet};
use palpate_volume::voxels::Voxels;

use crate::material::{Materials, Part, SegmentMatter, Solid, Treatment};

/// What a voxel is as the scan and all edits say.
pub fn matter_of(voxels: &Voxels, voxel: IVec3) -> Option<Matter> {
    let stored = voxels.stored(voxel)?;
    let holds = voxels
        .segments()
        .filter(|(_, segment)| segment.contains(voxel));
    Some(Matter {
        stored,
        segments: holds.map(|(id, _)| id).collect::<SegmentSet>(),
    })
}

/// The solid of some matter and how it takes part; none where nothing of it does. The last of
/// the materials that holds it counts.
pub fn solid_of(
    voxels: &Voxels,
    materials: &Materials,
    voxel: IVec3,
    matter: &Matter,
) -> Option<(Solid, Treatment)> {
    let holds = |of: &&SegmentMatter| matter.segments.contains(of.segment);
    let of = materials.segments.iter().rev().find(holds)?;
    let inside = |part: &Part| match part {
        Part::Whole => true,
        Part::Within(region) => region.contains(voxel),
        Part::Shared(other) => matter.segments.contains(*other),
    };
    let treatment = of.treatments.iter().rev().find(|(part, _)| inside(part));
    let treatment = treatment.map_or(Treatment::Deformable, |(_, treatment)| *treatment);
    let value = voxels.intensities().physical(matter.stored);
    (treatment != Treatment::Empty).then(|| (of.law.at(value), treatment))
}

/// A voxel that the model changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Changed {
    /// As it is at rest.
    pub rest: Matter,
    /// As it was before the model's last edit of it.
    pub before: Matter,
    /// As the model wrote it.
    pub written: Matter,
    /// How far the matter that it shows has come from rest [voxels]; none where it shows none.
    pub shown: Option<DVec3>,
}

/// All voxels that the model changed and has not given back, by their place.
#[derive(Clone, Debug, Default)]
pub struct Ledger(pub BTreeMap<[i32; 3], Changed>);

impl Ledger {
    /// What a voxel is at rest. Where somebody else has changed it since, that counts, and the
    /// model's change is forgotten. An edit that is not yet admitted has changed nothing.
    pub fn rest(&mut self, voxels: &Voxels, voxel: IVec3) -> Option<Matter> {
        let now = matter_of(voxels, voxel)?;
        let Some(changed) = self.0.get(&voxel.to_array()) else {
            return Some(now);
        };
        if now == changed.written || now == changed.before {
            return Some(changed.rest);
        }
        self.0.remove(&voxel.to_array());
        Some(now)
    }
}
