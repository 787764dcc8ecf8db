//! Voxels without what tools press: what files, journal and undo hold while soft tissue is moved.

use std::collections::BTreeMap;

use glam::IVec3;
use palpate_deform::at_rest::AtRest;
use palpate_volume::edit::Edit;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxel_state::VoxelState;
use palpate_volume::voxels::Voxels;

/// Voxels as they are at rest. While nothing is moved they are the true ones.
#[derive(Debug, Default)]
pub struct Unpressed {
    /// None while nothing is moved.
    voxels: Option<Voxels>,
    known: AtRest,
}

/// What the voxels of a box were before a change.
#[derive(Debug)]
pub struct Before {
    region: VoxelBox,
    states: Vec<Option<VoxelState>>,
}

impl Unpressed {
    /// The voxels at rest, where these are the true ones.
    #[must_use]
    pub fn voxels<'a>(&'a self, now: &'a Voxels) -> &'a Voxels {
        self.voxels.as_ref().unwrap_or(now)
    }

    /// Whether anything is moved.
    #[must_use]
    pub fn is_moved(&self) -> bool {
        self.voxels.is_some()
    }

    /// A box around all that is moved; empty while nothing is.
    #[must_use]
    pub fn moved(&self) -> VoxelBox {
        box_around(self.known.voxels())
    }

    /// To be called before a model first changes the true voxels.
    pub fn begin(&mut self, now: &Voxels) {
        self.voxels.get_or_insert_with(|| now.clone());
    }

    /// Takes from a model what its moved voxels are at rest, its edit applied to the true ones. Gives
    /// the inverse of what stays of it, such as tissue that has yielded; none where nothing does.
    pub fn follow_model(&mut self, at_rest: AtRest, now: &Voxels) -> Option<Edit> {
        let voxels = self.voxels.as_mut()?;
        let changes = at_rest.changes_since(&self.known).into_iter();
        let changes = changes.filter_map(|(voxel, state)| {
            let state = state.or_else(|| now.state(voxel))?;
            (voxels.state(voxel) != Some(state)).then_some((voxel, state))
        });
        let changes: Vec<_> = changes.collect();
        let inverse = change(voxels, &changes);
        self.known = at_rest;
        if self.known.is_empty() {
            self.voxels = None;
        }
        inverse
    }

    /// What the voxels of a box are before somebody else changes them; none while nothing is moved.
    #[must_use]
    pub fn before(&self, region: VoxelBox, now: &Voxels) -> Option<Before> {
        let region = region.intersect(&now.grid().bounds());
        self.voxels.as_ref().map(|_| Before {
            region,
            states: region.voxels().map(|voxel| now.state(voxel)).collect(),
        })
    }

    /// Follows what somebody else than the model has changed, and gives its inverse at rest; none
    /// where that is no change.
    pub fn follow_edit(&mut self, before: &Before, now: &Voxels) -> Option<Edit> {
        let voxels = self.voxels.as_mut()?;
        let changes = before.region.voxels().zip(&before.states);
        let changes = changes.filter_map(|(voxel, was)| {
            let state = now.state(voxel).filter(|state| Some(*state) != *was)?;
            Some((voxel, state))
        });
        let changes: Vec<_> = changes.collect();
        change(voxels, &changes)
    }

    /// The edit by which the true voxels come to rest, none where they are; nothing is known to be
    /// moved after it.
    pub fn release(&mut self, now: &Voxels) -> Option<Edit> {
        let voxels = self.voxels.take()?;
        let moved = std::mem::take(&mut self.known);
        let states = moved.voxels().filter_map(|voxel| {
            let state = voxels.state(voxel)?;
            Some((voxel, state))
        });
        let states: Vec<_> = states.collect();
        Some(edit_of(now, &states)).filter(|edit| !edit.is_empty())
    }
}

/// Gives voxels these states; the inverse, or none where they have them.
fn change(voxels: &mut Voxels, states: &[(IVec3, VoxelState)]) -> Option<Edit> {
    let edit = edit_of(voxels, states);
    if edit.is_empty() {
        return None;
    }
    // it was built from these voxels
    voxels.apply(edit).ok()
}

fn edit_of(voxels: &Voxels, states: &[(IVec3, VoxelState)]) -> Edit {
    let region = box_around(states.iter().map(|(voxel, _)| *voxel));
    let states: BTreeMap<_, _> = states
        .iter()
        .map(|(voxel, state)| (voxel.to_array(), *state))
        .collect();
    voxels.voxel_edit(&region, |voxel, was| {
        states.get(&voxel.to_array()).copied().unwrap_or(was)
    })
}

fn box_around(voxels: impl Iterator<Item = IVec3>) -> VoxelBox {
    voxels.fold(VoxelBox::EMPTY, |all, voxel| {
        all.union(&VoxelBox::of_voxel(voxel))
    })
}
