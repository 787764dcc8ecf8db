//! A box of nodes that stands elsewhere: what both places share goes along, and only what is new
//! is built.

use glam::{IVec3, UVec3};

use super::bond_forces::rest_length;
use super::layout::{FAMILY_COUNT, Layout};
use super::nodes::{Lattice, NodeMaterial};
use super::structure::faces_at;

impl Lattice {
    /// Goes `offset` nodes on. `matter` is asked for nodes that the box did not have, and behind
    /// the faces at the ends of its way. Bonds that are built anew are whole.
    pub(super) fn go(&mut self, offset: IVec3, matter: &impl Fn(IVec3) -> NodeMaterial) {
        let layout = self.layout;
        self.shift(offset);
        let mut near = vec![false; layout.len()];
        let is_new = |node: UVec3| layout.index_of(node.as_ivec3() + offset).is_none();
        for (node, index) in layout.nodes().filter(|(node, _)| is_new(*node)) {
            self.put(index, matter(node.as_ivec3()));
            self.mark_around(node, &mut near);
        }
        // behind the faces along its way the same goes on as before
        let ends = (0..6).filter(|face| offset[face / 2] != 0);
        let ends = ends.fold(0, |ends, face| ends | 1 << face);
        for (node, index) in layout.nodes() {
            let at = faces_at(&layout, node);
            let asked = if is_new(node) { at } else { at & ends };
            let kept = self.cut[index] & at & !asked;
            self.cut[index] = kept | self.cut_faces(node, index, asked, matter);
            if at & ends != 0 {
                self.mark_around(node, &mut near);
            }
        }
        self.hold_anew(&mut near);
        self.connect(&near, Some(offset));
    }

    /// Has tissue that is new in the box start where what is nearest to it has moved, less by the distance
    /// as far from a force in the `middle`: at rest beside nodes that have moved far, it would be torn at and
    /// push back. `first` and `last` are the first and last node that the box had before.
    pub(super) fn move_along(&mut self, [first, last]: [IVec3; 2], middle: IVec3) {
        let layout = self.layout;
        for (node, index) in layout.nodes() {
            let node = node.as_ivec3();
            let nearest = node.clamp(first, last);
            if nearest == node || !self.is_mobile(index) {
                continue;
            }
            if let Some(from) = layout.index_of(nearest) {
                let distance = |node: IVec3| (node - middle).as_dvec3().length();
                let share = (distance(nearest) / distance(node)).min(1.0);
                self.set_moved(index, self.moved(from) * share);
            }
        }
    }

    /// Has all that is kept of each node at its place in the new box.
    fn shift(&mut self, offset: IVec3) {
        let layout = self.layout;
        shift(&layout, &mut self.matter, offset, NodeMaterial::Empty);
        shift(&layout, &mut self.node_stiffness, offset, 0.0);
        shift(&layout, &mut self.node_volume, offset, 0.0);
        shift(&layout, &mut self.cells.modulus, offset, 0.0);
        shift(&layout, &mut self.cut, offset, 0);
        for family in 0..FAMILY_COUNT {
            let rest = rest_length(family, self.spacing);
            shift(&layout, &mut self.bonds.stiffness[family], offset, 0.0);
            shift(&layout, &mut self.bonds.rest[family], offset, rest);
        }
        for axis in 0..3 {
            shift(&layout, &mut self.held[axis], offset, true);
            shift(&layout, &mut self.moved[axis], offset, 0.0);
        }
    }
}

/// Has each value at the place of its node in a box that stands `offset` nodes on; nodes that the
/// box did not have get `other`.
pub(super) fn shift<T: Copy>(layout: &Layout, values: &mut Vec<T>, offset: IVec3, other: T) {
    let size = layout.size().as_ivec3();
    let low = (-offset).max(IVec3::ZERO);
    let high = (size - offset).min(size);
    let mut shifted = vec![other; values.len()];
    if low.cmplt(high).all() {
        let count = (high.x - low.x) as usize;
        for z in low.z..high.z {
            for y in low.y..high.y {
                let node = IVec3::new(low.x, y, z);
                let to = layout.index(node.as_uvec3());
                let from = layout.index((node + offset).as_uvec3());
                shifted[to..to + count].copy_from_slice(&values[from..from + count]);
            }
        }
    }
    *values = shifted;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::{Border, LatticeModuli};
    use crate::material::{Solid, SolidSi};

    fn solid(young: f64, poisson: f64) -> Solid {
        let si = SolidSi {
            young,
            poisson,
            density: 1000.0,
            fracture_energy: f64::INFINITY,
            friction: 0.0,
            stiffening: 0.0,
        };
        si.checked().expect("matter")
    }

    /// Soft tissue with a ball of stiffer tissue in it, bone beside it, under a slope of air.
    fn matter(node: IVec3) -> NodeMaterial {
        let from_middle = (node - IVec3::new(14, 10, 4)).as_dvec3();
        match node {
            _ if node.z + node.x / 3 > 9 => NodeMaterial::Empty,
            _ if node.y > 16 => NodeMaterial::Rigid(solid(1e10, 0.3)),
            _ if from_middle.length() < 3.5 => NodeMaterial::Deformable(solid(4e5, 0.25)),
            _ => NodeMaterial::Deformable(solid(1e4, 0.4)),
        }
    }

    fn box_at(origin: IVec3) -> Lattice {
        let load = glam::DVec3::splat(5.0);
        Lattice::new(UVec3::splat(11), 1.0, Border::Endless { load }, |node| {
            matter(origin + node)
        })
    }

    #[test]
    fn a_box_that_goes_on_is_built_as_one_that_was_always_there() {
        let ways = [
            [2, 0, 0],
            [0, -3, 0],
            [3, 1, -2],
            [-1, 2, 1],
            [40, 0, 0],
            [-40, -1, 2],
        ];
        let mut origin = IVec3::ZERO;
        let mut lattice = box_at(origin);
        for way in ways.map(IVec3::from_array) {
            origin += way;
            lattice.go(way, &|node| matter(origin + node));
            let anew = box_at(origin);
            assert!(lattice.matter == anew.matter, "{way}");
            assert!(lattice.node_volume == anew.node_volume, "{way}");
            assert_eq!(lattice.cut, anew.cut, "{way}");
            assert_eq!(lattice.held, anew.held, "{way}");
            assert!(lattice.bonds.stiffness == anew.bonds.stiffness, "{way}");
            assert!(lattice.bonds.rest == anew.bonds.rest, "{way}");
            assert!(lattice.cells.modulus == anew.cells.modulus, "{way}");
            assert!(lattice.mass == anew.mass, "{way}");
            assert_eq!(lattice.free_nodes, anew.free_nodes, "{way}");
            let springs = |lattice: &Lattice| -> Vec<_> {
                let grounds = lattice.ground.iter();
                grounds
                    .map(|ground| (ground.node, ground.stiffness))
                    .collect()
            };
            assert!(springs(&lattice) == springs(&anew), "{way}");
        }
        assert!(LatticeModuli::of(&solid(1e4, 0.4), 1.0).volume > 0.0);
    }

    #[test]
    fn nodes_that_stay_in_the_box_stay_where_they_are() {
        let mut lattice = box_at(IVec3::ZERO);
        let node = IVec3::new(5, 5, 5);
        let at = |lattice: &Lattice, node| lattice.layout.index_of(node).expect("in the box");
        let moved = glam::DVec3::new(0.1, 0.2, -0.3);
        let index = at(&lattice, node);
        lattice.set_moved(index, moved);
        let way = IVec3::new(2, -1, 3);
        lattice.go(way, &|node| matter(way + node));
        let index = at(&lattice, node - way);
        assert_eq!(lattice.moved(index), moved);
        assert_eq!(
            lattice
                .matter_nodes()
                .filter(|&n| lattice.moved(n) != glam::DVec3::ZERO)
                .count(),
            1
        );
    }
}
