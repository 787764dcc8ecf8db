//! The world as touch has it, for a point and for a ball, and edits of it by the admission rule.
//!
//! A point's world is the servo's own `TouchOccupancy`. Frame: the world's grid.

use glam::IVec3;
use palpate_haptics::admission::{Admission, admit};
use palpate_haptics::ball::{Ball, BallShape};
use palpate_haptics::ball_probe::ProbeSolid;
use palpate_haptics::proxy::Proxy;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::voxel_box::VoxelBox;
use rtrb::{Consumer, RingBuffer};

use crate::body::Body;
use crate::handover::{BrickChange, Garbage};
use crate::probe::Probe;
use crate::touch_occupancy::{GARBAGE_PER_CHANGE, TouchOccupancy};
use crate::touchable::{Part, Touchable};

/// Room for the garbage of some edits at once.
const GARBAGE: usize = 2 * GARBAGE_PER_CHANGE;

/// What a probe touches.
pub trait Touched {
    /// What is solid for the middle of the probe.
    type Solid: Occupancy;

    /// What is solid for the middle of the probe.
    fn solid(&self) -> &Self::Solid;

    /// The voxels that are touched now.
    fn bits(&self) -> &Bits;

    /// Whether another edit can be taken.
    fn has_room(&self) -> bool;

    /// Takes an edit: admits it, if need be after a push of the proxy, or holds it. `changed`
    /// holds all voxels that it may change. False where it is neither touched nor held.
    fn edit(
        &mut self,
        swaps: Vec<BrickSwap<BitBrick>>,
        changed: &VoxelBox,
        grid: &Grid,
        proxy: &mut Proxy,
    ) -> bool;

    /// Tries again what is held.
    fn retry(&mut self, grid: &Grid, proxy: &mut Proxy);

    /// Whether some edit is held.
    fn holds_back(&self) -> bool;
}

/// A point and its world.
#[derive(Debug)]
pub struct PointWorld {
    occupancy: TouchOccupancy,
    garbage: Consumer<Garbage>,
    edits: u64,
}

impl PointWorld {
    /// The voxels of a world.
    pub fn new(grid: &Grid, bits: Bits) -> Self {
        let (producer, garbage) = RingBuffer::new(GARBAGE);
        let part = Part {
            id: SegmentId(1),
            bits,
            moved: None,
        };
        let touchable = Touchable::new(grid, vec![part], 0.0).expect("a point fits anywhere");
        Self {
            occupancy: TouchOccupancy::new(touchable, producer),
            garbage,
            edits: 0,
        }
    }

    fn clear(&mut self) {
        while self.garbage.pop().is_ok() {}
    }
}

impl Touched for PointWorld {
    type Solid = Body;

    fn solid(&self) -> &Body {
        &self.occupancy.touchable().world
    }

    fn bits(&self) -> &Bits {
        self.solid().bits()
    }

    fn has_room(&self) -> bool {
        self.occupancy.held_edits().contains(&0)
    }

    fn edit(
        &mut self,
        swaps: Vec<BrickSwap<BitBrick>>,
        _changed: &VoxelBox,
        grid: &Grid,
        proxy: &mut Proxy,
    ) -> bool {
        self.edits += 1;
        let sequence = self.edits;
        let change = BrickChange {
            sequence,
            swaps,
            parts: Vec::new(),
        };
        self.occupancy
            .take_bricks(change, &mut Probe { grid, proxy });
        self.clear();
        true
    }

    fn retry(&mut self, grid: &Grid, proxy: &mut Proxy) {
        self.occupancy.retry(&mut Probe { grid, proxy });
        self.clear();
    }

    fn holds_back(&self) -> bool {
        self.occupancy.held_edits()[0] != 0
    }
}

/// A ball and its world. Edits that it does not admit are refused, not held.
#[derive(Debug)]
pub struct BallWorld {
    solid: ProbeSolid<Bits>,
    shape: BallShape,
}

impl BallWorld {
    /// The voxels of a world, for a ball of this shape.
    pub fn new(bits: Bits, shape: BallShape) -> Self {
        Self {
            solid: ProbeSolid::new(bits, Some(Ball::new(shape))),
            shape,
        }
    }
}

impl Touched for BallWorld {
    type Solid = ProbeSolid<Bits>;

    fn solid(&self) -> &ProbeSolid<Bits> {
        &self.solid
    }

    fn bits(&self) -> &Bits {
        self.solid.inner()
    }

    fn has_room(&self) -> bool {
        true
    }

    fn edit(
        &mut self,
        mut swaps: Vec<BrickSwap<BitBrick>>,
        changed: &VoxelBox,
        grid: &Grid,
        proxy: &mut Proxy,
    ) -> bool {
        let mut new = self.bits().clone();
        for swap in &mut swaps.clone() {
            new.swap(swap);
        }
        let ball = Ball::new(self.shape);
        if admit(&self.solid, &ball.dilate(&new), grid, proxy) == Admission::Held {
            return false;
        }
        self.solid.change(changed, |bits| {
            for swap in &mut swaps {
                bits.swap(swap);
            }
        });
        true
    }

    fn retry(&mut self, _grid: &Grid, _proxy: &mut Proxy) {}

    fn holds_back(&self) -> bool {
        false
    }
}

/// The bricks of an edit: `wanted` says of each voxel in the box whether it is to be solid.
/// They begin from what is wanted everywhere, so that an edit held back is not undone.
pub fn swaps_of(
    bits: &Bits,
    changed: &VoxelBox,
    wanted: impl Fn(IVec3) -> bool,
) -> Vec<BrickSwap<BitBrick>> {
    let bricks = bits.bricks();
    let mut indices = bricks.indices_in(changed);
    indices.sort_unstable();
    indices
        .into_iter()
        .map(|index| {
            let corner = bricks.box_of(index).min;
            let brick = BitBrick::from_fn(glam::UVec3::splat(8), |offset| wanted(corner + offset));
            BrickSwap {
                index,
                brick: brick.shared(),
            }
        })
        .collect()
}
