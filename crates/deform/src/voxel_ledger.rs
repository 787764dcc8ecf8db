//! What a voxel is at rest: its tissue before a model moved anything.
//!
//! The voxels of a session are the true ones, those that the model itself moved among them. A
//! ledger keeps what these were, so that tissue comes back to the bit, and notices where
//! somebody else has changed them since: that counts from then on.

use std::collections::BTreeMap;

use glam::{DVec3, IVec3};
use palpate_volume::edit::Edit;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxel_state::VoxelState;
use palpate_volume::voxels::Voxels;

use crate::at_rest::AtRest;
use crate::material::{Materials, Region, SegmentMaterial, Solid, Treatment};

/// Voxels along a side of what one edit covers, at most: it looks at each in between.
const WIDEST: u32 = 128;

/// The solid of some tissue and how it takes part; none where nothing of it does. The last of
/// the materials that holds it counts.
pub fn solid_of(
    voxels: &Voxels,
    materials: &Materials,
    voxel: IVec3,
    matter: &VoxelState,
) -> Option<(Solid, Treatment)> {
    let holds = |of: &&SegmentMaterial| matter.segments.contains(of.segment);
    let of = materials.segments.iter().rev().find(holds)?;
    let inside = |region: &Region| match region {
        Region::Whole => true,
        Region::Within(box_of_voxels) => box_of_voxels.contains(voxel),
        Region::Shared(other) => matter.segments.contains(*other),
        Region::CutAway(mask) => mask.cuts(voxel),
    };
    let treatment = of.regions.iter().rev().find(|(region, _)| inside(region));
    let treatment = treatment.map_or(Treatment::Deformable, |(_, treatment)| *treatment);
    let value = voxels.intensities().physical(matter.stored);
    (treatment != Treatment::Empty).then(|| (of.law.at(value), treatment))
}

/// A voxel that the model changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Changed {
    /// State at rest.
    pub rest: VoxelState,
    /// State before the model's last edit of it.
    pub before: VoxelState,
    /// State that the model wrote.
    pub written: VoxelState,
    /// How far the tissue that it shows has come from rest [voxels]; none where it shows none.
    pub shown: Option<DVec3>,
}

impl Changed {
    /// Whether the voxel is as the model knows it. An edit that is not yet admitted has changed
    /// nothing.
    fn explains(&self, now: &VoxelState) -> bool {
        *now == self.written || *now == self.before
    }
}

/// What a voxel is to be, and how far the tissue that it then shows has come from rest
/// [voxels]; none where it shows none.
pub type Wanted = BTreeMap<[i32; 3], (VoxelState, Option<DVec3>)>;

/// All voxels that the model changed and has not given back, by their place.
#[derive(Clone, Debug, Default)]
pub struct Ledger {
    changed: BTreeMap<[i32; 3], Changed>,
    /// Those of them that stay displaced although no tool presses them (plastic set), as they are then.
    plastic: BTreeMap<[i32; 3], VoxelState>,
    last: Option<(IVec3, VoxelState)>,
    /// All voxels of the last edit, until it is known whether it was taken.
    unsettled: Vec<[i32; 3]>,
}

impl Ledger {
    /// What the model changed of a voxel.
    pub fn changed(&self, voxel: IVec3) -> Option<&Changed> {
        self.changed.get(&voxel.to_array())
    }

    /// A box around all of them.
    pub fn bounds(&self) -> VoxelBox {
        let voxels = self.changed.keys().map(|key| IVec3::from_array(*key));
        voxels.fold(VoxelBox::EMPTY, |all, voxel| {
            all.union(&VoxelBox::of_voxel(voxel))
        })
    }

    /// Voxels that are not as at rest.
    pub fn len(&self) -> usize {
        self.changed.len()
    }

    /// Number of voxels with plastic set.
    pub fn plastic_len(&self) -> usize {
        self.plastic.len()
    }

    /// Notes that what the voxels of a region show stays, as no tool presses it.
    pub fn note_plastic(&mut self, region: &VoxelBox) {
        self.plastic
            .retain(|key, _| !region.contains(IVec3::from_array(*key)));
        let stays = |(key, changed): &(&[i32; 3], &Changed)| {
            region.contains(IVec3::from_array(**key)) && changed.written != changed.rest
        };
        let stay = self.changed.iter().filter(stays);
        self.plastic
            .extend(stay.map(|(key, changed)| (*key, changed.written)));
    }

    /// What the voxels that the model changed are without a tool: as at rest, or as they stay where
    /// their tissue has yielded.
    pub fn at_rest(&self) -> AtRest {
        let without = |(key, changed): (&[i32; 3], &Changed)| {
            let lasting = self.plastic.get(key);
            (*key, lasting.copied().unwrap_or(changed.rest))
        };
        AtRest(self.changed.iter().map(without).collect())
    }

    /// Notes that what the voxels show stays which a box leaves. Some of them become what is
    /// wanted, which may be what they are at rest; the others stay as they are.
    pub fn note_left(&mut self, voxels: &Voxels, left: impl Fn(IVec3) -> bool, wanted: &Wanted) {
        let in_left = |key: &[i32; 3]| left(IVec3::from_array(*key));
        self.plastic.retain(|key, _| !in_left(key));
        let keys = self.changed.keys().chain(wanted.keys());
        let stays = |key: &&[i32; 3]| {
            let rest = self.rest(voxels, IVec3::from_array(**key));
            let to_be = wanted.get(*key).map(|(matter, _)| *matter);
            in_left(key) && to_be.is_none_or(|to_be| rest != Some(to_be))
        };
        let lasting = |key: &[i32; 3]| {
            let to_be = wanted.get(key).map(|(matter, _)| *matter);
            to_be.or_else(|| voxels.state(IVec3::from_array(*key)))
        };
        let stay = keys.filter(stays);
        let stay: Vec<_> = stay.filter_map(|key| Some((*key, lasting(key)?))).collect();
        self.plastic.extend(stay);
    }

    /// From now on voxels that stay as they are count as they are, as any other edit does.
    pub fn settle_plastic(&mut self) {
        for key in std::mem::take(&mut self.plastic).keys() {
            self.changed.remove(key);
        }
    }

    /// From now on all voxels count as they are, as any other edit does.
    pub fn settle(&mut self) {
        self.plastic.clear();
        self.changed.clear();
        self.unsettled.clear();
    }

    /// One of the voxels that the last edit changes, and what to; none where there was no edit.
    pub fn last_written(&self) -> Option<(IVec3, VoxelState)> {
        self.last
    }

    /// What a voxel is at rest. Where somebody else has changed it since, that counts.
    pub fn rest(&self, voxels: &Voxels, voxel: IVec3) -> Option<VoxelState> {
        let now = voxels.state(voxel)?;
        let changed = self.changed(voxel).filter(|changed| changed.explains(&now));
        Some(changed.map_or(now, |changed| changed.rest))
    }

    /// Once the last edit was taken, what voxels were before it explains them no more: what became so
    /// since was cut.
    fn settle_last(&mut self, voxels: &Voxels) {
        let last = std::mem::take(&mut self.unsettled);
        let shows_it = |key: &[i32; 3]| {
            let changed = self.changed.get(key);
            changed.is_some_and(|changed| {
                voxels.state(IVec3::from_array(*key)) == Some(changed.written)
            })
        };
        if !last.iter().any(shows_it) {
            return;
        }
        for key in last {
            if let Some(changed) = self.changed.get_mut(&key) {
                changed.before = changed.written;
            }
        }
    }

    /// Forgets what somebody else has changed since, and tells it: where, what the model had
    /// made of it, and what it is now.
    pub fn take_overruled(&mut self, voxels: &Voxels) -> Vec<(IVec3, Changed, VoxelState)> {
        self.settle_last(voxels);
        let mut overruled = Vec::new();
        self.changed.retain(|key, changed| {
            let voxel = IVec3::from_array(*key);
            let now = voxels.state(voxel);
            let stays = now.is_none_or(|now| changed.explains(&now));
            if let (false, Some(now)) = (stays, now) {
                overruled.push((voxel, *changed, now));
            }
            stays
        });
        overruled
    }

    /// Follows what somebody else has changed since. Tissue that was cut where it stands is gone
    /// where it was at rest, and what stood here at rest stays elsewhere. Whatever else was put
    /// into a voxel counts from now on.
    pub fn follow_cuts(&mut self, voxels: &Voxels) {
        for (voxel, mut changed, now) in self.take_overruled(voxels) {
            let lasts = self.plastic.remove(&voxel.to_array()).is_some();
            if now == changed.rest || !now.segments.is_empty() {
                continue;
            }
            let from = changed.shown.map(|come| voxel - come.round().as_ivec3());
            (changed.before, changed.written, changed.shown) = (now, now, None);
            if from != Some(voxel) {
                self.changed.insert(voxel.to_array(), changed);
                self.plastic.extend(lasts.then(|| (voxel.to_array(), now)));
            }
            if let Some(from) = from.filter(|from| *from != voxel) {
                self.change_rest(voxels, from, now);
                self.plastic.extend(lasts.then(|| (from.to_array(), now)));
            }
        }
    }

    /// Has a voxel be something else at rest than it was; the next edit shows it.
    fn change_rest(&mut self, voxels: &Voxels, voxel: IVec3, rest: VoxelState) {
        let Some(now) = voxels.state(voxel) else {
            return;
        };
        let as_it_is = Changed {
            rest,
            before: now,
            written: now,
            shown: Some(DVec3::ZERO),
        };
        let changed = self.changed.entry(voxel.to_array());
        changed.or_insert(as_it_is).rest = rest;
    }

    /// All that was changed outside a region is to be as at rest, but for what stays.
    pub fn give_back_outside(&self, voxels: &Voxels, region: &VoxelBox, wanted: &mut Wanted) {
        for key in self.changed.keys() {
            let voxel = IVec3::from_array(*key);
            if region.contains(voxel) || self.plastic.contains_key(key) {
                continue;
            }
            if let Some(rest) = self.rest(voxels, voxel) {
                wanted.insert(*key, (rest, Some(DVec3::ZERO)));
            }
        }
    }

    /// The edit by which voxels become what is wanted, remembered; none where they are. What
    /// lies too far from the rest for one edit waits for the next.
    pub fn write(&mut self, voxels: &Voxels, wanted: &Wanted) -> Option<Edit> {
        self.settle_last(voxels);
        let mut region = VoxelBox::EMPTY;
        self.last = None;
        for (&key, &(matter, shown)) in wanted {
            let voxel = IVec3::from_array(key);
            let (Some(rest), Some(before)) = (self.rest(voxels, voxel), voxels.state(voxel)) else {
                continue;
            };
            if matter == before {
                if matter == rest {
                    self.changed.remove(&key);
                    self.plastic.remove(&key);
                }
                continue;
            }
            let grown = region.union(&VoxelBox::of_voxel(voxel));
            if grown.size().max_element() > WIDEST {
                continue;
            }
            region = grown;
            let written = matter;
            self.last = Some((voxel, written));
            self.unsettled.push(key);
            self.changed.insert(
                key,
                Changed {
                    rest,
                    before,
                    written,
                    shown,
                },
            );
        }
        let edit = voxels.voxel_edit(&region, |voxel, was| {
            let here = wanted.get(&voxel.to_array());
            here.map_or(was, |(matter, _)| *matter)
        });
        (!edit.is_empty()).then_some(edit)
    }
}
