//! Where moved segments stand, and the way that each of them goes, tick by tick.
//!
//! A pose comes from a drag, a script, an undo; here it is a target. The segment goes there
//! in small steps, each admitted by the probe: one that the probe is pinched by is not taken,
//! and the segment waits. Frame: a pose takes the scan to the scene [mm].

use glam::DAffine3;
use palpate_haptics::moving::{PoseMotion, PoseStep, step_pose};
use palpate_haptics::proxy::Proxy;
use palpate_haptics::scene::{MAX_OBJECTS, ObjectPose};
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use serde::{Deserialize, Serialize};

use crate::touchable::Touchable;

/// Ticks that a move takes at least: what a page sends 60 times a second joins without a stop.
const MOVE_TICKS: u32 = 17;

/// One segment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Moved {
    id: u8,
    pose: DAffine3,
    motion: Option<PoseMotion>,
    /// The last step was not taken, since the probe is in the way.
    stopped: bool,
}

/// All moved segments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MovedPoses {
    moved: [Option<Moved>; MAX_OBJECTS],
}

impl MovedPoses {
    /// Leads a segment to a pose, a rigid motion that was checked. A segment that is no object of
    /// its own is none of these.
    pub fn lead(&mut self, id: SegmentId, target: DAffine3, grid: &Grid, touchable: &Touchable) {
        let Some((_, object)) = numbered(touchable).find(|(other, _)| *other == id) else {
            return;
        };
        let bounds = touchable.objects[object].bounds();
        let free = self.moved.iter().position(Option::is_none);
        let known = self
            .moved
            .iter()
            .position(|moved| moved.is_some_and(|moved| moved.id == id.0));
        let Some(place) = known.or(free) else { return };
        let moved = self.moved[place].get_or_insert(Moved {
            id: id.0,
            pose: DAffine3::IDENTITY,
            motion: None,
            stopped: false,
        });
        moved.motion = PoseMotion::new(grid, bounds, moved.pose, target, MOVE_TICKS).ok();
    }

    /// Puts the objects of something that is to be touched where their segments stand.
    pub fn place(&self, touchable: &mut Touchable, grid: &Grid) {
        touchable.put_objects(grid, |id| {
            let known = self.moved.iter().flatten();
            let moved = known.into_iter().find(|moved| moved.id == id.0);
            Some(moved.map_or(DAffine3::IDENTITY, |moved| moved.pose))
        });
    }

    /// Takes one step of each motion, as far as the probe admits it.
    pub fn step(&mut self, touchable: &mut Touchable, grid: &Grid, proxy: &mut Proxy) {
        for moved in self.moved.iter_mut().flatten() {
            let Some(motion) = &mut moved.motion else {
                continue;
            };
            let next = motion.next_pose();
            let object = numbered(touchable).find(|(id, _)| id.0 == moved.id);
            let pose = ObjectPose::new(grid, grid, next);
            let (Some((_, object)), Ok(pose)) = (object, pose) else {
                moved.motion = None;
                continue;
            };
            moved.stopped =
                step_pose(&touchable.scene(grid), object, &pose, proxy) == PoseStep::Held;
            if moved.stopped {
                continue;
            }
            touchable.objects[object].set_pose(pose);
            moved.pose = next;
            motion.advance();
            if motion.is_done() {
                moved.motion = None;
            }
        }
    }

    /// Whether any segment is on its way.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        self.moved
            .iter()
            .flatten()
            .any(|moved| moved.motion.is_some())
    }

    /// Segments that the probe keeps from where they are to go, one bit for each number.
    #[must_use]
    pub fn stopped(&self) -> [u64; 4] {
        let mut bits = [0; 4];
        for moved in self.moved.iter().flatten() {
            if moved.stopped && moved.motion.is_some() {
                bits[usize::from(moved.id / 64)] |= 1 << (moved.id % 64);
            }
        }
        bits
    }
}

/// Moved segments with the places of their objects.
fn numbered(touchable: &Touchable) -> impl Iterator<Item = (SegmentId, usize)> {
    touchable.object_ids().zip(0..)
}
