//! The contact model `exact`: traversal, then sliding, by one falling distance.
//!
//! The proxy goes straight toward the device, voxel by voxel, until a solid one stops it;
//! there it takes the point nearest to the device, and slides on to free voxels that are
//! strictly nearer, as long as there are any, each reached face to face through free
//! voxels. Both moves lower the distance from proxy to device [mm], and there are finitely
//! many voxels, so the proxy comes to rest; at rest nothing moves it by a bit.
//!
//! Frame: grid. Source: thesis 4.3 and 4.8 with the corrections of its errata (exact
//! traversal, legal diagonal steps, a strictly falling distance);
//! `docs/decisions/sliding.md` has the measurements.

use crate::contact::bodies::Bodies;
use crate::contact::proxy::Proxy;
use crate::contact::slide::{SLIDE_VISITS, slide};
use crate::contact::voxel_distance::squared_distance;
use crate::contact::{Contact, ContactModel, many_bodies};
use crate::scene::{Solid, TouchScene};
use glam::{DVec3, IVec3};
use palpate_volume::first_solid::{Outcome, first_solid_bounded};
use palpate_volume::occupancy::Occupancy;
use palpate_volume::simd_dispatch;

/// How much work one tick may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExactLimits {
    /// Voxels that straight moves may visit; what is left of the way waits for the next
    /// tick, without a contact.
    pub max_visits: u32,
    /// Slides along the surface (w_max), each of a few voxels.
    pub max_slides: u32,
}

impl Default for ExactLimits {
    fn default() -> Self {
        Self {
            // once along the diagonal of 1024³ voxels
            max_visits: 4096,
            // follows a hand of some 8 voxels a tick, 4 m/s at 0.5 mm and 1 kHz
            max_slides: 8,
        }
    }
}

/// The model: its limits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Exact {
    /// How much work one tick may do.
    pub limits: ExactLimits,
}

impl ContactModel for Exact {
    fn advance<O: Occupancy>(
        &self,
        scene: &TouchScene<'_, O>,
        device_in_grid: DVec3,
        proxy: &mut Proxy,
    ) -> Contact {
        if !scene.objects.is_empty() {
            let bodies = Bodies::near_tick(scene, proxy.point(), device_in_grid);
            if !bodies.is_world_only() {
                return many_bodies::advance(&self.limits, &bodies, device_in_grid, proxy);
            }
        }
        advance_in_world(&self.limits, scene, device_in_grid, proxy)
    }

    fn visit_bound(&self) -> u32 {
        // each straight move reads at least one voxel, even with none left to visit
        let moves = self.limits.max_slides.saturating_add(1);
        let slides = self.limits.max_slides.saturating_mul(SLIDE_VISITS);
        let in_world = self
            .limits
            .max_visits
            .saturating_add(moves)
            .saturating_add(slides);
        in_world.max(many_bodies::visit_bound(&self.limits))
    }
}

simd_dispatch! {
    /// One update where the world is the only body.
    fn advance_in_world[O: Occupancy](
        limits: &ExactLimits,
        scene: &TouchScene<'_, O>,
        device_in_grid: DVec3,
        proxy: &mut Proxy,
    ) -> Contact = [avx2] ExactLimits::advance_plainly
}

impl ExactLimits {
    #[inline(always)]
    fn advance_plainly<O: Occupancy>(
        &self,
        scene: &TouchScene<'_, O>,
        device_in_grid: DVec3,
        proxy: &mut Proxy,
    ) -> Contact {
        let TouchScene {
            occupancy, grid, ..
        } = *scene;
        let mut contact = Contact::default();
        let mut visits_left = self.max_visits;
        loop {
            // straight toward the device; the traversal always reads one voxel
            let start = proxy.point();
            let traversal = first_solid_bounded(occupancy, start, device_in_grid, visits_left);
            visits_left = visits_left.saturating_sub(traversal.visits);
            contact.visits += traversal.visits;
            match traversal.outcome {
                Outcome::Free => {
                    *proxy = Proxy::at(device_in_grid).unwrap_or(*proxy);
                    return free(contact);
                }
                Outcome::OutOfVisits { voxel, .. } => {
                    *proxy = Proxy::nearest_in(voxel, device_in_grid);
                    return free(contact);
                }
                Outcome::NotTraversable => return free(contact),
                Outcome::Hit(hit) if hit.starts_inside() => {
                    contact.violation = true;
                    return free(contact);
                }
                Outcome::Hit(hit) => {
                    let [from, to] = [proxy.voxel(), hit.last_free];
                    let voxel = nearer_of(from, to, device_in_grid, grid.spacing());
                    *proxy = Proxy::nearest_in(voxel, device_in_grid);
                    contact.stopped_by = Some(Solid::of_world(hit.voxel));
                    contact.touching = true;
                }
            }

            // then along the surface, to where the device is strictly nearer
            if contact.slides == self.max_slides {
                return contact;
            }
            contact.visits += SLIDE_VISITS;
            let Some(voxel) = slide(occupancy, grid.spacing(), device_in_grid, proxy.voxel())
            else {
                return contact;
            };
            *proxy = Proxy::nearest_in(voxel, device_in_grid);
            contact.slides += 1;
        }
    }
}

/// The voxel where a straight move ends: `to`, unless it only cuts a corner of it, where the
/// skin of a voxel can put the proxy some 1e-8 voxel further from the device than before.
fn nearer_of(from: IVec3, to: IVec3, device: DVec3, spacing: DVec3) -> IVec3 {
    let [here, there] = [from, to].map(|voxel| squared_distance(voxel, device, spacing));
    if there < here { to } else { from }
}

/// A contact model's answer where nothing holds the proxy back.
fn free(contact: Contact) -> Contact {
    Contact {
        touching: false,
        stopped_by: None,
        ..contact
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Noise;
    use glam::{DMat3, UVec3};
    use palpate_volume::grid::Grid;

    #[test]
    fn moves_for_wide_machines_are_those_for_plain_ones_to_the_bit() {
        let mut random = oorandom::Rand64::new(11);
        let spacing = DVec3::new(0.7, 0.7, 2.5);
        let grid =
            Grid::new(UVec3::splat(64), spacing, DVec3::ZERO, DMat3::IDENTITY).expect("a grid");
        let limits = ExactLimits::default();
        let mut slides = 0;
        for run in 0..300 {
            let world = Noise {
                density: 5 + run % 50,
            };
            let scene = TouchScene::of_world(&world, &grid);
            let mut point = || DVec3::from_array([(); 3].map(|()| 40.0 * random.rand_float()));
            let start = point();
            if world.is_solid(start.floor().as_ivec3()) {
                continue;
            }
            let [mut wide, mut plain] = [Proxy::at(start).expect("a place"); 2];
            for _ in 0..20 {
                let device = point();
                let contact = advance_in_world(&limits, &scene, device, &mut wide);
                let plainly = limits.advance_plainly(&scene, device, &mut plain);
                assert_eq!((contact, wide), (plainly, plain));
                slides += contact.slides;
            }
        }
        assert!(slides > 1000, "{slides} slides");
    }
}
