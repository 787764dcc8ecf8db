//! A whole scene as voxels of the world, for models that know one grid only.
//!
//! A voxel is solid where it is solid in the world, or where its middle is in a solid voxel of an
//! object. Walls of objects thinner than the world's voxels get holes, so nothing is promised:
//! this is for the thesis' models. Frame: the world's grid.

use crate::contact::Contact;
use crate::scene::{MAX_OBJECTS, Object, Solid, TouchScene};
use glam::IVec3;
use palpate_volume::occupancy::Occupancy;

/// The scene, voxel by voxel of the world.
#[derive(Debug)]
pub struct VoxelisedScene<'a, O>(pub TouchScene<'a, O>);

impl<O: Occupancy> VoxelisedScene<'_, O> {
    /// What makes a voxel of the world solid.
    pub fn owner(&self, voxel: IVec3) -> Option<Solid> {
        if self.0.occupancy.is_solid(voxel) {
            return Some(Solid::of_world(voxel));
        }
        let middle = voxel.as_dvec3() + 0.5;
        let solid = |(body, object): (u8, &Object<O>)| {
            let voxel = object.solid_at(middle)?;
            Some(Solid { body, voxel })
        };
        let objects = self.0.objects.iter().take(MAX_OBJECTS);
        (1..).zip(objects).find_map(solid)
    }

    /// A contact with a voxel of the world as one with the body that makes it solid.
    pub(crate) fn owned(&self, contact: Contact) -> Contact {
        let owner = |solid: Solid| self.owner(solid.voxel).unwrap_or(solid);
        Contact {
            stopped_by: contact.stopped_by.map(owner),
            ..contact
        }
    }
}

impl<O: Occupancy> Occupancy for VoxelisedScene<'_, O> {
    fn is_solid(&self, voxel: IVec3) -> bool {
        self.owner(voxel).is_some()
    }
}
