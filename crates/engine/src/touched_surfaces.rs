//! What the surface of a solid voxel feels like: that of the segment that owns it.

use palpate_haptics::scene::Solid;
use palpate_haptics::surface::{Surface, Surfaces};

use crate::feel::Feels;
use crate::settings::Settings;
use crate::touchable::Touchable;

/// Segments and how they feel.
#[derive(Clone, Copy, Debug)]
pub struct TouchedSurfaces<'a> {
    /// Which segment owns a voxel.
    pub touchable: &'a Touchable,
    /// What holds where a segment has no feel of its own.
    pub settings: &'a Settings,
    /// What segments have of their own.
    pub feels: &'a Feels,
}

impl Surfaces for TouchedSurfaces<'_> {
    fn surface_of(&self, solid: Solid) -> Surface {
        let owner = self.touchable.owner(solid.body, solid.voxel);
        let felt = match owner {
            Some(id) => self.feels.of(id).over(self.settings),
            None => *self.settings,
        };
        Surface {
            stiffness: felt.stiffness,
            friction_static: felt.friction_static,
            friction_kinetic: felt.friction_kinetic,
            range: None,
        }
    }
}
