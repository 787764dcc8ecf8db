//! What voxels are without the tools that press them.

use std::cmp::Ordering;

use glam::IVec3;
use palpate_volume::voxel_state::VoxelState;

/// Voxels that a model has moved, each with what it is without a tool, by rising place.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AtRest(pub(crate) Vec<([i32; 3], VoxelState)>);

impl AtRest {
    /// Whether nothing is moved.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The voxels.
    pub fn voxels(&self) -> impl Iterator<Item = IVec3> {
        self.0.iter().map(|(place, _)| IVec3::from_array(*place))
    }

    /// The voxels for which this differs from what was known before, and what they are without a
    /// tool now; none where they are moved no more.
    #[must_use]
    pub fn changes_since(&self, before: &Self) -> Vec<(IVec3, Option<VoxelState>)> {
        let (mut old, mut new) = (before.0.iter().peekable(), self.0.iter().peekable());
        let mut changes = Vec::new();
        loop {
            let order = match (old.peek(), new.peek()) {
                (None, None) => return changes,
                (Some(_), None) => Ordering::Less,
                (None, Some(_)) => Ordering::Greater,
                (Some((was, _)), Some((is, _))) => was.cmp(is),
            };
            let was = old.next_if(|_| order.is_le());
            let is = new.next_if(|_| order.is_ge());
            if let Some((place, _)) = is.or(was).filter(|_| was != is) {
                changes.push((IVec3::from_array(*place), is.map(|(_, state)| *state)));
            }
        }
    }
}
