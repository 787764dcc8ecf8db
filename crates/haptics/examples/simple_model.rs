//! A contact model in a few lines: a hard stop, without sliding.
//!
//! Frame: the world's grid. `docs/extend/adding-a-contact-model.md` shows this file.

use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_haptics::contact::{Contact, ContactModel, Proxy};
use palpate_haptics::scene::{Solid, TouchScene};
use palpate_volume::first_solid::{Outcome, first_solid_bounded};
use palpate_volume::{grid::Grid, occupancy::Occupancy, segment::Segment};

/// Goes straight toward the device, and stays in the last free voxel before a solid one.
pub struct HardStop;

impl ContactModel for HardStop {
    fn advance<O: Occupancy>(
        &self,
        scene: &TouchScene<'_, O>,
        device: DVec3,
        proxy: &mut Proxy,
    ) -> Contact {
        // every voxel on the way is read, so that no wall is missed
        let most = self.visit_bound();
        let way = first_solid_bounded(scene.occupancy, proxy.point(), device, most);
        let mut contact = Contact {
            visits: way.visits,
            ..Contact::default()
        };
        match way.outcome {
            Outcome::Free => *proxy = Proxy::at(device).unwrap_or(*proxy),
            Outcome::OutOfVisits { voxel, .. } => *proxy = Proxy::nearest_in(voxel, device),
            Outcome::NotTraversable => {}
            Outcome::Hit(hit) if hit.starts_inside() => contact.violation = true,
            Outcome::Hit(hit) => {
                *proxy = Proxy::nearest_in(hit.last_free, device);
                contact.touching = true;
                contact.stopped_by = Some(Solid::of_world(hit.voxel));
            }
        }
        contact
    }

    fn visit_bound(&self) -> u32 {
        4096
    }
}

/// Presses 2 mm deep on a block of 8×8×4 voxels of 1 mm.
pub fn main() {
    let size = UVec3::new(8, 8, 4);
    let block = Segment::from_mask(size, &[1; 8 * 8 * 4]).expect("one byte per voxel");
    let grid = Grid::new(size, DVec3::ONE, DVec3::ZERO, DMat3::IDENTITY).expect("a grid");
    let mut proxy = Proxy::at(DVec3::new(4.5, 4.5, 9.0)).expect("a finite point");
    let scene = TouchScene::of_world(&block, &grid);
    let contact = HardStop.advance(&scene, DVec3::new(4.5, 4.5, 2.0), &mut proxy);
    let stop = Solid::of_world(IVec3::new(4, 4, 3));
    assert_eq!(contact.stopped_by, Some(stop));
    assert!((proxy.point().z - 4.0).abs() < 1e-6);
}
