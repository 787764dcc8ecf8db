//! The worlds that a probe is moved in. Frame: their own grid.

use glam::{DVec3, IVec3};
use palpate_volume::bits::Bits;
use palpate_volume::segment::Segment;

use super::dense::Dense;
use super::plan::{Plan, Terrain};
use crate::random::Random;

/// Voxels along each edge of a world.
pub const SIZE: i32 = 56;

/// Places of bone tried for one that has a surface.
const TRIES: usize = 1000;

/// Voxels of a world, and those that no edit may change: walls, and a border all around, so
/// that nothing ever leaves the world.
#[derive(Debug)]
pub struct World {
    /// What is solid.
    pub dense: Dense,
    /// What stays as it is.
    pub fixed: Dense,
}

impl World {
    /// Makes the world of a plan.
    pub fn new(plan: &Plan, bone: Option<&Bits>, random: &mut Random) -> Self {
        let middle = DVec3::splat(f64::from(SIZE) / 2.0);
        match (plan.terrain, bone) {
            (Terrain::Walls { normal, apart }, _) => {
                let middle = middle + random.in_box(DVec3::NEG_ONE, DVec3::ONE) * 4.0;
                Self::of_walls(|voxel| {
                    let offset = normal.dot(voxel.as_dvec3() - middle);
                    is_in_plane(normal, offset)
                        || apart > 0.0 && is_in_plane(normal, offset - apart * normal.length())
                })
            }
            (Terrain::Shell { radius }, _) => {
                let inside = |voxel: IVec3| (voxel.as_dvec3() + 0.5).distance(middle) < radius;
                Self::of_walls(|voxel| {
                    let faces = IVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
                    inside(voxel) && faces.into_iter().any(|face| !inside(voxel + face))
                })
            }
            (Terrain::Noise { share }, _) => Self::of_material(|_| random.share() < share),
            (Terrain::Bone, Some(bone)) => {
                let corner = corner_of_bone(bone, random);
                Self::of_material(|voxel| bone.is_solid(corner + voxel))
            }
            (Terrain::Bone, None) => Self::of_material(|_| false),
        }
    }

    fn of_walls(solid: impl Fn(IVec3) -> bool) -> Self {
        let dense = Dense::from_fn(IVec3::splat(SIZE), |voxel| is_border(voxel) || solid(voxel));
        Self {
            fixed: dense.clone(),
            dense,
        }
    }

    fn of_material(mut solid: impl FnMut(IVec3) -> bool) -> Self {
        let size = IVec3::splat(SIZE);
        Self {
            dense: Dense::from_fn(size, |voxel| solid(voxel) || is_border(voxel)),
            fixed: Dense::from_fn(size, is_border),
        }
    }

    /// The voxels as touch has them.
    pub fn bits(&self) -> Bits {
        let size = self.dense.size().as_uvec3();
        let segment = Segment::from_mask(size, self.dense.bytes());
        segment.expect("one byte per voxel").occupancy().clone()
    }
}

fn is_border(voxel: IVec3) -> bool {
    voxel.cmpeq(IVec3::ZERO).any() || voxel.cmpeq(IVec3::splat(SIZE - 1)).any()
}

/// The thinnest digital plane that no way through faces crosses.
fn is_in_plane(normal: DVec3, offset: f64) -> bool {
    let half = normal.abs().max_element() / 2.0;
    -half <= offset && offset < half
}

/// The corner of a part of the bone with a surface in its middle.
fn corner_of_bone(bone: &Bits, random: &mut Random) -> IVec3 {
    let size = bone.dimensions().as_dvec3();
    let mut middle = bone.dimensions().as_ivec3() / 2;
    for _ in 0..TRIES {
        let voxel = random.in_box(DVec3::ZERO, size).as_ivec3();
        if bone.is_solid(voxel) {
            middle = voxel;
            let is_surface = IVec3::AXES
                .into_iter()
                .any(|axis| !bone.is_solid(voxel + axis));
            if is_surface {
                break;
            }
        }
    }
    middle - SIZE / 2
}
