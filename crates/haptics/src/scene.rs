//! What is touched at once: the world, and objects that were moved out of it.
//!
//! The world is body 0: all that stands unmoved in the scan's own grid. Objects are bodies
//! 1 and up: each has its own voxels, its own grid and a rigid pose. The probe is a point of
//! the world's grid, whatever it touches; the voxel of an object that it is in is, by
//! definition, the floor of [`ObjectPose::to_object`], computed just as it stands there. So
//! what is tested on the way is what a checker would compute afterwards.
//!
//! Frames: `world` and `object` are the grid frames of the two, in voxels; the scene is the
//! patient frame of the world's scan [mm], `object scene` that of the object's scan.

use glam::{DAffine3, DMat3, DVec3, IVec3};
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::walk::COORDINATE_LIMIT;

/// Most objects of a scene; further ones are not touched.
pub const MAX_OBJECTS: usize = 16;

/// What is touched; constant during a tick.
#[derive(Debug)]
pub struct TouchScene<'a, O> {
    /// What is solid in the world.
    pub occupancy: &'a O,
    /// The grid that the world stands in.
    pub grid: &'a Grid,
    /// The objects, at most [`MAX_OBJECTS`].
    pub objects: &'a [Object<O>],
}

impl<'a, O> TouchScene<'a, O> {
    /// A world without objects.
    pub fn of_world(occupancy: &'a O, grid: &'a Grid) -> Self {
        Self {
            occupancy,
            grid,
            objects: &[],
        }
    }
}

impl<O: Occupancy> TouchScene<'_, O> {
    /// The solid voxel that holds a point of the world's grid, of the first body that has one.
    pub fn solid_at(&self, point_in_world: DVec3) -> Option<Solid> {
        let voxel = point_in_world.floor().as_ivec3();
        if self.occupancy.is_solid(voxel) {
            return Some(Solid::of_world(voxel));
        }
        let objects = (1..).zip(self.objects.iter().take(MAX_OBJECTS));
        objects.into_iter().find_map(|(body, object)| {
            let voxel = object.solid_at(point_in_world)?;
            Some(Solid { body, voxel })
        })
    }
}

impl<O> Clone for TouchScene<'_, O> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<O> Copy for TouchScene<'_, O> {}

/// A solid voxel of one of the bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Solid {
    /// 0 for the world, else the place of the object in its scene plus one.
    pub body: u8,
    /// The voxel, in the grid of that body.
    pub voxel: IVec3,
}

impl Solid {
    /// A voxel of the world.
    pub fn of_world(voxel: IVec3) -> Self {
        Self { body: 0, voxel }
    }
}

/// A body that was moved: its voxels and where they stand.
#[derive(Clone, Copy, Debug)]
pub struct Object<O> {
    occupancy: O,
    spacing: DVec3,
    bounds: VoxelBox,
    pose: ObjectPose,
    /// Corners of a box along the world's axes that holds all of it, with room to spare [mm
    /// from the corner of the world's grid].
    low: DVec3,
    high: DVec3,
}

impl<O> Object<O> {
    /// An object of the grid for which `pose` was made; every solid voxel of `occupancy` must be
    /// within `bounds`, which may reach over the border of the grid.
    pub fn new(occupancy: O, grid: &Grid, bounds: VoxelBox, pose: ObjectPose) -> Self {
        let (low, high) = box_in_world(bounds, &pose);
        Self {
            occupancy,
            spacing: grid.spacing(),
            bounds,
            pose,
            low,
            high,
        }
    }

    /// The same place with other voxels, such as those of a probe's centre; see [`Self::new`].
    pub fn with_occupancy<P>(&self, occupancy: P, bounds: VoxelBox) -> Object<P> {
        let (low, high) = box_in_world(bounds, &self.pose);
        Object {
            occupancy,
            spacing: self.spacing,
            bounds,
            pose: self.pose,
            low,
            high,
        }
    }

    /// Tells another box that holds every solid voxel, see [`Self::new`].
    pub fn set_bounds(&mut self, bounds: VoxelBox) {
        self.bounds = bounds;
        (self.low, self.high) = box_in_world(bounds, &self.pose);
    }

    /// Moves it there at once; whether the probe admits that is asked in `admission/motion.rs`.
    pub fn set_pose(&mut self, pose: ObjectPose) {
        self.pose = pose;
        (self.low, self.high) = box_in_world(self.bounds, &pose);
    }

    /// Voxels of the object.
    pub fn occupancy(&self) -> &O {
        &self.occupancy
    }

    /// Voxels of the object, to be changed; they must stay within the bounds.
    pub fn occupancy_mut(&mut self) -> &mut O {
        &mut self.occupancy
    }

    /// Size of its voxels along its own axes [mm].
    pub fn spacing(&self) -> DVec3 {
        self.spacing
    }

    /// A box of its grid that holds every solid voxel.
    pub fn bounds(&self) -> VoxelBox {
        self.bounds
    }

    /// Pose of the object.
    pub fn pose(&self) -> &ObjectPose {
        &self.pose
    }

    /// Corners of a box along the axes of the world's grid that holds it with room to spare
    /// [mm from the corner of that grid]; empty (low > high) where it has no voxels.
    pub fn box_in_world(&self) -> (DVec3, DVec3) {
        (self.low, self.high)
    }
}

impl<O: Occupancy> Object<O> {
    /// The solid voxel that holds a point of the world's grid, if one does.
    pub fn solid_at(&self, point_in_world: DVec3) -> Option<IVec3> {
        let voxel = self.pose.voxel_at(point_in_world);
        self.occupancy.is_solid(voxel).then_some(voxel)
    }
}

/// Why a pose cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PoseError {
    /// NaN or infinity.
    #[error("a pose of {0} given; allowed: finite numbers")]
    NotFinite(DAffine3),
    /// Scale or shear.
    #[error("axes {0} given; allowed: a rotation (orthonormal within {ROTATION_TOLERANCE})")]
    NotRigid(DMat3),
    /// Left and right exchanged.
    #[error("axes {0} given; allowed: a rotation, no reflection")]
    Reflection(DMat3),
    /// Farther than any traversal goes.
    #[error("a translation of {0} mm given; allowed: what {limit} voxels reach", limit = COORDINATE_LIMIT / 4.0)]
    TooFar(DVec3),
}

/// How far the axes of a pose may be from orthonormal: what is left of a product of many
/// rotations, and a micrometre on a metre.
const ROTATION_TOLERANCE: f64 = 1e-6;

/// Where an object stands in the world, as maps between the grids of the two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectPose {
    scene_from_object_scene: DAffine3,
    object_from_world: DAffine3,
    world_from_object: DAffine3,
    /// Size of the world's voxels [mm].
    world_spacing: DVec3,
}

impl ObjectPose {
    /// Puts an object of one grid into the world of another; `scene_from_object_scene` takes
    /// LPS mm of the object's own scan to LPS mm of the world's.
    ///
    /// # Errors
    /// Where the pose is no rigid motion, or leads farther than traversals reach.
    pub fn new(
        object: &Grid,
        world: &Grid,
        scene_from_object_scene: DAffine3,
    ) -> Result<Self, PoseError> {
        check_rigid(&scene_from_object_scene)?;
        let object_scene_from_scene = scene_from_object_scene.inverse();
        let pose = Self {
            scene_from_object_scene,
            object_from_world: object.grid_from_patient()
                * object_scene_from_scene
                * world.patient_from_grid(),
            world_from_object: world.grid_from_patient()
                * scene_from_object_scene
                * object.patient_from_grid(),
            world_spacing: world.spacing(),
        };
        let reaches = farthest(&pose.object_from_world, world.bounds())
            .max(farthest(&pose.world_from_object, object.bounds()));
        // written so that NaN is refused
        if reaches <= COORDINATE_LIMIT / 4.0 {
            Ok(pose)
        } else {
            Err(PoseError::TooFar(scene_from_object_scene.translation))
        }
    }

    /// The rigid motion that it was made from [mm].
    pub fn scene_from_object_scene(&self) -> DAffine3 {
        self.scene_from_object_scene
    }

    /// Takes points of the world's grid to the object's.
    pub fn object_from_world(&self) -> &DAffine3 {
        &self.object_from_world
    }

    /// Takes points of the object's grid to the world's.
    pub fn world_from_object(&self) -> &DAffine3 {
        &self.world_from_object
    }

    /// A point of the world's grid in the object's grid: the one map that decides in which
    /// voxel of the object a point is.
    #[inline]
    pub fn to_object(&self, point_in_world: DVec3) -> DVec3 {
        self.object_from_world.transform_point3(point_in_world)
    }

    /// The outward normal of a voxel's face, given in the object's grid, as a unit vector along
    /// the axes of the world's grid [mm].
    pub(crate) fn normal_in_world(&self, normal: DVec3) -> DVec3 {
        // the gradient of the object's coordinate across the face
        let gradient = self.object_from_world.matrix3.transpose() * normal;
        (gradient / self.world_spacing).normalize_or_zero()
    }

    /// The voxel of the object that holds a point of the world's grid.
    #[inline]
    pub fn voxel_at(&self, point_in_world: DVec3) -> IVec3 {
        self.to_object(point_in_world).floor().as_ivec3()
    }
}

/// Refuses what is not a rotation and a translation.
pub(crate) fn check_rigid(pose: &DAffine3) -> Result<(), PoseError> {
    let axes = pose.matrix3;
    if !pose.is_finite() {
        return Err(PoseError::NotFinite(*pose));
    }
    if !(axes.transpose() * axes).abs_diff_eq(DMat3::IDENTITY, ROTATION_TOLERANCE) {
        return Err(PoseError::NotRigid(axes));
    }
    if axes.determinant() < 0.0 {
        return Err(PoseError::Reflection(axes));
    }
    Ok(())
}

/// The largest coordinate of a box's corners after a map.
fn farthest(map: &DAffine3, voxels: VoxelBox) -> f64 {
    let far = corners(voxels).map(|corner| map.transform_point3(corner).abs().max_element());
    // `max` forgets NaN, addition does not
    let sum: f64 = far.iter().sum();
    if sum.is_finite() {
        far.into_iter().fold(0.0, f64::max)
    } else {
        f64::INFINITY
    }
}

/// The corners of a box of voxels.
pub(crate) fn corners(voxels: VoxelBox) -> [DVec3; 8] {
    let [min, max] = [voxels.min.as_dvec3(), voxels.max.as_dvec3()];
    std::array::from_fn(|i| {
        let high = |axis: usize| i >> axis & 1 == 1;
        DVec3::from_array(std::array::from_fn(|axis| {
            if high(axis) { max[axis] } else { min[axis] }
        }))
    })
}

/// Corners of the box along the world's axes [mm] around an object's bounds and one voxel of
/// either grid more, which is far more than rounding.
fn box_in_world(bounds: VoxelBox, pose: &ObjectPose) -> (DVec3, DVec3) {
    if bounds.is_empty() {
        return (DVec3::INFINITY, DVec3::NEG_INFINITY);
    }
    let in_world = corners(bounds.dilate(1))
        .map(|corner| pose.world_from_object.transform_point3(corner) * pose.world_spacing);
    let low = in_world.into_iter().fold(DVec3::INFINITY, DVec3::min);
    let high = in_world.into_iter().fold(DVec3::NEG_INFINITY, DVec3::max);
    (low - pose.world_spacing, high + pose.world_spacing)
}
