//! A segment in the hand: it follows the probe, and may be stopped by other segments.
//!
//! The probe's way and the turn of the device's handle act on the segment between two passes of
//! the simulation (thesis 4.7, no-collision mode); with a mouse the turn comes from keys. In the
//! hand a segment is no obstacle for the probe.
//!
//! Where it is to collide with other segments (thesis 4.16), its surface voxels are looked up in
//! theirs at every step: a step that brings more of them into another segment is not taken, only
//! what is left of it along the axes. So two that overlap when they are grabbed can be parted.
//! Work is bounded: [`MOST_SAMPLES`] voxels, [`MOST_TESTS`] poses and [`MOST_LOOKUPS`] questions a
//! pass; what is left of a way is gone in the next pass. Frames: scan and scene, mm.

use glam::{DAffine3, DMat3, DQuat, DVec3, IVec3};
use palpate_haptics::admission::PoseMotion;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BRICK;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use rayon::prelude::*;

use crate::scene::Scene;
use crate::servo::ServoStatus;

/// Surface voxels that are looked up; of a larger surface every so many-th.
pub const MOST_SAMPLES: usize = 40_000;
/// Poses that are tried in one pass.
pub const MOST_TESTS: usize = 12;

/// Voxels of others that are looked up in one pass, whatever their number; where more would be
/// needed for [`FEWEST_TESTS`] poses, every so many-th surface voxel is asked for.
pub const MOST_LOOKUPS: usize = 600_000;
/// Poses that a pass has lookups for, at least.
const FEWEST_TESTS: usize = 4;

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
    bounds: VoxelBox,
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
        let bricks = surface_bricks(bits);
        let count: u64 = bricks.iter().map(|(_, brick)| ones(brick)).sum();
        let stride = (count as usize).div_ceil(MOST_SAMPLES).max(1);
        Self {
            grid: *grid,
            middles: voxels_of(&bricks).step_by(stride).map(middle).collect(),
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
        let others = self.near(others, ends, middle);
        let wanted_lookups = self.middles.len() * others.len() * FEWEST_TESTS;
        let mut walk = Walk {
            surface: self,
            step: others
                .iter()
                .map(|other| other.smallest_spacing)
                .fold(self.grid.smallest_spacing(), f64::min),
            others: &others,
            middle,
            pose: start,
            inside: 0,
            stride: wanted_lookups.div_ceil(MOST_LOOKUPS).max(1),
            tests: 0,
            lookups: 0,
        };
        walk.inside = walk.look_up(&start);
        walk.go(wanted);
        for axes in ALONG {
            let left = wanted.transform_point3(middle) - walk.pose.transform_point3(middle);
            walk.go(DAffine3::from_translation(left * axes) * walk.pose);
        }
        walk.pose
    }

    /// Those of the others that the held segment may come to on its way.
    fn near<'a, 'b>(
        &self,
        others: &'b [Other<'a>],
        (start, wanted): (DAffine3, DAffine3),
        middle: DVec3,
    ) -> Vec<&'b Other<'a>> {
        let corner = self.bounds.max.as_dvec3() - self.bounds.min.as_dvec3();
        let radius = 0.5 * (corner * self.grid.spacing()).length();
        // along the axes of the scene it goes at most the way's own length beside it
        let [from, to] = [start, wanted].map(|pose| pose.transform_point3(middle));
        let reach = radius + 2.0 * from.distance(to);
        let near = |other: &&Other<'_>| {
            let rows = other.grid_from_scene.matrix3.transpose();
            // along an axis of its grid a ball reaches as far as that axis' row is long
            let rows = [rows.x_axis, rows.y_axis, rows.z_axis].map(DVec3::length);
            let reach = reach * DVec3::from(rows);
            let at = other.grid_from_scene.transform_point3(from);
            let (low, high) = (at - reach, at + reach);
            low.cmple(other.bounds.max.as_dvec3()).all()
                && high.cmpge(other.bounds.min.as_dvec3()).all()
        };
        others.iter().filter(near).collect()
    }
}

/// A way in steps of a voxel, none of which brings more of the surface into others.
struct Walk<'a> {
    surface: &'a HeldSurface,
    /// Length of a step: the smallest voxel's [mm].
    step: f64,
    others: &'a [&'a Other<'a>],
    middle: DVec3,
    pose: DAffine3,
    inside: usize,
    /// Every so many-th of the surface's voxels is looked up.
    stride: usize,
    tests: usize,
    lookups: usize,
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
        while !motion.is_done() && self.may_look_up() {
            let next = motion.next_pose();
            let inside = self.look_up(&next);
            if inside > self.inside {
                return;
            }
            (self.pose, self.inside) = (next, inside);
            motion.advance();
        }
    }

    /// Whether the work of one more pose is within the bounds.
    fn may_look_up(&self) -> bool {
        let each = self.lookups.checked_div(self.tests).unwrap_or_default();
        self.tests < MOST_TESTS && self.lookups + each <= MOST_LOOKUPS
    }

    /// Surface voxels whose middle is inside of another segment.
    fn look_up(&mut self, pose: &DAffine3) -> usize {
        self.tests += 1;
        let mut found = 0;
        for other in self.others {
            let grid_from_scan = other.grid_from_scene * *pose;
            for middle in self.surface.middles.iter().step_by(self.stride) {
                let voxel = grid_from_scan.transform_point3(*middle).floor();
                found += usize::from(other.bits.is_solid(voxel.as_ivec3()));
                self.lookups += 1;
            }
        }
        found
    }
}

/// All obstacles; the held segment is none.
fn others_of(scene: &Scene) -> Vec<Other<'_>> {
    let other = |segment: &'_ Segment, pose: Option<DAffine3>| {
        let grid = segment.grid(scene.voxels().grid());
        let scan_from_scene = pose.unwrap_or(DAffine3::IDENTITY).inverse();
        (
            grid.grid_from_patient() * scan_from_scene,
            grid.smallest_spacing(),
        )
    };
    scene
        .obstacles()
        .map(|(id, segment, properties)| {
            let (grid_from_scene, smallest_spacing) = other(segment, properties.pose);
            Other {
                bits: scene.touched(id, segment),
                bounds: segment.bounding_box().unwrap_or(VoxelBox::EMPTY),
                grid_from_scene,
                smallest_spacing,
            }
        })
        .collect()
}

/// Solid voxels with a free neighbour across a face, brick by brick.
#[must_use]
pub fn surface_voxels(bits: &Bits) -> Vec<IVec3> {
    voxels_of(&surface_bricks(bits)).collect()
}

/// Bricks of those voxels, with their first voxel; a brick is asked for as a whole.
fn surface_bricks(bits: &Bits) -> Vec<(IVec3, BitBrick)> {
    let sides = [IVec3::X, IVec3::Y, IVec3::Z];
    let of_brick = |index: usize| {
        let brick = bits.bricks().entries()[index].as_deref()?;
        let min = bits.bricks().box_of(index as u32).min;
        let mut inner = *brick;
        for side in sides.into_iter().flat_map(|side| [side, -side]) {
            let beside = bits.block(min + side);
            for (word, beside) in inner.0.iter_mut().zip(beside.0) {
                *word &= beside;
            }
        }
        let surface = BitBrick(std::array::from_fn(|z| brick.0[z] & !inner.0[z]));
        (surface != BitBrick::EMPTY).then_some((min, surface))
    };
    let count = bits.bricks().entries().len();
    (0..count).into_par_iter().filter_map(of_brick).collect()
}

/// The voxels of bricks.
fn voxels_of(bricks: &[(IVec3, BitBrick)]) -> impl Iterator<Item = IVec3> {
    bricks.iter().flat_map(|(min, brick)| {
        let solid = |offset: &IVec3| brick.contains(*offset);
        let voxels = VoxelBox::new(IVec3::ZERO, IVec3::splat(BRICK)).voxels();
        voxels.filter(solid).map(|offset| *min + offset)
    })
}

fn ones(brick: &BitBrick) -> u64 {
    brick
        .0
        .iter()
        .map(|word| u64::from(word.count_ones()))
        .sum()
}

#[cfg(test)]
mod tests {
    use glam::UVec3;

    use super::*;

    /// A cube of cubes with gaps between them: much surface.
    fn lattice(edge: u32) -> (Segment, Grid) {
        let dimensions = UVec3::splat(edge);
        let segment = Segment::from_fn(dimensions, |voxel| (voxel % 3).cmpgt(IVec3::ZERO).all());
        let grid = Grid::new(dimensions, DVec3::ONE, DVec3::ZERO, DMat3::IDENTITY);
        (segment, grid.expect("a grid"))
    }

    /// The work of a pass, counted: it neither grows with the surface nor with the others.
    #[test]
    fn a_pass_looks_up_no_more_voxels_than_it_may_whatever_is_held_among_however_many() {
        let (segment, grid) = lattice(120);
        let surface = HeldSurface::of(&segment, &grid);
        assert!(surface.middles.len() > MOST_SAMPLES / 2 && surface.middles.len() <= MOST_SAMPLES);
        let other = || Other {
            bits: segment.occupancy(),
            bounds: segment.bounding_box().expect("it has voxels"),
            grid_from_scene: grid.grid_from_patient(),
            smallest_spacing: 1.0,
        };
        for count in [0, 1, 3, 40, 255] {
            let others: Vec<_> = (0..count).map(|_| other()).collect();
            let others: Vec<_> = others.iter().collect();
            let wanted = surface.middles.len() * count * FEWEST_TESTS;
            let mut walk = Walk {
                surface: &surface,
                step: 1.0,
                others: &others,
                middle: DVec3::splat(60.0),
                pose: DAffine3::IDENTITY,
                inside: usize::MAX,
                stride: wanted.div_ceil(MOST_LOOKUPS).max(1),
                tests: 0,
                lookups: 0,
            };
            walk.look_up(&DAffine3::IDENTITY);
            walk.go(DAffine3::from_translation(DVec3::X * 50.0));
            assert!(walk.lookups <= MOST_LOOKUPS, "{count}: {}", walk.lookups);
            assert!(walk.tests >= FEWEST_TESTS - 1, "{count}: {}", walk.tests);
        }
    }

    #[test]
    fn others_far_from_the_way_are_not_looked_at_and_those_on_it_are() {
        let (segment, grid) = lattice(24);
        let surface = HeldSurface::of(&segment, &grid);
        let standing_at = |x: f64| Other {
            bits: segment.occupancy(),
            bounds: segment.bounding_box().expect("it has voxels"),
            grid_from_scene: grid.grid_from_patient() * DAffine3::from_translation(-x * DVec3::X),
            smallest_spacing: 1.0,
        };
        let others = [standing_at(500.0), standing_at(30.0), standing_at(-500.0)];
        let ends = |x: f64| (DAffine3::IDENTITY, DAffine3::from_translation(x * DVec3::X));
        let middle = DVec3::splat(12.0);
        assert_eq!(surface.near(&others, ends(1.0), middle).len(), 1);
        assert_eq!(surface.near(&others, ends(490.0), middle).len(), 3);
        // its cubes meet those of the one beside it where it would go through
        let stopped = surface.way(&others, (DAffine3::IDENTITY, ends(20.0).1));
        assert!(stopped.translation.x < 12.0, "{stopped}");
    }
}
