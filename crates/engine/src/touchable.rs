//! All that can be touched: the union of the segments that stand where the scan has them, the
//! segments that were moved, and which segment owns what.
//!
//! The servo reads one set of bits however many segments there are, so that its work per visit
//! stays the same; only a segment that was moved is a body of its own. Bricks that one segment
//! alone has are shared with it; only where segments overlap is a new brick made.
//!
//! Frame: grid of the scan; a moved segment keeps that grid, and has a pose.

use std::sync::Arc;

use glam::{DAffine3, UVec3};
use palpate_haptics::ball::BallError;
use palpate_haptics::scene::{Object, ObjectPose, TouchScene};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::voxel_box::VoxelBox;

use crate::body::Body;
use crate::known_shares::KnownShares;
use crate::scan_values::Threshold;

/// A segment that can be touched.
#[derive(Clone, Debug)]
pub struct Part {
    /// Which segment.
    pub id: SegmentId,
    /// Its voxels.
    pub bits: Bits,
    /// A box that holds them, where it was moved; none where it stands in the scan.
    pub moved: Option<VoxelBox>,
    /// The threshold that made them, whatever edits did since; none where they come from
    /// elsewhere.
    pub threshold: Option<Threshold>,
}

/// All that can be touched, ready for the servo.
#[derive(Debug)]
pub struct Touchable {
    /// The union of all parts that were not moved.
    pub world: Body,
    /// All parts, by rising number.
    pub parts: Vec<Part>,
    /// The parts that were moved, in the order of `parts`.
    pub objects: Vec<Object<Body>>,
    /// Radius of the probe [mm].
    pub radius: f64,
}

impl Touchable {
    /// These parts of a scan, by rising number, for a probe of a radius [mm]; moved ones stand
    /// in the scan still.
    ///
    /// # Errors
    /// Where the ball is too large for the scan's voxels.
    pub fn new(grid: &Grid, parts: Vec<Part>, radius: f64) -> Result<Self, BallError> {
        let unmoved: Vec<&Part> = unmoved(&parts).collect();
        let bits: Vec<&Bits> = unmoved.iter().map(|part| &part.bits).collect();
        let world = Body::new(union_of(grid.dimensions(), &bits), radius, grid.spacing())?
            .knowing(KnownShares::of(&unmoved));
        let reach = world.reach();
        let pose = ObjectPose::new(grid, grid, DAffine3::IDENTITY)
            .expect("a segment that was not moved yet is within reach");
        let object = |part: &Part, bounds: VoxelBox| {
            let body = Body::new(part.bits.clone(), radius, grid.spacing())?
                .knowing(KnownShares::of(&[part]));
            let bounds = if bounds.is_empty() {
                bounds
            } else {
                VoxelBox::new(bounds.min - reach, bounds.max + reach)
            };
            Ok(Object::new(body, grid, bounds, pose))
        };
        let objects = parts
            .iter()
            .filter_map(|part| Some(object(part, part.moved?)))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            world,
            parts,
            objects,
            radius,
        })
    }

    /// What is touched, as ticks and placements want it.
    #[must_use]
    pub fn scene<'a>(&'a self, grid: &'a Grid) -> TouchScene<'a, Body> {
        TouchScene {
            occupancy: &self.world,
            grid,
            objects: &self.objects,
        }
    }

    /// Puts objects where their segments stand; without a rigid pose they stay.
    pub fn put_objects(&mut self, grid: &Grid, pose_of: impl Fn(SegmentId) -> Option<DAffine3>) {
        for place in 0..self.objects.len() {
            let pose = self.object_ids().nth(place).and_then(&pose_of);
            let pose = pose.and_then(|pose| ObjectPose::new(grid, grid, pose).ok());
            if let Some(pose) = pose {
                self.objects[place].set_pose(pose);
            }
        }
    }

    /// Numbers of the moved segments, in the order of the objects.
    pub fn object_ids(&self) -> impl Iterator<Item = SegmentId> {
        let moved = self.parts.iter().filter(|part| part.moved.is_some());
        moved.map(|part| part.id)
    }

    /// The segment to which a solid voxel of a body belongs: of the world's, the first that
    /// has it.
    #[must_use]
    pub fn owner(&self, body: u8, voxel: glam::IVec3) -> Option<SegmentId> {
        match usize::from(body).checked_sub(1) {
            Some(place) => self.object_ids().nth(place),
            None => {
                let voxel = self.world.solid_near(voxel)?;
                unmoved(&self.parts)
                    .find(|part| part.bits.is_solid(voxel))
                    .map(|part| part.id)
            }
        }
    }

    /// Exchanges a brick of a part, if it is there.
    pub fn swap_part(&mut self, id: SegmentId, swap: &mut BrickSwap<BitBrick>) {
        if let Ok(place) = self.parts.binary_search_by_key(&id.0, |part| part.id.0) {
            // the old brick is in the part still, so that this frees nothing
            self.world.swap_part(id, &mut swap.clone());
            self.parts[place].bits.swap(swap);
        }
    }
}

/// Parts that stand where the scan has them.
pub fn unmoved(parts: &[Part]) -> impl Iterator<Item = &Part> {
    parts.iter().filter(|part| part.moved.is_none())
}

/// The union of segments of one grid.
#[must_use]
pub fn union_of(dimensions: UVec3, segments: &[&Bits]) -> Bits {
    let Some((first, rest)) = segments.split_first() else {
        return Bits::empty(dimensions);
    };
    let mut union = (*first).clone();
    for segment in rest {
        for (index, brick) in (0..).zip(segment.bricks().entries()) {
            let Some(brick) = brick else { continue };
            let merged = merged(union.bricks().get(index), brick);
            union.swap(&mut BrickSwap {
                index,
                brick: Some(merged),
            });
        }
    }
    union
}

/// One brick of the union.
#[must_use]
pub fn union_brick<'a>(
    segments: impl Iterator<Item = &'a Bits>,
    index: u32,
) -> Option<Arc<BitBrick>> {
    segments
        .filter_map(|segment| segment.bricks().get(index))
        .fold(None, |union, brick| Some(merged(union.as_ref(), brick)))
}

fn merged(union: Option<&Arc<BitBrick>>, brick: &Arc<BitBrick>) -> Arc<BitBrick> {
    let Some(union) = union else {
        return Arc::clone(brick);
    };
    let both = BitBrick(std::array::from_fn(|z| union.0[z] | brick.0[z]));
    // where one holds the other it is shared, not copied
    if both == **union {
        Arc::clone(union)
    } else if both == **brick {
        Arc::clone(brick)
    } else {
        both.shared()
            .expect("the union of two bricks is not empty where one of them is not")
    }
}
