//! The world as touch has it: the servo's own `TouchOccupancy`, with edits by its rule.
//!
//! Frame: the world's grid.

use glam::{DVec3, IVec3, UVec3};
use palpate_engine::touch::{
    Body, BodyFractions, BodyVoxels, BrickChange, GARBAGE_PER_CHANGE, Garbage, Probe,
    TouchOccupancy, Touchable,
};
use palpate_haptics::admission::PoseStep;
use palpate_haptics::contact::Proxy;
use palpate_haptics::scene::{Object, ObjectPose, TouchScene};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::grid::Grid;
use palpate_volume::occupancy_fractions::FractionBrick;
use palpate_volume::voxel_box::VoxelBox;
use rtrb::{Consumer, RingBuffer};

use super::object::Made;

/// What a probe touches.
#[derive(Debug)]
pub struct Touched {
    occupancy: TouchOccupancy,
    garbage: Consumer<Garbage>,
    edits: u64,
    /// A planted fault: edits are admitted for a probe that is somewhere else.
    #[cfg(test)]
    pub careless: bool,
}

impl Touched {
    /// A world with its voxel size [mm] and objects for a probe of this radius [mm], and what is
    /// known of their occupancy fractions.
    ///
    /// # Panics
    /// Where the radius is too large for one of them; plans make none such.
    pub fn new(
        (bits, spacing): (Bits, DVec3),
        radius: f64,
        objects: &[Made],
        mut fractions: impl FnMut(&Bits) -> Option<BodyFractions>,
    ) -> Self {
        let mut body = |bits: &Bits, spacing: DVec3| {
            let voxels = BodyVoxels {
                bits: bits.clone(),
                fractions: fractions(bits),
            };
            Body::new(voxels, radius, spacing).expect("plans make balls that fit")
        };
        let world = body(&bits, spacing);
        let objects = objects.iter().map(|made| {
            let body = body(&made.bits, made.grid.spacing());
            let reach = body.shape().reach();
            let bounds = VoxelBox::new(made.bounds.min - reach, made.bounds.max + reach);
            Object::new(body, &made.grid, bounds, made.pose)
        });
        let touchable = Touchable {
            world,
            parts: Vec::new(),
            objects: objects.collect(),
            object_parts: Vec::new(),
            radius,
        };
        // room for what an edit and all that is held can leave
        let (producer, garbage) = RingBuffer::new(2 * GARBAGE_PER_CHANGE);
        Self {
            occupancy: TouchOccupancy::new(touchable, producer),
            garbage,
            edits: 0,
            #[cfg(test)]
            careless: false,
        }
    }

    /// What a tick is given.
    pub fn scene<'a>(&'a self, grid: &'a Grid) -> TouchScene<'a, Body> {
        self.occupancy.scene(grid)
    }

    /// The world's voxels that are touched now.
    pub fn bits(&self) -> &Bits {
        &self.occupancy.touchable().world.inner().bits
    }

    /// Whether another edit can be taken: none is ever passed over.
    pub fn has_room(&self) -> bool {
        self.occupancy.held_edits().contains(&0)
    }

    /// Whether some edit is held.
    pub fn holds_back(&self) -> bool {
        self.occupancy.holds_back()
    }

    /// Takes an edit: admits it, if need be after a push of the proxy, or holds it.
    pub fn edit(
        &mut self,
        (swaps, fractions): (Vec<BrickSwap<BitBrick>>, Vec<BrickSwap<FractionBrick>>),
        grid: &Grid,
        proxy: &mut Proxy,
    ) {
        self.edits += 1;
        let change = BrickChange {
            sequence: self.edits,
            swaps,
            parts: Vec::new(),
            fractions,
            part_fractions: Vec::new(),
        };
        #[cfg(test)]
        let mut elsewhere = Proxy::nearest_in(IVec3::splat(-100), DVec3::ZERO);
        #[cfg(test)]
        let proxy = if self.careless { &mut elsewhere } else { proxy };
        self.occupancy
            .take_bricks(change, &mut Probe { grid, proxy });
        self.clear();
    }

    /// Tries again what is held.
    pub fn retry(&mut self, grid: &Grid, proxy: &mut Proxy) {
        self.occupancy.retry(&mut Probe { grid, proxy });
        self.clear();
    }

    /// Moves an object by one step, if it is admitted.
    pub fn step_pose(
        &mut self,
        place: usize,
        new: &ObjectPose,
        grid: &Grid,
        proxy: &mut Proxy,
    ) -> PoseStep {
        self.occupancy
            .step_pose(place, new, &mut Probe { grid, proxy })
    }

    fn clear(&mut self) {
        while self.garbage.pop().is_ok() {}
    }
}

/// The bricks of an edit, as they are to be; `wanted` says which voxels are to be solid.
/// Whole bricks are taken from it, so that what is held back is not undone.
pub fn swaps_of(
    bits: &Bits,
    changed: &VoxelBox,
    wanted: impl Fn(IVec3) -> bool,
) -> Vec<BrickSwap<BitBrick>> {
    let bricks = bits.bricks();
    let mut indices = bricks.indices_in(changed);
    indices.sort_unstable();
    let swaps = indices.into_iter().map(|index| {
        let corner = bricks.box_of(index).min;
        let brick = BitBrick::from_fn(UVec3::splat(8), |offset| wanted(corner + offset));
        BrickSwap {
            index,
            brick: brick.shared(),
        }
    });
    swaps.collect()
}
