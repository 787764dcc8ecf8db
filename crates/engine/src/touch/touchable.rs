//! All that can be touched: the union of the segments that stand where the scan has them, the
//! segments that were moved, and which segment owns what.
//!
//! The servo reads one set of bits however many segments there are, so that its work per visit
//! stays the same; only a segment that was moved is a body of its own. Bricks that one segment
//! alone has are shared with it; only where segments overlap is a new brick made.
//!
//! Frame: grid of the scan; a moved segment keeps that grid, or has one of its own, and a pose.

use std::sync::Arc;

use glam::{IVec3, UVec3};
use palpate_haptics::admission::{self, PoseStep};
use palpate_haptics::ball::{BallError, BallShape, ProbeSolid, ball_limits};
use palpate_haptics::contact::{ExactLimits, Proxy};
use palpate_haptics::scene::{Object, ObjectPose, Solid, TouchScene};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::occupancy_fractions::FractionBrick;
use palpate_volume::voxel_box::VoxelBox;

use crate::touch::body::BodyVoxels;
use crate::touch::occupancy_fractions::BodyFractions;
use crate::touch::part::{MovedPart, Part};

/// Voxels of one body as the probe meets them.
pub type Body = ProbeSolid<BodyVoxels>;

/// All that can be touched, ready for the servo.
#[derive(Debug)]
pub struct Touchable {
    /// The union of all parts that were neither moved nor punctured.
    pub world: Body,
    /// All parts, by rising number.
    pub parts: Vec<Part>,
    /// The parts that were moved, in the order of `parts`; one that is punctured has no voxels here.
    pub objects: Vec<Object<Body>>,
    /// Of each object the place of its part; none of one that is made of none.
    pub object_parts: Vec<usize>,
    /// Radius of the probe [mm].
    pub radius: f64,
}

impl Touchable {
    /// These parts of a scan, by rising number, for a probe of a radius [mm]; moved ones stand
    /// where their pose has them.
    ///
    /// # Errors
    /// Where the ball is too large for the voxels of one of the grids.
    ///
    /// # Panics
    /// Where a pose is none; whoever gives parts a pose has checked it.
    pub fn new(grid: &Grid, parts: Vec<Part>, radius: f64) -> Result<Self, BallError> {
        let world = BodyVoxels {
            bits: union_of(grid.dimensions(), &unmoved_bits(&parts)),
            fractions: BodyFractions::of(grid.dimensions(), &unmoved(&parts).collect::<Vec<_>>()),
        };
        let world = Body::new(world, radius, grid.spacing())?;
        let object = |part: &Part, moved: MovedPart| {
            let MovedPart { bounds, pose, .. } = moved;
            let own = moved.grid(grid);
            // where a needle is in it, it stands there still, but is no obstacle
            let voxels = if part.punctured {
                BodyVoxels::from(Bits::empty(part.bits.dimensions()))
            } else {
                BodyVoxels {
                    bits: part.bits.clone(),
                    fractions: BodyFractions::of(part.bits.dimensions(), &[part]),
                }
            };
            let body = Body::new(voxels, radius, own.spacing())?;
            let reach = body.shape().reach();
            let bounds = if bounds.is_empty() {
                bounds
            } else {
                VoxelBox::new(bounds.min - reach, bounds.max + reach)
            };
            let pose = ObjectPose::new(own, grid, pose).expect("poses of parts were checked");
            Ok(Object::new(body, own, bounds, pose))
        };
        let objects = parts
            .iter()
            .filter_map(|part| Some(object(part, part.moved?)))
            .collect::<Result<_, _>>()?;
        let moved = |(_, part): &(usize, &Part)| part.moved.is_some();
        let places = parts.iter().enumerate().filter(moved);
        let object_parts = places.map(|(place, _)| place).collect();
        Ok(Self {
            world,
            parts,
            objects,
            object_parts,
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

    /// How much work a tick of `exact` may do with this probe.
    #[must_use]
    pub fn limits(&self) -> ExactLimits {
        // finer voxels cost a ball more
        let strictest = |limits: ExactLimits, body: &Body| {
            let own = ball_limits(body.shape());
            ExactLimits {
                max_visits: limits.max_visits.min(own.max_visits),
                max_slides: limits.max_slides.min(own.max_slides),
            }
        };
        let objects = self.objects.iter().map(Object::occupancy);
        objects.fold(ball_limits(self.world.shape()), strictest)
    }

    /// The next radius on the way to another one that no body finds too large a step [mm].
    #[must_use]
    pub fn radius_toward(&self, radius: f64) -> f64 {
        let objects = self.objects.iter().map(Object::occupancy);
        let steps = objects.map(|body| body.shape().toward(radius));
        steps.fold(self.world.shape().toward(radius), f64::min)
    }

    /// The moved segments as the parts have them, in the order of the objects.
    pub fn moved(&self) -> impl Iterator<Item = (SegmentId, MovedPart)> {
        let moved = |part: &Part| Some((part.id, part.moved?));
        self.parts.iter().filter_map(moved)
    }

    /// The part of which an object is made, by its place.
    #[must_use]
    pub fn moved_part(&self, place: usize) -> Option<&Part> {
        self.parts.get(*self.object_parts.get(place)?)
    }

    /// The place of a moved segment among the objects.
    #[must_use]
    pub fn object_of(&self, id: SegmentId) -> Option<usize> {
        self.moved().position(|(other, _)| other == id)
    }

    /// The grid that a moved segment has of its own, if it has one.
    #[must_use]
    pub fn own_grid_of(&self, id: SegmentId) -> Option<&Grid> {
        let part = self.parts.iter().find(|part| part.id == id)?;
        part.moved.as_ref()?.own_grid.as_ref()
    }

    /// Takes a step of an object to a pose, if the probe admits it, who may be pushed.
    pub fn step_pose(
        &mut self,
        place: usize,
        new: &ObjectPose,
        grid: &Grid,
        proxy: &mut Proxy,
    ) -> PoseStep {
        let step = admission::step_pose(&self.scene(grid), place, new, proxy);
        if step != PoseStep::Held
            && let Some(object) = self.objects.get_mut(place)
        {
            object.set_pose(*new);
        }
        step
    }

    /// The segment to which a voxel belongs that is solid for the probe: where the world's overlap,
    /// the last, as in the picture, and as materials and needles have it.
    #[must_use]
    pub fn owner(&self, solid: Solid) -> Option<SegmentId> {
        match usize::from(solid.body).checked_sub(1) {
            Some(place) => self.moved().nth(place).map(|(id, _)| id),
            None => self.owner_in_world(solid.voxel),
        }
    }

    fn owner_in_world(&self, voxel: IVec3) -> Option<SegmentId> {
        let mut parts = unmoved(&self.parts);
        let first = parts.next()?;
        // where there is but one, all of the world is its own
        if parts.next().is_none() {
            return Some(first.id);
        }
        let voxel = self.world.solid_near(voxel)?;
        let owner = unmoved(&self.parts).rfind(|part| part.bits.is_solid(voxel));
        owner.map(|part| part.id)
    }

    /// Gives the probe another radius [mm] at once; whether the probe admits it is asked before.
    ///
    /// # Errors
    /// Where the ball is too large for the voxels of one of the grids; nothing is changed then.
    pub fn set_radius(&mut self, radius: f64) -> Result<(), BallError> {
        if self.radius == radius {
            return Ok(());
        }
        for object in &self.objects {
            BallShape::new(radius, object.spacing())?;
        }
        self.world.set_radius(radius)?;
        for object in &mut self.objects {
            object.set_radius(radius)?;
        }
        self.radius = radius;
        Ok(())
    }

    /// Exchanges a brick of the union.
    pub fn swap_world(&mut self, swap: &mut BrickSwap<BitBrick>) {
        let changed = self.world.inner().bits.bricks().box_of(swap.index);
        self.world.change(&changed, |voxels| voxels.bits.swap(swap));
    }

    /// Forgets the occupancy fractions of parts: bodies have their own, and whoever works them out
    /// would have to copy them as long as somebody else has them.
    pub fn forget_fractions_of_parts(&mut self) {
        for part in &mut self.parts {
            part.fractions = None;
        }
    }

    /// Exchanges a brick of what is known of the occupancy fractions of the union.
    pub fn swap_fractions(&mut self, swap: &mut BrickSwap<FractionBrick>) {
        // what a ball can be in follows from bits alone
        self.world.change(&VoxelBox::EMPTY, |voxels| {
            if let Some(fractions) = &mut voxels.fractions {
                fractions.swap_fractions(swap);
            }
        });
    }

    /// Exchanges a brick of a part, if it is there.
    pub fn swap_part(&mut self, id: SegmentId, swap: &mut BrickSwap<BitBrick>) {
        let Ok(place) = self.parts.binary_search_by_key(&id.0, |part| part.id.0) else {
            return;
        };
        let changed = self.world.inner().bits.bricks().box_of(swap.index);
        self.world.change(&changed, |voxels| {
            if let Some(fractions) = &mut voxels.fractions {
                // the old brick is in the part still, so that this frees nothing
                fractions.swap_part(id, &mut swap.clone());
            }
        });
        self.parts[place].bits.swap(swap);
    }
}

/// Parts that are obstacles where the scan has them: neither moved nor punctured.
pub fn unmoved(parts: &[Part]) -> impl DoubleEndedIterator<Item = &Part> {
    let stands = |part: &&Part| part.moved.is_none() && !part.punctured;
    parts.iter().filter(stands)
}

/// Their voxels.
#[must_use]
pub fn unmoved_bits(parts: &[Part]) -> Vec<&Bits> {
    unmoved(parts).map(|part| &part.bits).collect()
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
pub fn union_brick(segments: &[&Bits], index: u32) -> Option<Arc<BitBrick>> {
    segments
        .iter()
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
