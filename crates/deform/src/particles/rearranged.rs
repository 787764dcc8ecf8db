//! Particles that stay where a tool has pushed them: material that is rearranged, not removed.
//!
//! - As many voxels of the box are solid as were at rest: those in which most particles stand. So a voxel
//!   that clears under the tool is one that fills at the rim.
//! - Once no tool touches them and they have come to rest, what the voxels show stays.
//! - The box stands still while the tool works in its middle. Where it must go on, all voxels count as they
//!   are, and particles are taken anew from them: stress that was in them is lost, matter is not.
//!
//! Source: thesis 5.28.3, which rearranges voxels; it does not say by which rule.

use glam::IVec3;
use palpate_volume::edit::Edit;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;

use super::local_model::LocalLaw;
use super::local_state::LocalState;
use super::state::Particles;
use super::tool_push::ToolForce;
use super::write_back::{Standing, WriteBack, gather};
use crate::voxel_ledger::{Ledger, Wanted};

/// A voxel that is solid stays so although another one holds as many more of its particles as this: else
/// voxels would flicker.
const STAYS_BY: f64 = 0.3;
/// Of the inner half of the box, in which the tool may go before the box follows.
const INNER: f64 = 0.5;
/// Unbalanced force at which particles without a tool are at rest [of the smallest contact force].
const AT_REST: f64 = 0.02;

impl WriteBack {
    /// The edit that makes as many voxels of `region` solid as were at rest, those in which most particles
    /// stand; none where nothing changes.
    pub fn edit_rearranged(
        &self,
        voxels: &Voxels,
        particles: &Particles,
        region: &VoxelBox,
        ledger: &mut Ledger,
    ) -> Option<Edit> {
        let standing = gather(voxels, particles, region);
        let moved = region.voxels().zip(&standing).filter(|(voxel, standing)| {
            !standing.is_as_at_rest() || ledger.changed(*voxel).is_some()
        });
        let mut ranked: Vec<(f64, IVec3, &Standing)> = Vec::new();
        let mut count = 0;
        for (voxel, standing) in moved {
            let (Some(rest), Some(now)) = (ledger.rest(voxels, voxel), voxels.state(voxel)) else {
                continue;
            };
            // tissue that takes no part is never overwritten
            if standing.at_rest == 0 && !rest.segments.is_empty() {
                continue;
            }
            count += usize::from(standing.at_rest > 0);
            let share = f64::from(standing.count) / self.full(standing);
            let is_solid = !now.segments.is_empty();
            ranked.push((
                share + if is_solid { STAYS_BY } else { 0.0 },
                voxel,
                standing,
            ));
        }
        // the order of equals is that of the voxels, as the sort is stable
        ranked.sort_by(|one, other| other.0.total_cmp(&one.0));
        let mut wanted = Wanted::new();
        for (place, (_, voxel, standing)) in ranked.into_iter().enumerate() {
            let Some(rest) = ledger.rest(voxels, voxel) else {
                continue;
            };
            let matter = self.of(place < count && standing.count > 0, standing, &rest);
            wanted.insert(voxel.to_array(), (matter, standing.shown(&matter)));
        }
        // what a reset has taken the particles of
        ledger.give_back_outside(voxels, region, &mut wanted);
        ledger.write(voxels, &wanted)
    }
}

impl<L: LocalLaw> LocalState<L> {
    /// Whether a tool that touches tissue in a cell works out of the box's middle; then all voxels count as
    /// they are, and the particles go back to the pool.
    pub fn leaves(&mut self, contact: IVec3) -> bool {
        let inner = self.inner_cells();
        let Some(centre) = self.centre else {
            return true;
        };
        let far = (contact - centre).abs().max_element();
        let leaves = f64::from(far) > INNER * 0.5 * f64::from(inner);
        if leaves {
            self.forget();
            self.settle_all();
        }
        leaves
    }

    /// Notes that what voxels show stays, where no tool touches the particles and they are at rest.
    pub fn note_rearranged(&mut self, felt: &[ToolForce], residual: f64) {
        let is_free = felt.iter().all(|felt| felt.touched == 0);
        if self.rearranges() && is_free && residual < AT_REST {
            self.note_all_stays();
        }
    }
}
