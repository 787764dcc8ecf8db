//! The directory from voxels to bricks of 8×8×8: what bits and overlays are stored in.
//!
//! Memory: a flat array, x fastest, one pointer for each brick; no brick costs 8 bytes.
//! A read is one directory entry and one brick, whatever the size. Clones share bricks.

use std::sync::Arc;

use glam::{IVec3, UVec3};
use rayon::prelude::*;

use crate::voxel_box::VoxelBox;

/// Voxels along the edge of a brick.
pub const BRICK: i32 = 8;

/// A brick and its place in the directory. Swapped in, it holds the brick that was there,
/// and so becomes its own inverse.
#[derive(Debug)]
pub struct BrickSwap<B> {
    /// Place in the directory.
    pub index: u32,
    /// The brick to put there, or none.
    pub brick: Option<Arc<B>>,
}

impl<B> Clone for BrickSwap<B> {
    fn clone(&self) -> Self {
        Self {
            index: self.index,
            brick: self.brick.clone(),
        }
    }
}

/// Bricks of a grid, some of which exist.
#[derive(Debug)]
pub struct BrickGrid<B> {
    /// Bricks along each axis.
    size: UVec3,
    bricks: Vec<Option<Arc<B>>>,
}

impl<B> Clone for BrickGrid<B> {
    fn clone(&self) -> Self {
        Self {
            size: self.size,
            bricks: self.bricks.clone(),
        }
    }
}

impl<B> BrickGrid<B> {
    /// No bricks, for a grid of so many voxels.
    pub fn empty(dimensions: UVec3) -> Self {
        let size = size_in_bricks(dimensions);
        Self {
            size,
            bricks: vec![None; brick_count(size)],
        }
    }

    /// Makes every brick from its box, in parallel; boxes reach beyond the grid's border.
    pub fn from_fn(dimensions: UVec3, make: impl Fn(VoxelBox) -> Option<Arc<B>> + Sync) -> Self
    where
        B: Send + Sync,
    {
        let size = size_in_bricks(dimensions);
        let bricks = (0..brick_count(size))
            .into_par_iter()
            .map(|index| make(box_of(size, index as u32)))
            .collect();
        Self { size, bricks }
    }

    /// The same grid with other bricks in the place of those that there are, made in parallel from
    /// each and its box, which may reach beyond the border.
    #[must_use]
    pub fn with_bricks(&self, make: impl Fn(&Arc<B>, &VoxelBox) -> Option<Arc<B>> + Sync) -> Self
    where
        B: Send + Sync,
    {
        let other = |(index, brick): (usize, &Option<Arc<B>>)| {
            make(brick.as_ref()?, &box_of(self.size, index as u32))
        };
        Self {
            size: self.size,
            bricks: self.bricks.par_iter().enumerate().map(other).collect(),
        }
    }

    /// Bricks along each axis.
    pub fn size(&self) -> UVec3 {
        self.size
    }

    /// Entries of the directory.
    pub fn len(&self) -> usize {
        self.bricks.len()
    }

    /// Whether no brick exists.
    pub fn is_empty(&self) -> bool {
        self.bricks.iter().all(Option::is_none)
    }

    /// The brick that holds a voxel of the grid, or none.
    #[inline]
    pub fn at(&self, voxel: IVec3) -> Option<&B> {
        self.bricks.get(self.index_of(voxel))?.as_deref()
    }

    /// The brick that holds a voxel and those after it, two along each axis, x fastest; none
    /// beyond the grid.
    #[inline]
    pub(crate) fn eight_from(&self, voxel: IVec3) -> [Option<&B>; 8] {
        let size = self.size.as_ivec3();
        let first = voxel >> 3_i32;
        let steps = |place: i32| IVec3::new(place & 1, place >> 1 & 1, place >> 2);
        if first.cmpge(IVec3::ZERO).all() && first.cmplt(size - 1).all() {
            let [x, y] = [1, size.x as usize];
            let z = y * size.y as usize;
            let start = self.index_of(voxel);
            let places = [0, x, y, y + x, z, z + x, z + y, z + y + x];
            return places.map(|place| self.bricks.get(start + place)?.as_deref());
        }
        std::array::from_fn(|place| {
            let brick = first + steps(place as i32);
            let is_there = brick.cmpge(IVec3::ZERO).all() && brick.cmplt(size).all();
            if is_there {
                self.at(BRICK * brick)
            } else {
                None
            }
        })
    }

    /// A brick by its place in the directory.
    #[inline]
    pub fn get(&self, index: u32) -> Option<&Arc<B>> {
        self.bricks.get(index as usize)?.as_ref()
    }

    /// Exchanges two pointers: nothing is allocated or freed, so the servo may do it. An
    /// index beyond the directory changes nothing.
    #[inline]
    pub fn swap(&mut self, swap: &mut BrickSwap<B>) {
        if let Some(brick) = self.bricks.get_mut(swap.index as usize) {
            std::mem::swap(brick, &mut swap.brick);
        }
    }

    /// The directory, x fastest.
    pub fn entries(&self) -> &[Option<Arc<B>>] {
        &self.bricks
    }

    /// The voxels of a brick; they may reach beyond the grid's border.
    pub fn box_of(&self, index: u32) -> VoxelBox {
        box_of(self.size, index)
    }

    /// Directory places of all bricks that a box meets.
    pub fn indices_in(&self, voxels: &VoxelBox) -> Vec<u32> {
        let inside = voxels.intersect(&VoxelBox::of_dimensions(self.size * BRICK as u32));
        if inside.is_empty() {
            return Vec::new();
        }
        let bricks = VoxelBox::new(inside.min / BRICK, (inside.max + (BRICK - 1)) / BRICK);
        bricks
            .voxels()
            .map(|brick| self.index_of(brick * BRICK) as u32)
            .collect()
    }

    /// Directory places of the bricks beside one, face to face.
    pub fn indices_beside(&self, index: u32) -> impl Iterator<Item = u32> {
        let corner = self.box_of(index).min;
        let size = (self.size * BRICK as u32).as_ivec3();
        let steps = [IVec3::X, IVec3::Y, IVec3::Z].map(|axis| BRICK * axis);
        let beside = steps
            .into_iter()
            .flat_map(move |step| [corner - step, corner + step]);
        beside
            .filter(move |corner| corner.cmpge(IVec3::ZERO).all() && corner.cmplt(size).all())
            .map(|corner| self.index_of(corner) as u32)
    }

    #[inline]
    fn index_of(&self, voxel: IVec3) -> usize {
        let brick = (voxel >> 3_i32).as_uvec3();
        let [nx, ny] = [self.size.x as usize, self.size.y as usize];
        (brick.z as usize * ny + brick.y as usize) * nx + brick.x as usize
    }
}

fn size_in_bricks(dimensions: UVec3) -> UVec3 {
    (dimensions + (BRICK as u32 - 1)) / BRICK as u32
}

fn brick_count(size: UVec3) -> usize {
    size.x as usize * size.y as usize * size.z as usize
}

fn box_of(size: UVec3, index: u32) -> VoxelBox {
    let [row, layer] = [size.x, size.x * size.y];
    let brick = UVec3::new(index % row, index % layer / row, index / layer);
    let min = brick.as_ivec3() * BRICK;
    VoxelBox::new(min, min + BRICK)
}
