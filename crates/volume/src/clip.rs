//! What is cut away of a scene: all that lies before any of some planes, and which voxels of a
//! grid that are. A voxel is cut away where its centre is.
//!
//! The picture cuts at the same planes (`viewer/src/core/view/clip.ts`, its shader `clip.glsl`,
//! and `palpate-render`). Frame: scene for planes, mm; grid for masks.

use std::sync::Arc;

use glam::{DAffine3, DVec3, IVec3};
use thiserror::Error;

use crate::bit_brick::BitBrick;
use crate::bits::Bits;
use crate::brick_grid::BrickSwap;
use crate::grid::Grid;
use crate::segment::Coverage;
use crate::voxel_box::VoxelBox;

/// Planes of a clip, at most: six faces of a box, and free ones.
pub const MAX_CLIP_PLANES: usize = 16;

/// How far the length of a normal may be from 1: pages send them with few digits.
const LENGTH_TOLERANCE: f64 = 1e-3;

/// What lies before a plane is cut away. Frame: scene, LPS mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Unit vector toward what is cut away.
    pub normal: DVec3,
    /// `normal · point` of its points [mm].
    pub offset: f64,
}

/// Planes that are no clip.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum ClipError {
    /// Too many.
    #[error("{0} clip planes given; allowed: at most {MAX_CLIP_PLANES}")]
    TooMany(usize),
    /// Not a plane.
    #[error(
        "clip plane with normal {normal} and offset {offset} given; allowed: finite, a normal of \
         length 1"
    )]
    Plane {
        /// The normal given.
        normal: DVec3,
        /// The offset given [mm].
        offset: f64,
    },
}

/// Planes that cut a scene; none cut nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clip(Vec<Plane>);

impl Clip {
    /// Takes planes of the scene.
    ///
    /// # Errors
    /// Where there are too many, or one is not finite or has no normal of length 1.
    pub fn new(planes: Vec<Plane>) -> Result<Self, ClipError> {
        if planes.len() > MAX_CLIP_PLANES {
            return Err(ClipError::TooMany(planes.len()));
        }
        let is_plane = |plane: &&Plane| {
            // written so that NaN is none
            (plane.normal.length() - 1.0).abs() <= LENGTH_TOLERANCE && plane.offset.is_finite()
        };
        match planes.iter().find(|plane| !is_plane(plane)) {
            Some(&Plane { normal, offset }) => Err(ClipError::Plane { normal, offset }),
            None => Ok(Self(planes)),
        }
    }

    /// Its planes.
    pub fn planes(&self) -> &[Plane] {
        &self.0
    }

    /// Whether it cuts nothing.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// What it cuts away of a grid that stands at a pose [mm, from the scan to the scene].
    pub fn mask(&self, grid: &Grid, scene_from_patient: DAffine3) -> ClipMask {
        let scene_from_grid = scene_from_patient * grid.patient_from_grid();
        let half_space = |plane: &Plane| HalfSpace {
            normal: scene_from_grid.matrix3.transpose() * plane.normal,
            offset: plane.offset - plane.normal.dot(scene_from_grid.translation),
        };
        ClipMask(self.0.iter().map(half_space).collect())
    }
}

/// All points with `normal · point > offset`. Frame: grid.
#[derive(Clone, Copy, Debug, PartialEq)]
struct HalfSpace {
    normal: DVec3,
    offset: f64,
}

impl HalfSpace {
    fn has_centre_of(&self, voxel: IVec3) -> bool {
        self.normal.dot(voxel.as_dvec3() + 0.5) > self.offset
    }

    /// How much of a box that is not empty it leaves. Products and sums round in one direction, so
    /// that no voxel between the two that are asked for is on another side than both.
    fn left_of(&self, voxels: &VoxelBox) -> Coverage {
        let [first, last] = [voxels.min, voxels.max - 1];
        let is_rising = self.normal.cmpgt(DVec3::ZERO);
        if self.has_centre_of(IVec3::select(is_rising, first, last)) {
            Coverage::Empty
        } else if self.has_centre_of(IVec3::select(is_rising, last, first)) {
            Coverage::Mixed
        } else {
            Coverage::Full
        }
    }
}

/// Which voxels of a grid are cut away; none by default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ClipMask(Vec<HalfSpace>);

impl ClipMask {
    /// Whether a voxel is cut away.
    #[inline]
    pub fn cuts(&self, voxel: IVec3) -> bool {
        self.0.iter().any(|half| half.has_centre_of(voxel))
    }

    /// How much it leaves of a box of voxels.
    pub fn left_of(&self, voxels: &VoxelBox) -> Coverage {
        let mut left = Coverage::Full;
        for half in self.0.iter().filter(|_| !voxels.is_empty()) {
            match half.left_of(voxels) {
                Coverage::Empty => return Coverage::Empty,
                Coverage::Mixed => left = Coverage::Mixed,
                Coverage::Full => {}
            }
        }
        left
    }

    /// What is left of a brick with these voxels. Bricks that no plane meets are shared.
    pub fn left_of_brick(&self, brick: &Arc<BitBrick>, voxels: &VoxelBox) -> Option<Arc<BitBrick>> {
        match self.left_of(voxels) {
            Coverage::Empty => None,
            Coverage::Full => Some(Arc::clone(brick)),
            Coverage::Mixed => {
                let is_left = |offset| brick.contains(offset) && !self.cuts(voxels.min + offset);
                BitBrick::from_fn(voxels.size(), is_left).shared()
            }
        }
    }

    /// What is left of the voxels of a segment, brick by brick in parallel.
    #[must_use]
    pub fn left_of_bits(&self, bits: &Bits) -> Bits {
        bits.with_bricks(|brick, voxels| self.left_of_brick(brick, voxels))
    }

    /// Has what is left of a segment follow its voxels in some bricks, by place in the directory.
    pub fn follow(&self, left: &mut Bits, bits: &Bits, bricks: &[u32]) {
        for &index in bricks {
            let brick = bits.bricks().get(index);
            let voxels = bits.bricks().box_of(index);
            let brick = brick.and_then(|brick| self.left_of_brick(brick, &voxels));
            left.swap(&mut BrickSwap { index, brick });
        }
    }
}
