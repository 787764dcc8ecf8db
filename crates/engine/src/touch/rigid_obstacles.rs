//! Rigid obstacles, by themselves: where they stop a tool that a model of deformation leads.
//!
//! The proxy stands free of everything. From there the tool goes on to where soft tissue would have
//! it, through the voxels of that matter, by the contact model of touch among all others: segments
//! without a material, those that were moved, voxels that belong to such a one too, and what
//! regions make rigid of the deformable ones. So a model that is wrong, late or at its limits
//! brings no tool into bone.
//!
//! Nothing here allocates after it was made; frame: scene [mm].

use arrayvec::ArrayVec;
use glam::{DVec3, IVec3};
use palpate_haptics::ball::{Ball, ProbeView};
use palpate_haptics::contact::{ContactModel, Exact, Proxy};
use palpate_haptics::scene::{MAX_OBJECTS, Solid, TouchScene};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::edit::SegmentId;
use palpate_volume::first_solid::Traversal;
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::segment_set::SegmentSet;

use crate::touch::part::Part;
use crate::touch::touchable::{Body, Touchable, unmoved};

/// Where a tool was stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HardStop {
    /// Where it is held [mm].
    pub tool: DVec3,
    /// What holds it; none where the work of a tick ended first.
    pub by: Option<SegmentId>,
}

/// What is touched, and what of it is soft.
#[derive(Clone, Copy, Debug)]
pub struct RigidWorld<'a> {
    /// What is touched.
    pub touchable: &'a Touchable,
    /// Changes with whatever is touched.
    pub version: u64,
    /// The grid of the scan.
    pub grid: &'a Grid,
    /// Segments that are soft where nothing rigid has their voxels too.
    pub soft: SegmentSet,
}

/// The cells that hard voxels block for a ball, as far as they were asked for; they change no
/// result.
#[derive(Debug)]
pub struct RigidObstacles {
    ball: Ball,
    known: Option<(u64, SegmentSet)>,
}

impl RigidObstacles {
    /// Of a probe that is told with each question.
    #[must_use]
    pub fn new(touchable: &Touchable) -> Self {
        Self {
            ball: Ball::new(*touchable.world.shape()),
            known: None,
        }
    }

    /// What stops a tool on its way from the free proxy, with all that does not belong to `soft`
    /// alone, or is rigid in it; none where nothing does. `version` changes with whatever is
    /// touched; `visits` counts voxels that were read.
    pub fn stop(
        &mut self,
        world: RigidWorld<'_>,
        proxy: &Proxy,
        tool: DVec3,
        visits: &mut u32,
    ) -> Option<HardStop> {
        let RigidWorld {
            touchable,
            version,
            grid,
            soft,
        } = world;
        let target = grid.grid_from_patient().transform_point3(tool);
        let voxels = HardVoxels {
            parts: &touchable.parts,
            soft,
        };
        let has_any = voxels.has_any() || !touchable.objects.is_empty();
        if !has_any || Proxy::at(target).is_none() {
            return None;
        }
        if self.known != Some((version, soft)) {
            self.ball.set_shape(*touchable.world.shape());
            self.known = Some((version, soft));
        }
        let world = HardBody::World(ProbeView::new(&voxels, &self.ball));
        let objects: ArrayVec<_, MAX_OBJECTS> = touchable
            .objects
            .iter()
            .take(MAX_OBJECTS)
            .map(|object| {
                object.with_occupancy(HardBody::Object(object.occupancy()), object.bounds())
            })
            .collect();
        let scene = TouchScene {
            occupancy: &world,
            grid,
            objects: &objects,
        };
        let mut held = *proxy;
        let limits = touchable.limits();
        let contact = Exact { limits }.advance(&scene, target, &mut held);
        *visits += contact.visits;
        let is_there = Some(held.point()) == Proxy::at(target).map(|proxy| proxy.point());
        (!contact.violation && !is_there).then(|| HardStop {
            tool: grid.patient_from_grid().transform_point3(held.point()),
            by: contact
                .stopped_by
                .and_then(|solid| self.owner(&voxels, touchable, solid)),
        })
    }

    fn owner(
        &self,
        hard: &HardVoxels<'_>,
        touchable: &Touchable,
        solid: Solid,
    ) -> Option<SegmentId> {
        if solid.body > 0 {
            return touchable.owner(solid);
        }
        let voxel = if self.ball.is_point() {
            solid.voxel
        } else {
            self.ball.solid_near(hard, solid.voxel)?
        };
        hard.owner(voxel)
    }
}

/// The voxels of all segments that stand in the scan and are rigid.
#[derive(Clone, Copy, Debug)]
struct HardVoxels<'a> {
    parts: &'a [Part],
    soft: SegmentSet,
}

impl<'a> HardVoxels<'a> {
    /// All parts with anything hard; with a mask where that alone is.
    fn parts(&self) -> impl DoubleEndedIterator<Item = (&'a Part, Option<&'a Bits>)> {
        let soft = self.soft;
        unmoved(self.parts).filter_map(move |part| match soft.contains(part.id) {
            false => Some((part, None)),
            true => part.rigid.as_ref().map(|rigid| (part, Some(rigid))),
        })
    }

    fn has_any(&self) -> bool {
        self.parts().next().is_some()
    }

    /// The last one that has a voxel.
    fn owner(&self, voxel: IVec3) -> Option<SegmentId> {
        let is_hard = |(part, rigid): &(&Part, Option<&Bits>)| {
            part.bits.is_solid(voxel) && rigid.is_none_or(|rigid| rigid.is_solid(voxel))
        };
        self.parts().rfind(is_hard).map(|(part, _)| part.id)
    }
}

impl Occupancy for HardVoxels<'_> {
    fn is_solid(&self, voxel: IVec3) -> bool {
        self.owner(voxel).is_some()
    }

    fn block(&self, min: IVec3) -> BitBrick {
        let blocks = self.parts().map(|(part, rigid)| {
            let solid = part.bits.block(min);
            let mask = rigid.map_or(BitBrick::FULL, |rigid| rigid.block(min));
            BitBrick(std::array::from_fn(|z| solid.0[z] & mask.0[z]))
        });
        blocks.fold(BitBrick::EMPTY, |union, part| {
            BitBrick(std::array::from_fn(|z| union.0[z] | part.0[z]))
        })
    }
}

/// The hard voxels of the scan, or a segment that was moved, for the probe.
#[derive(Debug)]
enum HardBody<'a> {
    World(ProbeView<'a, HardVoxels<'a>>),
    Object(&'a Body),
}

impl Occupancy for HardBody<'_> {
    fn is_solid(&self, voxel: IVec3) -> bool {
        match self {
            Self::World(voxels) => voxels.is_solid(voxel),
            Self::Object(body) => body.is_solid(voxel),
        }
    }

    fn first_solid(&self, start: DVec3, end: DVec3, max_visits: u32) -> Traversal {
        match self {
            Self::World(voxels) => voxels.first_solid(start, end, max_visits),
            Self::Object(body) => body.first_solid(start, end, max_visits),
        }
    }

    fn block(&self, min: IVec3) -> BitBrick {
        match self {
            Self::World(voxels) => voxels.block(min),
            Self::Object(body) => body.block(min),
        }
    }
}
