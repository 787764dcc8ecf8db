//! The guarantees of touch, found out the slow way: voxels of its own, and every one near is asked.
//!
//! Nothing here is shared with the code that is checked. Frame: cubes of 1 mm from the origin on, so
//! that places in mm are places in voxels.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::{DVec3, IVec3};

/// Touching is allowed; this much of a radius is rounding.
const OF_RADIUS: f64 = 1e-9;

const FACES: [IVec3; 6] = [
    IVec3::X,
    IVec3::NEG_X,
    IVec3::Y,
    IVec3::NEG_Y,
    IVec3::Z,
    IVec3::NEG_Z,
];

/// Solid voxels of a cube; outside of it all is free.
#[derive(Clone, PartialEq)]
pub struct Volume {
    edge: i32,
    solid: Vec<bool>,
}

impl Volume {
    pub fn from_fn(edge: i32, mut solid: impl FnMut(IVec3) -> bool) -> Self {
        let solid = cells(edge).map(&mut solid).collect();
        Self { edge, solid }
    }

    fn place(&self, voxel: IVec3) -> Option<usize> {
        let inside = voxel.cmpge(IVec3::ZERO).all() && voxel.cmplt(IVec3::splat(self.edge)).all();
        inside.then(|| (voxel.x + self.edge * (voxel.y + self.edge * voxel.z)) as usize)
    }

    pub fn is_solid(&self, voxel: IVec3) -> bool {
        self.place(voxel).is_some_and(|place| self.solid[place])
    }

    pub fn set(&mut self, voxel: IVec3, solid: bool) {
        if let Some(place) = self.place(voxel) {
            self.solid[place] = solid;
        }
    }

    /// Whether a ball with its centre at a point overlaps a solid voxel; one of radius 0 is the
    /// point.
    pub fn overlaps(&self, centre: DVec3, radius: f64) -> bool {
        self.is_solid(centre.floor().as_ivec3()) || self.is_near([centre; 2], radius)
    }

    /// Whether a ball with its centre anywhere in a cell overlaps no solid voxel.
    pub fn leaves_free(&self, cell: IVec3, radius: f64) -> bool {
        let low = cell.as_dvec3();
        !self.is_solid(cell) && !self.is_near([low, low + 1.0], radius)
    }

    /// Whether a box comes nearer than `radius` to the box of a solid voxel.
    fn is_near(&self, [low, high]: [DVec3; 2], radius: f64) -> bool {
        let first = (low - radius).floor().as_ivec3().max(IVec3::ZERO);
        let last = (high + radius)
            .floor()
            .as_ivec3()
            .min(IVec3::splat(self.edge - 1));
        box_of(first, last).any(|voxel| {
            let corner = voxel.as_dvec3();
            let gap = (corner - high).max(low - (corner + 1.0)).max(DVec3::ZERO);
            self.is_solid(voxel) && gap.length() < radius * (1.0 - OF_RADIUS)
        })
    }

    /// Numbers of the parts of free space that hang together face to face, those at the border as one;
    /// 0 where solid.
    pub fn parts(&self) -> Parts {
        let edge = self.edge + 2;
        let around = Self::from_fn(edge, |cell| self.is_solid(cell - 1));
        let mut numbers = vec![0; around.solid.len()];
        let mut last = 0;
        for start in cells(edge) {
            let mut waiting = vec![start];
            let mut is_new = true;
            while let Some(cell) = waiting.pop() {
                let Some(place) = around.place(cell) else {
                    continue;
                };
                if around.solid[place] || numbers[place] != 0 {
                    continue;
                }
                last += u32::from(std::mem::take(&mut is_new));
                numbers[place] = last;
                waiting.extend(FACES.map(|face| cell + face));
            }
        }
        Parts { around, numbers }
    }

    /// Whether face-connected cells of a cube of `edge` cells lead from one to another, of which
    /// every one after the first is free by the rule.
    pub fn is_way(edge: i32, [from, to]: [IVec3; 2], free: impl Fn(IVec3) -> bool) -> bool {
        let mut seen = Self::from_fn(edge, |_| false);
        let mut waiting = BinaryHeap::new();
        let far = |cell: IVec3| (to - cell).abs().element_sum();
        waiting.push((Reverse(far(from)), from.to_array()));
        while let Some((_, cell)) = waiting.pop() {
            let cell = IVec3::from_array(cell);
            if cell == to {
                return true;
            }
            for next in FACES.map(|face| cell + face) {
                let is_new = seen.place(next).is_some() && !seen.is_solid(next);
                seen.set(next, true);
                if is_new && free(next) {
                    waiting.push((Reverse(far(next)), next.to_array()));
                }
            }
        }
        false
    }
}

/// Parts of the space that a volume leaves free.
pub struct Parts {
    around: Volume,
    numbers: Vec<u32>,
}

impl Parts {
    /// The part that a point is in; the one outside is 1.
    pub fn of(&self, point: DVec3) -> u32 {
        let place = self.around.place(point.floor().as_ivec3() + 1);
        place.map_or(1, |place| self.numbers[place])
    }
}

fn cells(edge: i32) -> impl Iterator<Item = IVec3> {
    box_of(IVec3::ZERO, IVec3::splat(edge - 1))
}

/// All voxels between two, both included, x fastest.
fn box_of(first: IVec3, last: IVec3) -> impl Iterator<Item = IVec3> {
    let rows = (first.z..=last.z).flat_map(move |z| (first.y..=last.y).map(move |y| (y, z)));
    rows.flat_map(move |(y, z)| (first.x..=last.x).map(move |x| IVec3::new(x, y, z)))
}
