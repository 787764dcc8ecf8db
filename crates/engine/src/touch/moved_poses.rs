//! Where moved segments stand, and the way that each of them goes, tick by tick.
//!
//! A pose comes from a drag, a script, an undo; here it is a target. The segment goes there
//! in small steps, each admitted by the probe: one that the probe is pinched by is not taken,
//! and the segment waits.
//!
//! Whoever builds what is to be touched knows where segments are to stand in the end; only the
//! servo knows where they are by now. So a new root brings poses for the segments that the servo
//! does not know yet, and those that it knows stay where they are and go on. Frame: a pose takes
//! the scan to the scene [mm].

use glam::DAffine3;
use palpate_haptics::admission::{PoseMotion, PoseStep};
use palpate_haptics::contact::Proxy;
use palpate_haptics::scene::{MAX_OBJECTS, ObjectPose};
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::segment_set::SegmentSet;
use palpate_volume::voxel_box::VoxelBox;
use serde::{Deserialize, Serialize};

use crate::touch::touchable::Touchable;

/// Ticks that a move takes at least: what a page sends 60 times a second joins without a stop.
const MOVE_TICKS: u32 = 17;

/// Where moved segments stand now, by number: poses from the scan to the scene [mm].
pub type CurrentPoses = [Option<(u8, DAffine3)>; MAX_OBJECTS];

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
    /// Follows a new root: forgets the segments that are no objects of it, takes poses of those
    /// that are new from it, and puts the others where they are by now.
    pub fn follow_root(&mut self, touchable: &mut Touchable, grid: &Grid) {
        for place in &mut self.moved {
            place.take_if(|moved| touchable.object_of(SegmentId(moved.id)).is_none());
        }
        for (id, part) in touchable.moved() {
            if self.find(id).is_some() {
                continue;
            }
            // a root has no more objects than there are places
            if let Some(free) = self.moved.iter_mut().find(|place| place.is_none()) {
                *free = Some(Moved {
                    id: id.0,
                    pose: part.pose,
                    motion: None,
                    stopped: false,
                });
            }
        }
        self.place(touchable, grid);
    }

    /// Puts the objects of something that is to be touched where their segments are by now.
    pub fn place(&self, touchable: &mut Touchable, grid: &Grid) {
        for moved in self.moved.iter().flatten() {
            let id = SegmentId(moved.id);
            let own = touchable.own_grid_of(id).unwrap_or(grid);
            let pose = ObjectPose::new(own, grid, moved.pose);
            let object = touchable.object_of(id);
            let object = object.and_then(|place| touchable.objects.get_mut(place));
            if let (Some(object), Ok(pose)) = (object, pose) {
                object.set_pose(pose);
            }
        }
    }

    /// Leads a segment, whose voxels are within `bounds` of its grid, to a pose, a rigid motion that was
    /// checked. One that no root has brought as an object does not go.
    pub fn lead(&mut self, id: SegmentId, target: DAffine3, grid: &Grid, bounds: VoxelBox) {
        let known = self.moved.iter_mut().flatten();
        if let Some(moved) = known.into_iter().find(|moved| moved.id == id.0) {
            moved.motion = PoseMotion::new(grid, bounds, moved.pose, target, MOVE_TICKS).ok();
        }
    }

    /// Takes one step of each motion, as far as the probe admits it. A segment that is in a root
    /// held back only goes as it likes. Gives the step of the touched segment, a rigid motion of
    /// the scene [mm], if it took one.
    pub fn step(
        &mut self,
        touchable: &mut Touchable,
        grid: &Grid,
        (proxy, touched): (&mut Proxy, SegmentId),
    ) -> Option<DAffine3> {
        let mut carried = None;
        for moved in self.moved.iter_mut().flatten() {
            let Some(motion) = &mut moved.motion else {
                continue;
            };
            let next = motion.next_pose();
            let id = SegmentId(moved.id);
            let own = touchable.own_grid_of(id).unwrap_or(grid);
            let Ok(pose) = ObjectPose::new(own, grid, next) else {
                moved.motion = None;
                continue;
            };
            let object = touchable.object_of(id);
            moved.stopped = object.is_some_and(|object| {
                touchable.step_pose(object, &pose, grid, proxy) == PoseStep::Held
            });
            if moved.stopped {
                continue;
            }
            if object.is_some() && moved.id == touched.0 {
                carried = Some(next * moved.pose.inverse());
            }
            moved.pose = next;
            motion.advance();
            if motion.is_done() {
                moved.motion = None;
            }
        }
        carried
    }

    fn find(&self, id: SegmentId) -> Option<&Moved> {
        self.moved.iter().flatten().find(|moved| moved.id == id.0)
    }

    /// Where all of them stand by now.
    #[must_use]
    pub fn current(&self) -> CurrentPoses {
        self.moved
            .map(|place| place.map(|moved| (moved.id, moved.pose)))
    }

    /// Whether any segment is on its way.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        self.moved
            .iter()
            .flatten()
            .any(|moved| moved.motion.is_some())
    }

    /// Segments that the probe keeps from where they are to go.
    #[must_use]
    pub fn stopped(&self) -> SegmentSet {
        let moved = self.moved.iter().flatten();
        let stopped = moved.filter(|moved| moved.stopped && moved.motion.is_some());
        stopped.map(|moved| SegmentId(moved.id)).collect()
    }
}
