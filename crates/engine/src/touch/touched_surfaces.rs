//! What the surface of a solid voxel feels like: that of the segment that owns it.

use palpate_haptics::force::{Surface, Surfaces};
use palpate_haptics::scene::Solid;
use palpate_volume::edit::SegmentId;

use crate::touch::owners::Owners;
use crate::touch::settings::Settings;
use crate::touch::touch_feel::TouchFeels;
use crate::touch::touchable::Touchable;

/// Segments and how they feel.
#[derive(Clone, Copy, Debug)]
pub struct TouchedSurfaces<'a> {
    /// Which segment owns a voxel.
    pub touchable: &'a Touchable,
    /// Who owned the voxels that were asked for last.
    pub owners: &'a Owners,
    /// What holds where a segment has no feel of its own.
    pub settings: &'a Settings,
    /// What segments have of their own; none where it does not count.
    pub feels: Option<&'a TouchFeels>,
}

impl TouchedSurfaces<'_> {
    /// The segment that owns a solid voxel.
    #[must_use]
    pub fn owner(&self, solid: Solid) -> Option<SegmentId> {
        self.owners.of(solid, || self.touchable.owner(solid))
    }
}

impl Surfaces for TouchedSurfaces<'_> {
    fn surface_of(&self, solid: Solid) -> Surface {
        let own = self.feels.and_then(|feels| {
            let owner = self.owner(solid)?;
            Some(feels.of(owner).over(self.settings))
        });
        let felt = own.unwrap_or(*self.settings);
        Surface {
            stiffness: felt.stiffness,
            friction_static: felt.friction_static,
            friction_kinetic: felt.friction_kinetic,
        }
    }
}
