//! Voxels of what is thin, in parts that hang together.
//!
//! A body that holds no solid block of three voxels along each axis is thin as a whole: by its
//! voxels alone, something of 1.6 voxels is two voxels thick here and one there. Of other bodies,
//! thin is what lies in no solid block of two voxels, nor beside one: that is the relief of what is
//! thick, which smoothing levels on purpose.

use glam::IVec3;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::bodies::{Bodies, Union};
use palpate_volume::voxel_box::VoxelBox;

use crate::quick_map::QuickMap;

/// Thin voxels, by the parts that hang together through faces, edges and corners.
#[derive(Clone, Debug, Default)]
pub(crate) struct ThinVoxels {
    /// The part of each.
    part_of: QuickMap<IVec3, u32>,
    /// Voxels of each part, in order of their bricks.
    pub(crate) parts: Vec<Vec<IVec3>>,
}

impl ThinVoxels {
    /// Finds them.
    pub(crate) fn of(bits: &Bits, bodies: &Bodies) -> Self {
        let cores = cores_of(bits, bodies);
        let is_thin = |voxel: IVec3| {
            let body = bodies.at(voxel);
            let is_slight = body.is_some_and(|body| !cores[body as usize]);
            is_slight || !is_near_block(bits, voxel)
        };
        let thin = solid_in_cut_bricks(bits).filter(|&voxel| is_thin(voxel));
        Self::in_parts(bits, thin.collect())
    }

    fn in_parts(bits: &Bits, thin: Vec<IVec3>) -> Self {
        let places = thin.iter().zip(0..).map(|(&voxel, place)| (voxel, place));
        let mut part_of: QuickMap<IVec3, u32> = places.collect();
        let mut united = Union::of(thin.len());
        for (place, &voxel) in (0..).zip(&thin) {
            let around = VoxelBox::of_voxel(voxel).dilate(1).voxels();
            for other in around.filter(|&other| bits.is_solid(other)) {
                if let Some(&other) = part_of.get(&other) {
                    united.unite(place, other);
                }
            }
        }
        let (numbers, count) = united.numbered();
        let mut parts = vec![Vec::new(); count];
        for (&voxel, &part) in thin.iter().zip(&numbers) {
            parts[part as usize].push(voxel);
            part_of.insert(voxel, part);
        }
        Self { part_of, parts }
    }

    /// The part of a thin voxel.
    pub(crate) fn part_of(&self, voxel: IVec3) -> Option<u32> {
        self.part_of.get(&voxel).copied()
    }
}

/// Solid voxels of bricks that are not full: in those that are, nothing is thin.
fn solid_in_cut_bricks(bits: &Bits) -> impl Iterator<Item = IVec3> {
    let bricks = bits.bricks();
    (0..bricks.len() as u32).flat_map(move |index| {
        let cut = bricks.get(index).filter(|brick| ***brick != BitBrick::FULL);
        let voxels = bricks.box_of(index).voxels();
        voxels.filter(move |&voxel| cut.is_some_and(|brick| brick.contains(voxel)))
    })
}

/// Whether a voxel lies in a solid block of two voxels along each axis, or beside one.
fn is_near_block(bits: &Bits, voxel: IVec3) -> bool {
    let corners = VoxelBox::new(voxel - 2, voxel + 2);
    corners.voxels().any(|low| is_solid_block(bits, low, 2))
}

fn is_solid_block(bits: &Bits, low: IVec3, edge: i32) -> bool {
    let mut block = VoxelBox::new(low, low + edge).voxels();
    block.all(|voxel| bits.is_solid(voxel))
}

/// Which bodies hold a solid block of three voxels along each axis.
fn cores_of(bits: &Bits, bodies: &Bodies) -> Vec<bool> {
    let mut cores = vec![false; bodies.count()];
    let bricks = bits.bricks();
    for index in 0..bricks.len() as u32 {
        if bricks
            .get(index)
            .is_some_and(|brick| **brick == BitBrick::FULL)
        {
            let body = bodies.at(bricks.box_of(index).min);
            cores[body.expect("a full brick is solid") as usize] = true;
        }
    }
    for voxel in solid_in_cut_bricks(bits) {
        let Some(body) = bodies.at(voxel).map(|body| body as usize) else {
            continue;
        };
        cores[body] = cores[body] || is_solid_block(bits, voxel - 1, 3);
    }
    cores
}
