//! The checker's own voxels: one byte each, and which of them are connected face to face.
//!
//! Nothing here is shared with the code that is checked. Frame: the world's grid. What is
//! outside the box is not asked for: the hand stays inside.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::{DVec3, IVec3};

/// Solid voxels of a box that begins at zero.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dense {
    size: IVec3,
    solid: Vec<u8>,
}

/// The six ways through a face.
const FACES: [IVec3; 6] = [
    IVec3::X,
    IVec3::NEG_X,
    IVec3::Y,
    IVec3::NEG_Y,
    IVec3::Z,
    IVec3::NEG_Z,
];

impl Dense {
    /// Solid where the rule says so.
    pub fn from_fn(size: IVec3, mut solid: impl FnMut(IVec3) -> bool) -> Self {
        let mut bytes = Vec::with_capacity((size.x * size.y * size.z) as usize);
        for z in 0..size.z {
            for y in 0..size.y {
                for x in 0..size.x {
                    bytes.push(u8::from(solid(IVec3::new(x, y, z))));
                }
            }
        }
        Self { size, solid: bytes }
    }

    /// Voxels along each axis.
    pub fn size(&self) -> IVec3 {
        self.size
    }

    /// One byte per voxel, x fastest.
    pub fn bytes(&self) -> &[u8] {
        &self.solid
    }

    /// Place of a voxel in memory, if the box has it.
    #[inline]
    pub fn index(&self, voxel: IVec3) -> Option<usize> {
        let inside = voxel.cmpge(IVec3::ZERO).all() && voxel.cmplt(self.size).all();
        inside.then(|| ((voxel.z * self.size.y + voxel.y) * self.size.x + voxel.x) as usize)
    }

    fn voxel(&self, index: usize) -> IVec3 {
        let [index, x, y] = [index as i32, self.size.x, self.size.y];
        IVec3::new(index % x, index / x % y, index / (x * y))
    }

    /// Whether a voxel is solid; outside none is.
    #[inline]
    pub fn is_solid(&self, voxel: IVec3) -> bool {
        self.index(voxel)
            .is_some_and(|index| self.solid[index] != 0)
    }

    /// Makes a voxel solid or free.
    pub fn set(&mut self, voxel: IVec3, solid: bool) {
        if let Some(index) = self.index(voxel) {
            self.solid[index] = u8::from(solid);
        }
    }

    /// Whether a box of one voxel around a cell, or a point, comes nearer than `radius` [mm] to
    /// a solid voxel: `low` and `high` are its corners, in voxels.
    pub fn is_near(&self, low: DVec3, high: DVec3, spacing: DVec3, radius: f64) -> bool {
        let reach = radius / spacing;
        let first = (low - reach).floor().as_ivec3().max(IVec3::ZERO);
        let last = (high + reach).floor().as_ivec3().min(self.size - 1);
        // touching is allowed: 1e-9 is rounding
        let limit = radius * radius * (1.0 - 1e-9);
        for z in first.z..=last.z {
            for y in first.y..=last.y {
                for x in first.x..=last.x {
                    let voxel = IVec3::new(x, y, z);
                    if !self.is_solid(voxel) {
                        continue;
                    }
                    let corner = voxel.as_dvec3();
                    let gap = (corner - high).max(low - (corner + 1.0)).max(DVec3::ZERO);
                    if (gap * spacing).length_squared() < limit {
                        return true;
                    }
                }
            }
        }
        false
    }

    /// Numbers of the parts of free space that hang together face to face within the box; 0
    /// where solid.
    pub fn parts(&self) -> Vec<u32> {
        let mut parts = vec![0; self.solid.len()];
        let mut stack = Vec::new();
        let mut next = 0;
        for start in 0..parts.len() {
            if self.solid[start] != 0 || parts[start] != 0 {
                continue;
            }
            next += 1;
            stack.push(start);
            parts[start] = next;
            while let Some(place) = stack.pop() {
                let voxel = self.voxel(place);
                for face in FACES {
                    if let Some(index) = self.index(voxel + face)
                        && self.solid[index] == 0
                        && parts[index] == 0
                    {
                        parts[index] = next;
                        stack.push(index);
                    }
                }
            }
        }
        parts
    }
}

/// Finds ways through faces, nearest to the goal first.
#[derive(Debug, Default)]
pub struct Finder {
    /// Whether a voxel was seen in the search of this number.
    visited: Vec<u32>,
    search: u32,
    waiting: BinaryHeap<(Reverse<i32>, usize)>,
}

impl Finder {
    /// Whether voxels that are free by the rule lead from one to another within `reach` voxels
    /// of the box around both.
    pub fn has_path(
        &mut self,
        dense: &Dense,
        [from, to]: [IVec3; 2],
        reach: i32,
        mut free: impl FnMut(IVec3) -> bool,
    ) -> bool {
        let [Some(start), Some(goal)] = [from, to].map(|voxel| dense.index(voxel)) else {
            return false;
        };
        if !free(to) {
            return false;
        }
        if start == goal || (to - from).abs().element_sum() == 1 {
            return true;
        }
        let [low, high] = [from.min(to) - reach, from.max(to) + reach];
        self.begin(dense.solid.len());
        self.reach(start, (to - from).abs().element_sum());
        while let Some((_, place)) = self.waiting.pop() {
            let voxel = dense.voxel(place);
            for face in FACES {
                let next = voxel + face;
                let within = next.cmpge(low).all() && next.cmple(high).all();
                let Some(index) = dense.index(next).filter(|_| within) else {
                    continue;
                };
                if index == goal {
                    return true;
                }
                if self.visited[index] != self.search && free(next) {
                    self.reach(index, (to - next).abs().element_sum());
                } else {
                    self.visited[index] = self.search;
                }
            }
        }
        false
    }

    fn begin(&mut self, count: usize) {
        self.search = self.search.wrapping_add(1);
        if self.visited.len() != count || self.search == 0 {
            self.visited = vec![0; count];
            self.search = 1;
        }
        self.waiting.clear();
    }

    fn reach(&mut self, index: usize, left: i32) {
        self.visited[index] = self.search;
        self.waiting.push((Reverse(left), index));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wall with a hole of one voxel in a corner.
    fn wall() -> Dense {
        Dense::from_fn(IVec3::splat(12), |v| v.x == 6 && v != IVec3::new(6, 0, 0))
    }

    #[test]
    fn ways_go_through_holes_that_are_near_enough_and_never_through_walls() {
        let wall = wall();
        let mut finder = Finder::default();
        let ends = [IVec3::new(5, 4, 4), IVec3::new(7, 4, 4)];
        let mut way = |reach| finder.has_path(&wall, ends, reach, |voxel| !wall.is_solid(voxel));
        assert!(!way(3));
        assert!(way(4));
        assert!(!finder.has_path(&wall, ends, 12, |v| v.x != 6));
        // an end that is not free, or outside
        let blocked = [IVec3::new(5, 4, 4), IVec3::new(6, 4, 4)];
        assert!(!finder.has_path(&wall, blocked, 12, |v| v.x != 6));
        let outside = [IVec3::new(5, 4, 4), IVec3::new(5, 4, 12)];
        assert!(!finder.has_path(&wall, outside, 12, |_| true));
    }

    #[test]
    fn an_edge_is_no_way() {
        let edge = Dense::from_fn(IVec3::new(2, 2, 1), |v| v.x == v.y);
        let mut finder = Finder::default();
        let ends = [IVec3::new(1, 0, 0), IVec3::new(0, 1, 0)];
        assert!(!finder.has_path(&edge, ends, 2, |voxel| !edge.is_solid(voxel)));
        assert_eq!(edge.parts(), [0, 1, 2, 0]);
    }

    #[test]
    fn parts_are_what_walls_part() {
        let mut wall = wall();
        assert_eq!(wall.parts().into_iter().max(), Some(1));
        wall.set(IVec3::new(6, 0, 0), true);
        let parts = wall.parts();
        assert_eq!(parts.iter().copied().max(), Some(2));
        let part = |x: i32| parts[wall.index(IVec3::new(x, 3, 3)).unwrap()];
        assert_eq!([part(5), part(6), part(7)], [1, 0, 2]);
    }

    #[test]
    fn near_is_nearer_than_the_radius_in_mm() {
        let one = Dense::from_fn(IVec3::splat(8), |v| v == IVec3::splat(4));
        let spacing = DVec3::new(0.5, 1.0, 2.0);
        let near = |x: f64, y: f64, z: f64, radius: f64| {
            let point = DVec3::new(x, y, z);
            one.is_near(point, point, spacing, radius)
        };
        // two voxels before the face at 4, along each axis
        assert!(near(2.0, 4.5, 4.5, 1.01) && !near(2.0, 4.5, 4.5, 0.99));
        assert!(near(4.5, 2.0, 4.5, 2.01) && !near(4.5, 2.0, 4.5, 1.99));
        assert!(near(4.5, 4.5, 7.0, 4.01) && !near(4.5, 4.5, 7.0, 3.99));
        assert!(near(4.5, 4.5, 4.5, 0.1) && !near(4.0, 4.5, 3.9, 0.0));
    }
}
