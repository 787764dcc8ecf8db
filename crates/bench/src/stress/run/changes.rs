//! What changes under the probe in a run: voxels that are set and cleared, objects that move.

use glam::{DVec3, IVec3};
use palpate_haptics::admission::{PoseMotion, PoseStep};
use palpate_haptics::contact::{ContactModel, Proxy};
use palpate_haptics::scene::ObjectPose;
use palpate_volume::voxel_box::VoxelBox;

use super::super::guarantee::Violation;
use super::super::touched::swaps_of;
use super::super::world::SIZE;
use super::Run;

/// How often edits come, per move.
const EDITS: f64 = 1.0 / 32.0;

impl<M: ContactModel> Run<'_, M> {
    /// Each object goes on along its way; one that is held waits, and then goes elsewhere.
    pub(super) fn move_objects(&mut self, proxy: &mut Proxy) -> Result<(), Violation> {
        for place in 0..self.made.len() {
            let made = &mut self.made[place];
            let motion = match self.motions[place].filter(|motion| !motion.is_done()) {
                Some(motion) => motion,
                None => {
                    let target = made.pose_near(&made.rigid, self.grid, &mut self.random);
                    let ticks = (200.0 * self.random.share() * self.random.share()) as u32;
                    PoseMotion::new(&made.grid, made.bounds, made.rigid, target, ticks)
                        .expect("poses near rigid ones are rigid")
                }
            };
            self.motions[place] = Some(motion);
            let rigid = motion.next_pose();
            let Ok(pose) = ObjectPose::new(&made.grid, self.grid, rigid) else {
                self.motions[place] = None;
                continue;
            };
            let from = *proxy;
            let step = self.touched.step_pose(place, &pose, self.grid, proxy);
            if step == PoseStep::Held {
                // soon somewhere else
                if self.random.share() < 0.1 {
                    self.motions[place] = None;
                }
            } else {
                made.rigid = rigid;
                if let Some(motion) = &mut self.motions[place] {
                    motion.advance();
                }
                self.epoch += 1;
                self.report.poses += 1;
                self.checker.after_pose(place, &rigid, [&from, proxy])?;
            }
        }
        Ok(())
    }

    /// Now and then: voxels under the probe or the device, set or cleared.
    pub(super) fn edit(&mut self, proxy: &mut Proxy) -> Result<(), Violation> {
        if self.touched.holds_back() {
            let from = *proxy;
            self.touched.retry(self.grid, proxy);
            self.follow(&from, proxy)?;
        }
        if self.random.share() < EDITS && self.touched.has_room() {
            let from = *proxy;
            let changed = self.change_wanted(proxy);
            let swaps = swaps_of(self.touched.bits(), &changed, |voxel| {
                self.wanted.is_solid(voxel)
            });
            let fractions = self.constants.felt.after(&swaps, &mut self.random);
            self.touched.edit((swaps, fractions), self.grid, proxy);
            self.unsettled.push(changed);
            self.report.edits += 1;
            self.follow(&from, proxy)?;
        }
        self.checker.after_changes(proxy)
    }

    /// Brings the checker up to date after one change, which may have pushed the probe.
    fn follow(&mut self, from: &Proxy, to: &Proxy) -> Result<(), Violation> {
        self.epoch += 1;
        self.checker.before_change(from, to)?;
        let all_arrived = !self.touched.holds_back();
        let bits = self.touched.bits();
        for changed in &self.unsettled {
            let wanted = all_arrived.then_some(&self.wanted);
            self.checker
                .follow(changed, |voxel| bits.is_solid(voxel), wanted)?;
        }
        if all_arrived {
            self.unsettled.clear();
        }
        Ok(())
    }

    /// Sets or clears a few voxels; gives the box that they lie in.
    fn change_wanted(&mut self, proxy: &Proxy) -> VoxelBox {
        let near = if self.random.share() < 0.5 {
            proxy.point()
        } else {
            self.hand.device
        };
        let spread = DVec3::splat(2.0);
        let middle = self.random.in_box(near - spread, near + spread);
        let reach = 3.0 * self.random.share();
        let solid = self.random.share() < 0.5;
        let low = (middle - reach).floor().as_ivec3().max(IVec3::ZERO);
        let high = (middle + reach)
            .floor()
            .as_ivec3()
            .min(IVec3::splat(SIZE - 1));
        let changed = VoxelBox::new(low, high + 1);
        for voxel in changed.voxels() {
            let is_fixed = self.fixed.is_solid(voxel);
            let is_in = (voxel.as_dvec3() + 0.5).distance(middle) <= reach;
            if is_in && !is_fixed {
                self.wanted.set(voxel, solid);
            }
        }
        changed
    }
}
