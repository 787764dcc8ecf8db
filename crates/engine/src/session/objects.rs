//! What a session does to segments as objects. Points in scene mm (LPS).

use glam::DVec3;
use palpate_volume::edit::SegmentId;
use palpate_volume::voxels::VoxelsError;

use super::Session;
use crate::cut::Plane;
use crate::error::SessionError;
use crate::session_config::check_point;

impl Session {
    /// Takes a segment in the hand, or lets go of the one that is: it follows the probe's way and
    /// the handle's turn, and does not stop the probe meanwhile. Where `collides` other obstacles
    /// stop it.
    ///
    /// # Errors
    /// Where there is no such segment, too many are moved, or the session has ended.
    pub fn grab(&self, id: Option<SegmentId>, collides: bool) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.grab(id, collides))?
    }

    /// Turns the segment in the hand about the probe by a rotation vector [rad].
    ///
    /// # Errors
    /// Where the vector is not allowed or the session has ended.
    pub fn turn_grabbed(&self, rotation: DVec3) -> Result<(), SessionError> {
        check_point("turn", rotation)?;
        self.ask(move |simulation| simulation.turn_grabbed(rotation))
    }

    /// Parts a segment by a plane: it keeps what lies behind the plane, a new segment has what
    /// lies before it. Gives the new one's number.
    ///
    /// # Errors
    /// Where the plane is none or leaves all on one side, there is no such segment, there are
    /// 255, or the session has ended.
    pub fn cut(
        &self,
        id: SegmentId,
        point: DVec3,
        normal: DVec3,
    ) -> Result<SegmentId, SessionError> {
        let pose = self.ask(move |simulation| simulation.current_pose(id))?;
        let plane = Plane::in_scan(point, normal, &pose.unwrap_or_default())
            .ok_or(SessionError::Plane { point, normal })?;
        self.build_and_commit(
            move |voxels| {
                let segment = voxels.segment(id);
                let segment = segment.ok_or(VoxelsError::UnknownSegment(id.0))?;
                let (behind, before) = plane.part(segment, voxels.grid());
                if behind.count() == 0 || before.count() == 0 {
                    return Err(SessionError::CutMisses { id: id.0, point });
                }
                Ok((behind, before))
            },
            move |simulation, parts| simulation.part_segment(id, parts),
        )
    }
}
