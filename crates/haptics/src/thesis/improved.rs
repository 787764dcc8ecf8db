//! The contact model `thesis-improved`, as printed: the baseline of comparisons, never a
//! default.
//!
//! It samples straight moves one voxel apart, then slides to the empty-space border voxel
//! nearest to the device. What it gets wrong, by the errata of the thesis (w_max 5, ε 0.1,
//! moves of 0.3 to 1 voxel a frame):
//! - it goes through walls: sampling misses 35 % of head-on rays through the thinnest wall
//!   (1, 1, 0), and slides pass diagonally between two solid voxels, so that thin walls
//!   askew to the grid are crossed in 98 to 100 % of runs, half of them within 20 frames;
//! - it does not rest: nothing asks whether the nearest neighbour is nearer than p2 itself,
//!   so every frame walks to and fro until w_max is spent; with the device at rest on a flat
//!   floor the proxy jitters by 0.51 voxels (0.83 with w_max 7.3, 0 with 10, by parity);
//! - so the proxy can stand in a solid voxel (`Contact::violation`).
//!
//! `exact` is the corrected form. Bounds: `path.rs`.
//! Objects count where they cover the middle of a voxel of the world.
//!
//! Frame: grid, in voxels. Source: R. Vlasov, thesis (2016), listing of 4.8.

use crate::contact::{Contact, ContactModel, ForceInput, Proxy};
use crate::scene::TouchScene;
use crate::thesis::border_voxels::border_voxels;
use crate::thesis::force::force_improved;
use crate::thesis::path::{Listing, ThesisLimits, ThesisPath, middle};
use glam::{DVec3, IVec3};
use palpate_volume::occupancy::Occupancy;

/// The model: its limits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ThesisImproved {
    /// w_max and ε.
    pub limits: ThesisLimits,
}

impl ContactModel for ThesisImproved {
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
        Some(force_improved(input))
    }
}

impl Listing for ThesisImproved {
    fn run<O: Occupancy>(
        &self,
        occupancy: &O,
        device_in_grid: DVec3,
        proxy: &mut Proxy,
    ) -> Contact {
        // lines 1 to 4
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
            // line 17
            while path.may_slide() {
                // lines 18 to 24
                if path.is_free_ahead() {
                    break;
                }
                // lines 25 to 30
                path.count_search();
                let Some(voxel) = nearest(device_in_grid, occupancy, path.voxel()) else {
                    break;
                };
                // lines 31 to 36
                if !path.slide_to(voxel) {
                    break;
                }
            }
        }
        path.finish(proxy)
    }
}

/// The border voxel with the smallest squared distance from its middle to d2.
fn nearest(device: DVec3, occupancy: &(impl Occupancy + ?Sized), voxel: IVec3) -> Option<IVec3> {
    border_voxels(occupancy, voxel)
        .map(|voxel| (voxel, middle(voxel).distance_squared(device)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(voxel, _)| voxel)
}
