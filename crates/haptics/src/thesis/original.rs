//! The contact model `thesis-original`, as printed: a baseline, never a default.
//!
//! It samples straight moves one voxel apart, then slides to the empty-space border voxel
//! with the largest dot product along d2 − p1. What it gets wrong, by the errata of the
//! thesis (w_max 5, ε 0.1, moves of 0.3 to 1 voxel a frame):
//! - it goes through walls: sampling misses 35 % of head-on rays through the thinnest wall
//!   (1, 1, 0), and slides pass diagonally between two solid voxels, so that thin walls
//!   askew to the grid are crossed in 98 to 100 % of runs, half of them within 20 frames;
//! - it does not rest: the direction is fixed in a frame, so the proxy passes the foot point
//!   and comes back, by 4.8 voxels on a stair of 45°;
//! - so the proxy can stand in a solid voxel (`Contact::violation`).
//!
//! The text of step 3b says d2 − p2 instead; the listing is followed. The point p3 of 4.4,
//! whose direction is unclear, is left out: it adds candidates, which helps against sticking
//! and not against any of these. Bounds: `path.rs`.
//! Objects count where they cover the middle of a voxel of the world.
//!
//! Frame: grid, in voxels. Source: R. Vlasov, thesis (2016), listing of 4.3.

use crate::contact::{Contact, ContactModel, ForceInput, Proxy};
use crate::scene::TouchScene;
use crate::thesis::border_voxels::border_voxels;
use crate::thesis::force::force_original;
use crate::thesis::path::{Listing, ThesisLimits, ThesisPath, middle};
use glam::{DVec3, IVec3};
use palpate_volume::occupancy::Occupancy;

/// The model: its limits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ThesisOriginal {
    /// w_max and ε.
    pub limits: ThesisLimits,
}

impl ContactModel for ThesisOriginal {
    fn advance<O: Occupancy>(
        &self,
        scene: &TouchScene<'_, O>,
        device_in_grid: DVec3,
        proxy: &mut Proxy,
    ) -> Contact {
        self.run_in_scene(scene, device_in_grid, proxy)
    }

    fn visit_bound(&self) -> u32 {
        self.limits.visit_bound()
    }

    fn has_own_force(&self) -> bool {
        true
    }

    fn own_force(&self, input: &ForceInput<'_>) -> Option<DVec3> {
        Some(force_original(input))
    }
}

impl Listing for ThesisOriginal {
    fn run<O: Occupancy>(
        &self,
        occupancy: &O,
        device_in_grid: DVec3,
        proxy: &mut Proxy,
    ) -> Contact {
        // lines 1 to 4
        let aim = device_in_grid - proxy.point();
        let Some(mut path) = ThesisPath::start(occupancy, self.limits, device_in_grid, proxy)
        else {
            return Contact::default();
        };
        // lines 5 and 6
        while path.begin_round() {
            // lines 7 to 14
            if !path.move_straight() {
                break;
            }
            // line 16
            while path.may_slide() {
                // lines 17 to 23
                if path.is_free_ahead() {
                    break;
                }
                // lines 24 to 28
                path.count_search();
                let Some(voxel) = farthest_along(aim, occupancy, &path) else {
                    break;
                };
                // lines 29 to 34
                if !path.slide_to(voxel) {
                    break;
                }
            }
        }
        path.finish(proxy)
    }
}

/// The border voxel with the largest dot product of voxel − p2 and d2 − p1, if positive.
fn farthest_along<O: Occupancy + ?Sized>(
    aim: DVec3,
    occupancy: &O,
    path: &ThesisPath<'_, O>,
) -> Option<IVec3> {
    let along = |voxel: IVec3| (middle(voxel) - path.point()).dot(aim);
    border_voxels(occupancy, path.voxel())
        .map(|voxel| (voxel, along(voxel)))
        .filter(|(_, along)| *along > 0.0)
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(voxel, _)| voxel)
}
