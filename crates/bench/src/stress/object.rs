//! Objects of a run: their voxels, where they stand, and the checker's own map into their grids.
//!
//! Frames: the world's grid, and the object's own.

use glam::{DAffine3, DMat3, DVec3, IVec3, UVec3};
use palpate_haptics::scene::ObjectPose;
use palpate_volume::bits::Bits;
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

use super::dense::Dense;
use super::plan::{Plan, random_spacing};
use crate::random::Random;

/// Voxels along each edge of an object's grid.
const SIZE: i32 = 28;
/// Free voxels around all that is solid in it.
const MARGIN: i32 = 4;

/// An object as the checker knows it.
#[derive(Clone, Debug)]
pub struct Object {
    /// Its voxels.
    pub dense: Dense,
    /// Their size [mm].
    pub spacing: DVec3,
    /// Numbers of the parts of space that it leaves free; 1 is outside.
    parts: Vec<u32>,
    scene_from_world: DAffine3,
    /// Takes points of the world's grid to its own.
    own_from_world: DAffine3,
}

/// An object as touch is given it.
#[derive(Clone, Debug)]
pub struct Made {
    /// Its voxels.
    pub bits: Bits,
    /// Their grid.
    pub grid: Grid,
    /// A box that holds all that is solid.
    pub bounds: VoxelBox,
    /// Where it stands.
    pub pose: ObjectPose,
    /// The same as a rigid motion: LPS mm of its own to those of the scene.
    pub rigid: DAffine3,
}

impl Object {
    /// A shell, a plate or a lump of noise, somewhere in the world of a plan.
    pub fn random(plan: &Plan, world: &Grid, random: &mut Random) -> (Self, Made) {
        let dense = random_voxels(random);
        // as large as a ball can be beside its voxels
        let least = plan.radius * plan.spacing.min_element() / 14.0;
        let spacing = random_spacing(random).max(DVec3::splat(least));
        let grid = Grid::new(
            UVec3::splat(SIZE as u32),
            spacing,
            DVec3::ZERO,
            DMat3::IDENTITY,
        )
        .expect("spacings of plans are valid");
        let rigid = random_pose(plan, world, spacing, random);
        let pose = ObjectPose::new(&grid, world, rigid).expect("random poses are rigid");
        let segment = Segment::from_mask(grid.dimensions(), dense.bytes());
        let made = Made {
            bits: segment.expect("one byte per voxel").occupancy().clone(),
            grid,
            bounds: VoxelBox::new(IVec3::splat(MARGIN), IVec3::splat(SIZE - MARGIN)),
            pose,
            rigid,
        };
        let mut object = Self {
            parts: dense.parts(),
            dense,
            spacing,
            scene_from_world: DAffine3::from_mat3_translation(
                plan.direction * DMat3::from_diagonal(plan.spacing),
                plan.origin - plan.direction * (plan.spacing * 0.5),
            ),
            own_from_world: DAffine3::IDENTITY,
        };
        object.set_pose(&rigid);
        (object, made)
    }

    /// Nothing at all, in the place of an object that is left out.
    pub fn nowhere() -> Self {
        Self {
            dense: Dense::from_fn(IVec3::ZERO, |_| false),
            spacing: DVec3::ONE,
            parts: Vec::new(),
            scene_from_world: DAffine3::IDENTITY,
            own_from_world: DAffine3::IDENTITY,
        }
    }

    /// Puts it somewhere else: out of the world's grid, into the scene, into the object's scene,
    /// into its grid, whose first voxel has its middle at zero.
    pub fn set_pose(&mut self, scene_from_object_scene: &DAffine3) {
        let turn = scene_from_object_scene.matrix3;
        let back = turn.transpose();
        let object_scene_from_scene =
            DAffine3::from_mat3_translation(back, -(back * scene_from_object_scene.translation));
        let own_from_object_scene = DAffine3::from_mat3_translation(
            DMat3::from_diagonal(self.spacing.recip()),
            DVec3::splat(0.5),
        );
        self.own_from_world =
            own_from_object_scene * object_scene_from_scene * self.scene_from_world;
    }

    /// A point of the world in the object's grid.
    pub fn to_own(&self, point_in_world: DVec3) -> DVec3 {
        self.own_from_world.transform_point3(point_in_world)
    }

    /// Whether a voxel is one of its grid, and the free ones around it leave a probe of this
    /// radius [mm] a way around all that is solid.
    pub fn is_inside(&self, voxel: IVec3, radius: f64) -> bool {
        let needed = 2.0 + radius / self.spacing.min_element();
        self.dense.index(voxel).is_some() && needed <= f64::from(MARGIN)
    }

    /// Number of the part of space that a voxel is in; outside is a part as any other.
    pub fn part(&self, voxel: IVec3) -> u32 {
        self.dense.index(voxel).map_or(1, |index| self.parts[index])
    }
}

fn random_voxels(random: &mut Random) -> Dense {
    let middle = DVec3::splat(f64::from(SIZE) / 2.0);
    let within = |voxel: IVec3| {
        voxel.cmpge(IVec3::splat(MARGIN)).all() && voxel.cmplt(IVec3::splat(SIZE - MARGIN)).all()
    };
    let radius = 7.0 + 3.0 * random.share();
    let size = IVec3::splat(SIZE);
    match (3.0 * random.share()) as u32 {
        0 => {
            let inside = |voxel: IVec3| (voxel.as_dvec3() + 0.5).distance(middle) < radius;
            Dense::from_fn(size, |voxel| {
                let faces = IVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
                inside(voxel) && faces.into_iter().any(|face| !inside(voxel + face))
            })
        }
        1 => {
            let normal = random.direction();
            let half = normal.abs().max_element() / 2.0;
            Dense::from_fn(size, |voxel| {
                let offset = normal.dot(voxel.as_dvec3() - middle);
                within(voxel) && -half <= offset && offset < half
            })
        }
        _ => {
            let share = 0.02 + 0.4 * random.share();
            Dense::from_fn(size, |voxel| within(voxel) && random.share() < share)
        }
    }
}

impl Made {
    /// A pose not far from this one, of the same object.
    pub fn pose_near(&self, from: &DAffine3, world: &Grid, random: &mut Random) -> DAffine3 {
        let angle = random.share() * random.share();
        let turn = DMat3::from_axis_angle(random.direction(), angle);
        let way = random.direction() * 12.0 * random.share() * world.smallest_spacing();
        let middle = self.grid.spacing() * (DVec3::splat(f64::from(SIZE) / 2.0) - 0.5);
        let axes = turn * from.matrix3;
        let middle_in_scene = from.transform_point3(middle) + way;
        DAffine3::from_mat3_translation(axes, middle_in_scene - axes * middle)
    }
}

/// A rotation, with the object's middle somewhere in the middle of the world.
fn random_pose(plan: &Plan, world: &Grid, spacing: DVec3, random: &mut Random) -> DAffine3 {
    let angle = std::f64::consts::TAU * random.share();
    let turn = DMat3::from_axis_angle(random.direction(), angle);
    let size = world.dimensions().as_dvec3();
    let middle = random.in_box(size * 0.25, size * 0.75);
    let middle_in_scene = plan.origin + plan.direction * (plan.spacing * (middle - 0.5));
    let own_middle = spacing * (DVec3::splat(f64::from(SIZE) / 2.0) - 0.5);
    DAffine3::from_mat3_translation(turn, middle_in_scene - turn * own_middle)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two maps that were made in different ways, a long way from the origin.
    #[test]
    fn the_checkers_map_is_that_of_the_scene() {
        let mut random = Random(5);
        for number in 0..20 {
            let plan = Plan::new(number, false, &mut random);
            let world = plan.grid();
            let (object, made) = Object::random(&plan, &world, &mut random);
            let point = random.in_box(DVec3::ZERO, DVec3::splat(56.0));
            let off = object.to_own(point) - made.pose.to_object(point);
            // rounding of places some 1000 mm from the origin
            assert!(off.abs().max_element() < 1e-9, "{off}");
            let held = made
                .bounds
                .voxels()
                .filter(|&v| made.bits.is_solid(v))
                .count();
            let all = object
                .dense
                .bytes()
                .iter()
                .filter(|&&byte| byte != 0)
                .count();
            assert!(held == all && all > 0);
            assert_eq!(object.part(IVec3::ZERO), 1);
            assert_eq!(object.part(IVec3::splat(-5)), 1);
        }
    }
}
