//! Whether a session with soft tissue keeps the promises of touch, tick by tick.
//!
//! What is solid is asked of the servo, voxel by voxel, and kept as bytes around the probe, so
//! that a way can be looked for through what was free before the tick or is free after it.
//! Guarantees by number as in [`crate::stress`], and
//! 9. bone stays where it is but for what is drilled, and who is deeper in it than a voxel is
//!    pushed, whatever the model says.
//!
//! Frame: scene [mm], whose origin is the grid's corner.

use glam::{DVec3, IVec3};
use palpate_engine::servo::TickRecord;
use palpate_engine::touch::{Settings, Touchable};
use palpate_haptics::contact::{ContactModel, Exact};
use palpate_haptics::force::ForceLimits;
use palpate_volume::bits::Bits;
use palpate_volume::voxel_box::VoxelBox;

use super::rig::LIMITS;
use super::world::World;
use crate::stress::{Dense, Finder, Guarantee, Violation, hold};

/// Between ticks [s].
pub const DT: f64 = 1e-3;
/// How far around the probe voxels are kept [voxels]: a change pushes it by 7 at most.
const REACH: i32 = 8;
/// Voxels around the world that are kept too: outside all is free, and a way may lead through
/// there.
const RIM: i32 = 1;
/// What the force may grow by beside the hand's own way [smallest spacings].
const STEP: f64 = 0.1;
/// The least that bone pushes with from a voxel deep on [springs as long as the smallest spacing].
const PUSH: f64 = 0.25;

/// What a tick did.
#[derive(Clone, Copy, Debug)]
pub struct Observation<'a> {
    /// As the servo records it.
    pub record: &'a TickRecord,
    /// What is solid for the probe now.
    pub solid: &'a Bits,
    /// Force that was sent to the device.
    pub sent: DVec3,
    /// Whether a needle is in: then the force is the needle's.
    pub needle: bool,
    /// Whether friction holds the probe, as a drill's does that grips: who is let go is pushed by
    /// more than the hand's own way.
    pub gripped: bool,
    /// Whether a drill was in the hand, and touch has not followed all of it yet: then bone goes.
    pub drill: bool,
}

/// The checker.
#[derive(Debug)]
pub struct Monitor {
    spacing: DVec3,
    radius: f64,
    visit_bound: u32,
    stiffness: f64,
    /// What is solid in the world, which begins at [`RIM`].
    dense: Dense,
    /// What was bone, but for what was drilled.
    bone: Dense,
    finder: Finder,
    last: Option<(TickRecord, DVec3)>,
    gripped: bool,
    /// Bits that changed around the probe.
    pub bits: u64,
    /// Ticks with the device deeper than a voxel in bone.
    pub in_bone: u64,
}

impl Monitor {
    /// Of a world whose probe stands free.
    pub fn new(world: &World, solid: &Bits) -> Self {
        let touchable = Touchable::new(&world.grid(), Vec::new(), world.radius);
        let limits = touchable.expect("balls fit the world").limits();
        let size = world.dimensions().as_ivec3();
        Self {
            spacing: world.spacing,
            radius: world.radius,
            // a tick touches three times at most: before and after it slides, and where what is
            // hard stops what soft tissue leads
            visit_bound: 3 * Exact { limits }.visit_bound(),
            stiffness: Settings::default().stiffness,
            dense: Dense::from_fn(size + 2 * RIM, |voxel| solid.is_solid(voxel - RIM)),
            bone: Dense::from_fn(size, |voxel| world.is_bone(voxel)),
            finder: Finder::default(),
            last: None,
            gripped: false,
            bits: 0,
            in_bone: 0,
        }
    }

    /// After a tick.
    pub fn after_tick(&mut self, told: &Observation<'_>) -> Result<(), Violation> {
        let record = told.record;
        self.way(record, told.solid)?;
        self.look(told)?;
        self.stays_out(record)?;
        let bound = self.visit_bound;
        hold(record.visits <= bound, Guarantee::BoundedWork, || {
            format!("{} voxels visited, {bound} allowed", record.visits)
        })?;
        self.force(told)?;
        self.bone_pushes(told)?;
        self.sent(told.sent)?;
        self.last = Some((*record, told.sent));
        self.gripped = told.gripped;
        Ok(())
    }

    /// After a drill, once touch has followed all of it, also where the probe is not any more.
    pub fn bone_was_drilled(&mut self, solid: &Bits) {
        for voxel in VoxelBox::new(IVec3::ZERO, self.bone.size()).voxels() {
            if self.bone.is_solid(voxel) && !solid.is_solid(voxel) {
                self.bone.set(voxel, false);
            }
        }
    }

    fn voxel(&self, point: DVec3) -> IVec3 {
        (point / self.spacing).floor().as_ivec3()
    }

    /// Guarantee 2: from where it was through faces of voxels that were or are free.
    fn way(&mut self, record: &TickRecord, solid: &Bits) -> Result<(), Violation> {
        let Some((last, _)) = &self.last else {
            return Ok(());
        };
        let ends = [last.proxy, record.proxy].map(|point| self.voxel(point));
        let Self { dense, finder, .. } = self;
        let is_free = |voxel| !dense.is_solid(voxel) || !solid.is_solid(voxel - RIM);
        // what is farther outside stands in the rim
        let kept = ends.map(|voxel| (voxel + RIM).clamp(IVec3::ZERO, dense.size() - 1));
        let has_path =
            ends[0] == ends[1] || is_free(kept[0]) && finder.has_path(dense, kept, REACH, is_free);
        hold(has_path, Guarantee::CrossesNoWall, || {
            format!("from {} to {}", ends[0], ends[1])
        })
    }

    /// Keeps what is solid around the probe; bone that was there stays (guarantee 9).
    fn look(&mut self, told: &Observation<'_>) -> Result<(), Violation> {
        let middle = self.voxel(told.record.proxy);
        for voxel in VoxelBox::new(middle - REACH, middle + REACH + 1).voxels() {
            let now = told.solid.is_solid(voxel);
            if self.dense.is_solid(voxel + RIM) == now {
                continue;
            }
            self.dense.set(voxel + RIM, now);
            self.bits += 1;
            if !now && self.bone.is_solid(voxel) {
                hold(told.drill, Guarantee::HardHolds, || {
                    format!("bone at {voxel} is gone")
                })?;
                self.bone.set(voxel, false);
            }
        }
        Ok(())
    }

    /// Guarantee 9, of the force before the safety stage.
    fn bone_pushes(&mut self, told: &Observation<'_>) -> Result<(), Violation> {
        let inside = self.voxel(told.record.device);
        let mut near = VoxelBox::new(inside - 1, inside + 2).voxels();
        let is_deep = near.all(|voxel| self.bone.is_solid(voxel));
        // a needle has a law of its own
        if !is_deep || told.needle {
            return Ok(());
        }
        self.in_bone += 1;
        let force = told.record.force.length();
        let least = PUSH * self.stiffness * self.spacing.min_element();
        hold(force >= least, Guarantee::HardHolds, || {
            format!(
                "{force} N in bone at {} mm, at least {least} N expected",
                told.record.device
            )
        })
    }

    /// Guarantee 1.
    fn stays_out(&self, record: &TickRecord) -> Result<(), Violation> {
        let point = record.proxy / self.spacing + f64::from(RIM);
        let is_in = self.dense.is_solid(point.floor().as_ivec3());
        let touches = || self.dense.is_near(point, point, self.spacing, self.radius);
        let is_out = !(is_in || (self.radius > 0.0 && touches()));
        hold(is_out, Guarantee::StaysOut, || {
            format!("the probe is at {} mm", record.proxy)
        })
    }

    /// Guarantees 3, 6 and 8, of the force before the safety stage; 8 is none of friction's.
    fn force(&self, told: &Observation<'_>) -> Result<(), Violation> {
        let record = told.record;
        let felt = record.contact || told.needle;
        hold(
            felt || record.force == DVec3::ZERO,
            Guarantee::BoundedWork,
            || format!("{} N without contact", record.force),
        )?;
        if told.needle {
            return Ok(());
        }
        let out = record.proxy - record.device;
        // rounding, as of the ends of a spring some 100 mm from the origin
        let along = record.force.dot(out) + 1e-9 * (record.force.length() + out.length());
        hold(along >= 0.0, Guarantee::NeverPulls, || {
            format!("{} N, the probe {out} mm away", record.force)
        })?;
        let Some((last, _)) = &self.last else {
            return Ok(());
        };
        if told.gripped || self.gripped {
            return Ok(());
        }
        let way = record.device.distance(last.device);
        let most = self.stiffness * (way + STEP * self.spacing.min_element()) + 1e-9;
        let grown = record.force.length() - last.force.length();
        hold(grown <= most, Guarantee::StepsLittle, || {
            format!("grown by {grown} N to {} N, {most} N allowed", record.force)
        })
    }

    /// Guarantee 5.
    fn sent(&self, sent: DVec3) -> Result<(), Violation> {
        let last = self.last.map_or(0.0, |(_, sent)| sent.length());
        let grown = sent.length() - last;
        let most = ForceLimits::default().max_growth * DT * (1.0 + 1e-9);
        let is_safe = sent.is_finite() && sent.length() <= LIMITS.max_force && grown <= most;
        hold(is_safe, Guarantee::SafeForce, || {
            format!("{sent} N sent after {last} N")
        })
    }
}

#[cfg(test)]
mod tests {
    use palpate_volume::segment::Segment;

    use super::*;
    use crate::random::Random;

    /// The first violation of a probe that goes along these voxels of a world that is solid where
    /// the rule says so, one in each tick, without a force.
    fn along(voxels: &[[i32; 3]], solid: impl Fn(IVec3) -> bool + Sync) -> Option<Guarantee> {
        let world = World::new(0, &mut Random::of_stream(7, 0));
        let segment = Segment::from_fn(world.dimensions(), solid);
        let solid = segment.occupancy();
        let mut monitor = Monitor::new(&world, solid);
        let broken = voxels.iter().find_map(|voxel| {
            let place = (IVec3::from_array(*voxel).as_dvec3() + 0.5) * world.spacing;
            let record = TickRecord {
                // far from the bone of the world, which would have to push
                device: DVec3::splat(-100.0),
                proxy: place,
                ..TickRecord::default()
            };
            let told = Observation {
                record: &record,
                solid,
                sent: DVec3::ZERO,
                needle: false,
                gripped: false,
                drill: false,
            };
            monitor.after_tick(&told).err()
        });
        broken.map(|violation| violation.guarantee)
    }

    /// A wall along the whole side of the world, with a room behind it.
    fn wall(voxel: IVec3) -> bool {
        (0..3).contains(&voxel.x)
    }

    #[test]
    fn outside_of_the_world_all_is_free() {
        let corner = |voxel: IVec3| voxel.x < 3 && voxel.z < 20;
        // over the corner, far out, down along the wall, and back
        let way = [
            [1, 20, 20],
            [-1, 20, 20],
            [-4, 20, 21],
            [-1, 20, 19],
            [-1, 20, 15],
            [-1, 20, 19],
            [0, 20, 20],
        ];
        assert_eq!(along(&way, corner), None);
        // on any side
        let free = |_: IVec3| false;
        assert_eq!(along(&[[20, 39, 20], [20, 41, 20]], free), None);
        assert_eq!(along(&[[20, 20, 35], [20, 20, 36]], free), None);
        assert_eq!(along(&[[39, 0, 0], [40, -1, -1], [39, 0, 0]], free), None);
    }

    #[test]
    fn a_wall_at_the_side_of_the_world_is_no_way_in_or_out() {
        let through = Some(Guarantee::CrossesNoWall);
        assert_eq!(along(&[[-1, 20, 20], [3, 20, 20]], wall), through);
        assert_eq!(along(&[[3, 20, 20], [-1, 20, 20]], wall), through);
        assert!(along(&[[-1, 20, 20], [0, 20, 20]], wall).is_some());
        // where it ends, there is a way around
        let low = |voxel: IVec3| wall(voxel) && voxel.z < 22;
        assert_eq!(along(&[[-1, 20, 20], [3, 20, 20]], low), None);
    }
}
