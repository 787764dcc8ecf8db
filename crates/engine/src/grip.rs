//! A segment in the hand: it follows the probe, and may be stopped by other segments.
//!
//! The probe's way and the turn of the device's handle act on the segment between two passes of
//! the simulation (thesis 4.7, no-collision mode); with a mouse the turn comes from keys. In the
//! hand a segment is no obstacle for the probe.
//!
//! Where it is to collide with other segments (thesis 4.16), its surface voxels are looked up in
//! theirs at every step: a step that brings more of them into another segment is not taken, only
//! what is left of it along the axes. So two that overlap when they are grabbed can be parted.
//! Work is bounded: [`MOST_SAMPLES`] voxels, [`MOST_TESTS`] poses a pass; what is left of a way is
//! gone in the next pass. Frames: scan and scene, mm.

use glam::{DAffine3, DMat3, DQuat, DVec3, IVec3};
use palpate_haptics::moving::PoseMotion;
use palpate_volume::bits::Bits;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

use crate::handover::ServoStatus;
use crate::scene::Scene;

/// Surface voxels that are looked up; of a larger surface every so many-th.
pub const MOST_SAMPLES: usize = 40_000;
/// Poses that are tried in one pass.
pub const MOST_TESTS: usize = 12;

/// Parts of a step that is not free as a whole: along which axes of the scene.
const ALONG: [DVec3; 6] = [
    DVec3::new(1.0, 1.0, 0.0),
    DVec3::new(1.0, 0.0, 1.0),
    DVec3::new(0.0, 1.0, 1.0),
    DVec3::X,
    DVec3::Y,
    DVec3::Z,
];

/// The segment in the hand.
#[derive(Debug)]
pub struct Grip {
    id: SegmentId,
    /// Where it stands.
    pose: DAffine3,
    /// Where the hand wants it.
    wanted: DAffine3,
    /// Probe and handle in the pass before; none where they may have jumped since.
    last: Option<(DVec3, DQuat)>,
    surface: Option<HeldSurface>,
    /// Whether the journal has its way since it was grabbed.
    pub noted: bool,
}

/// Voxels of the held segment with a free neighbour.
#[derive(Debug)]
struct HeldSurface {
    grid: Grid,
    /// Their middles where the scan has them [mm].
    middles: Vec<DVec3>,
    bounds: VoxelBox,
}

/// Another segment.
struct Other<'a> {
    bits: &'a Bits,
    grid_from_scene: DAffine3,
    smallest_spacing: f64,
}

impl Grip {
    /// A segment that stands at a pose; it collides with others where `solid` has its voxels.
    #[must_use]
    pub fn new(id: SegmentId, pose: DAffine3, solid: Option<(&Segment, &Grid)>) -> Self {
        Self {
            id,
            pose,
            wanted: pose,
            last: None,
            surface: solid.map(|(segment, grid)| HeldSurface::of(segment, grid)),
            noted: false,
        }
    }

    /// Which segment.
    #[must_use]
    pub fn id(&self) -> SegmentId {
        self.id
    }

    /// Where it stands.
    #[must_use]
    pub fn pose(&self) -> DAffine3 {
        self.pose
    }

    /// The probe may be somewhere else in the next pass without having moved the segment.
    pub fn pause(&mut self) {
        self.last = None;
    }

    /// Turns what the hand wants about the probe by a rotation vector [rad].
    pub fn turn(&mut self, rotation: DVec3, status: &ServoStatus) {
        self.move_wanted(
            status.proxy,
            DQuat::from_scaled_axis(rotation),
            status.proxy,
        );
    }

    /// Follows probe and handle to where they are.
    pub fn follow(&mut self, status: &ServoStatus) {
        let now = (status.proxy, status.orientation);
        let Some((point, handle)) = self.last.replace(now) else {
            return;
        };
        // a turned view turns no segment: the handle's own turn counts, in the axes of now
        let axes = DQuat::from_mat3(&status.axes);
        let turn = axes * (now.1 * handle.inverse()) * axes.inverse();
        self.move_wanted(point, turn, now.0);
    }

    /// Takes a point along to another one and turns about it; nothing where that is no motion.
    fn move_wanted(&mut self, from: DVec3, turn: DQuat, to: DVec3) {
        let moved = DAffine3::from_translation(to)
            * DAffine3::from_quat(turn)
            * DAffine3::from_translation(-from)
            * self.wanted;
        if moved.is_finite() {
            // rounding must not add up to a shear
            let axes = DMat3::from_quat(DQuat::from_mat3(&moved.matrix3).normalize());
            self.wanted = DAffine3::from_mat3_translation(axes, moved.translation);
        }
    }

    /// Goes toward where the hand wants it as far as others let it; says whether it moved.
    pub fn advance(&mut self, scene: &Scene) -> bool {
        let before = self.pose;
        if self.pose != self.wanted {
            match &self.surface {
                None => self.pose = self.wanted,
                Some(surface) => {
                    let others = others_of(scene);
                    self.pose = surface.way(&others, (self.pose, self.wanted));
                }
            }
        }
        self.pose != before
    }
}

impl HeldSurface {
    fn of(segment: &Segment, grid: &Grid) -> Self {
        let bits = segment.occupancy();
        let middle = |voxel: IVec3| {
            grid.patient_from_grid()
                .transform_point3(voxel.as_dvec3() + 0.5)
        };
        let all = surface_voxels(bits);
        let stride = all.len().div_ceil(MOST_SAMPLES).max(1);
        Self {
            grid: *grid,
            middles: all.into_iter().step_by(stride).map(middle).collect(),
            bounds: segment.bounding_box().unwrap_or(VoxelBox::EMPTY),
        }
    }

    /// How far it comes on its way in one pass: straight, then what is left of it along axes.
    fn way(&self, others: &[Other<'_>], ends: (DAffine3, DAffine3)) -> DAffine3 {
        let (start, wanted) = ends;
        let middle = self
            .grid
            .patient_from_grid()
            .transform_point3((self.bounds.min + self.bounds.max).as_dvec3() / 2.0);
        let spacings = others.iter().map(|other| other.smallest_spacing);
        let mut walk = Walk {
            surface: self,
            step: spacings.fold(self.grid.smallest_spacing(), f64::min),
            others,
            middle,
            pose: start,
            inside: self.inside(&start, others),
            tests: 1,
        };
        walk.go(wanted);
        for axes in ALONG {
            let left = wanted.transform_point3(middle) - walk.pose.transform_point3(middle);
            walk.go(DAffine3::from_translation(left * axes) * walk.pose);
        }
        walk.pose
    }

    /// Surface voxels whose middle is inside of another segment.
    fn inside(&self, pose: &DAffine3, others: &[Other<'_>]) -> usize {
        others
            .iter()
            .map(|other| {
                let grid_from_scan = other.grid_from_scene * *pose;
                let within = |middle: &&DVec3| {
                    let voxel = grid_from_scan.transform_point3(**middle).floor();
                    other.bits.is_solid(voxel.as_ivec3())
                };
                self.middles.iter().filter(within).count()
            })
            .sum()
    }
}

/// A way in steps of a voxel, none of which brings more of the surface into others.
struct Walk<'a> {
    surface: &'a HeldSurface,
    /// Length of a step: the smallest voxel's [mm].
    step: f64,
    others: &'a [Other<'a>],
    middle: DVec3,
    pose: DAffine3,
    inside: usize,
    tests: usize,
}

impl Walk<'_> {
    /// Goes toward a pose up to the first step that is not free.
    fn go(&mut self, to: DAffine3) {
        if to == self.pose {
            return;
        }
        let way = to.transform_point3(self.middle) - self.pose.transform_point3(self.middle);
        let steps = (way.length() / self.step).ceil() as u32;
        let HeldSurface { grid, bounds, .. } = self.surface;
        let motion = PoseMotion::new(grid, *bounds, self.pose, to, steps);
        let Ok(mut motion) = motion else {
            return;
        };
        while !motion.is_done() && self.tests < MOST_TESTS {
            let next = motion.next_pose();
            let inside = self.surface.inside(&next, self.others);
            self.tests += 1;
            if inside > self.inside {
                return;
            }
            (self.pose, self.inside) = (next, inside);
            motion.advance();
        }
    }
}

/// All obstacles; the held segment is none.
fn others_of(scene: &Scene) -> Vec<Other<'_>> {
    let other = |segment: &'_ Segment, pose: Option<DAffine3>| {
        let grid = segment.grid(scene.voxels().grid());
        let scan_from_scene = pose.unwrap_or(DAffine3::IDENTITY).inverse();
        (grid.grid_from_patient() * scan_from_scene, grid.smallest_spacing())
    };
    scene
        .obstacles()
        .map(|(_, segment, properties)| {
            let (grid_from_scene, smallest_spacing) = other(segment, properties.pose);
            Other {
                bits: segment.occupancy(),
                grid_from_scene,
                smallest_spacing,
            }
        })
        .collect()
}

/// Solid voxels with a free neighbour across a face, brick by brick.
#[must_use]
pub fn surface_voxels(bits: &Bits) -> Vec<IVec3> {
    let sides = [IVec3::X, IVec3::Y, IVec3::Z];
    let is_surface = |voxel: &IVec3| {
        bits.is_solid(*voxel)
            && sides
                .iter()
                .any(|side| !bits.is_solid(voxel + side) || !bits.is_solid(voxel - side))
    };
    (0..)
        .zip(bits.bricks().entries())
        .filter(|(_, brick)| brick.is_some())
        .flat_map(|(index, _)| bits.bricks().box_of(index).voxels())
        .filter(is_surface)
        .collect()
}
