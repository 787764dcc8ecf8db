//! What a session does to segments as objects. Points in scene mm (LPS).

use glam::DVec3;
use palpate_volume::edit::SegmentId;
use palpate_volume::segment::Segment;
use palpate_volume::voxels::{Voxels, VoxelsError};

use super::{Session, lock};
use crate::error::SessionError;
use crate::scene::{Gap, LineCut, Measured, Painted, Plane, gap_surface_options};
use crate::session::config::check_point;
use crate::simulation::Simulation;

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

    /// Has the device move without the probe, to take it up elsewhere, or with it again. Without
    /// the probe it feels no contact.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn clutch(&self, on: bool) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.clutch(on))
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
                let (behind, before) = plane.part(segment, segment.grid(voxels.grid()));
                if behind.count() == 0 || before.count() == 0 {
                    return Err(SessionError::CutMisses { id: id.0, point });
                }
                Ok((behind, before))
            },
            move |simulation, parts| simulation.part_segment(id, parts),
        )
    }

    /// Parts a segment along a line that was painted on the picture, extruded away from the eye:
    /// it keeps the larger part, a new segment has the smaller one. Gives the new one's number.
    ///
    /// # Errors
    /// Where the line is none or leaves all on one side, there is no such segment, there are
    /// 255, or the session has ended.
    pub fn cut_along(&self, id: SegmentId, painted: &Painted) -> Result<SegmentId, SessionError> {
        let cut = self.line_cut(id, painted)?;
        self.build_and_commit(
            move |voxels| parts_of(voxels, id, &cut),
            move |simulation, parts| simulation.part_segment(id, parts),
        )
    }

    /// The volumes of the larger and the smaller part that [`Self::cut_along`] would make [mm³].
    ///
    /// # Errors
    /// See there.
    pub fn preview_cut(&self, id: SegmentId, painted: &Painted) -> Result<[f64; 2], SessionError> {
        let cut = self.line_cut(id, painted)?;
        let voxels = self.ask(|simulation| simulation.voxels().clone())?;
        let (larger, smaller) = parts_of(&voxels, id, &cut)?;
        let each = voxels.grid_of(id).voxel_volume();
        Ok([larger, smaller].map(|part| part.count() as f64 * each))
    }

    fn line_cut(&self, id: SegmentId, painted: &Painted) -> Result<LineCut, SessionError> {
        let pose = self.ask(move |simulation| simulation.current_pose(id))?;
        let points = painted.line.len();
        LineCut::in_scan(painted, &pose.unwrap_or_default())
            .ok_or(SessionError::PaintedLine { points })
    }

    /// The gap from the surface of one segment to another, where both stand by now. The first
    /// call makes their surfaces, one after an edit what the edit changed of them; neither servo
    /// nor simulation waits for that.
    ///
    /// # Errors
    /// Where there is no such segment, one of them is empty, or the session has ended.
    pub fn gap(&self, from: SegmentId, to: SegmentId) -> Result<Gap, SessionError> {
        let (scan, ends) = self.ask(move |simulation| {
            let ends = [from, to].map(|id| {
                let pose = simulation.current_pose(id).unwrap_or_default();
                Ok((measured(simulation, id)?, pose))
            });
            (simulation.voxels().intensities().clone(), ends)
        })?;
        let [first, second]: [Result<_, SessionError>; 2] = ends;
        let ((mut first, first_pose), (mut second, second_pose)) = (first?, second?);
        let surfaces = lock(&self.surfaces);
        for one in [&mut first, &mut second] {
            one.drawn = surfaces.kept(one.id, &gap_surface_options()).cloned();
        }
        drop(surfaces);
        let bodies = lock(&self.gap_bodies).ready([first, second], &self.grid, &scan);
        let [one, other] = bodies;
        let to_other = second_pose.inverse() * first_pose;
        one.gap_to(&other, &to_other)
            .ok_or(SessionError::NoGap(from.0, to.0))
    }
}

/// A segment as it is now, to be measured.
fn measured(simulation: &Simulation, id: SegmentId) -> Result<Measured, SessionError> {
    let segment = simulation.voxels().segment(id).cloned();
    Ok(Measured {
        id,
        segment: segment.ok_or(VoxelsError::UnknownSegment(id.0))?,
        voxels: simulation.voxels_of(id)?,
        drawn: None,
    })
}

/// Both parts of a segment, the larger one first.
fn parts_of(
    voxels: &Voxels,
    id: SegmentId,
    cut: &LineCut,
) -> Result<(Segment, Segment), SessionError> {
    let segment = voxels.segment(id);
    let segment = segment.ok_or(VoxelsError::UnknownSegment(id.0))?;
    let parts = cut.part(segment, segment.grid(voxels.grid()));
    if parts.1.count() == 0 {
        return Err(SessionError::LineMisses { id: id.0 });
    }
    Ok(parts)
}
