//! What follows from what the nodes are made of: bonds, cells, border springs, masses.

use glam::{DMat3, DVec3, IVec3, UVec3};

use super::bond_forces::rest_length;
use super::border::{Border, Ground, spring_of_endless_body};
use super::coarse::Coarse;
use super::layout::{FAMILIES, FAMILY_COUNT};
use super::moduli::LatticeModuli;
use super::nodes::{Lattice, NodeMatter};
use super::vectors::zero_field;
use super::volume_forces::corners;
use crate::material::{Solid, pair_stiffness};

/// From here on, stiffer nodes are held: what they would give is below a thousandth of what
/// their neighbours give.
const HELD_RATIO: f64 = 1e3;

impl Lattice {
    /// Asks what every node is made of, and those one step outside, and builds all of it.
    pub(super) fn build(&mut self, matter: &impl Fn(IVec3) -> NodeMatter) {
        let all: Vec<_> = self.layout.nodes().collect();
        for &(node, index) in &all {
            self.put(index, matter(node.as_ivec3()));
        }
        self.hold_what_is_rigid();
        self.connect(&all, matter);
    }

    /// Puts other matter on some nodes, and builds anew what hangs on them; broken bonds come
    /// back whole. Nodes that have become empty are at rest.
    pub(super) fn change(
        &mut self,
        changes: &[(usize, NodeMatter)],
        matter: &impl Fn(IVec3) -> NodeMatter,
    ) {
        let mut near = vec![false; self.layout.len()];
        for &(index, matter) in changes {
            self.put(index, matter);
            self.mark_around(index, &mut near);
        }
        let held_before = self.held[0].clone();
        self.hold_what_is_rigid();
        for (_, index) in self.layout.nodes() {
            if self.held[0][index] != held_before[index] {
                self.mark_around(index, &mut near);
            }
            if !self.is_mobile(index) {
                self.set_moved(index, DVec3::ZERO);
            }
        }
        let near: Vec<_> = self.layout.nodes().filter(|&(_, n)| near[n]).collect();
        self.connect(&near, matter);
    }

    /// Marks a node and all from which a bond or a cell leads to it.
    fn mark_around(&self, index: usize, near: &mut [bool]) {
        let Some(node) = self.layout.node_at(index) else {
            return;
        };
        for corner in 0..27 {
            let step = IVec3::new(corner % 3, corner / 3 % 3, corner / 9) - 1;
            if let Some(place) = self.layout.index_of(node.as_ivec3() + step) {
                near[place] = true;
            }
        }
    }

    fn put(&mut self, index: usize, matter: NodeMatter) {
        self.matter[index] = matter;
        let stiffness = |solid| LatticeModuli::of(solid, self.spacing).bond;
        self.node_stiffness[index] = matter.solid().map_or(0.0, stiffness);
    }

    /// Holds what is rigid or much stiffer than the rest.
    fn hold_what_is_rigid(&mut self) {
        let moduli = self.matter.iter().filter_map(|matter| match matter {
            NodeMatter::Deformable(solid) => Some(solid.young),
            _ => None,
        });
        let softest = moduli.fold(f64::INFINITY, f64::min);
        for (index, matter) in self.matter.iter().enumerate() {
            let gives = matches!(matter, NodeMatter::Deformable(solid)
                if solid.young <= HELD_RATIO * softest);
            for axis in &mut self.held {
                axis[index] = !gives;
            }
        }
    }

    /// Builds what begins at these nodes, and all that follows.
    fn connect(&mut self, nodes: &[(UVec3, usize)], matter: &impl Fn(IVec3) -> NodeMatter) {
        for &(node, index) in nodes {
            self.cut[index] = self.cut_faces(node, index, matter);
        }
        for &(node, index) in nodes {
            self.bond(node, index);
            self.cells.modulus[index] = self.modulus_of_cell(node, index);
        }
        self.ground_border();
        self.settle_structure();
        if let Border::Endless { load } = self.border {
            self.coarse = Some(Coarse::new(self, load));
        }
    }

    /// The faces of the box (two bits for each axis) behind which the matter of a node goes on.
    fn cut_faces(&self, node: UVec3, index: usize, matter: &impl Fn(IVec3) -> NodeMatter) -> u8 {
        let (node, last) = (node.as_ivec3(), self.layout.size().as_ivec3() - 1);
        if self.matter[index] == NodeMatter::Empty {
            return 0;
        }
        let is_cut = |face: &usize| {
            let axis = face / 2;
            let at_face = node[axis]
                == if face.is_multiple_of(2) {
                    0
                } else {
                    last[axis]
                };
            at_face && matter(node + outward(*face)) != NodeMatter::Empty
        };
        (0..6).filter(is_cut).fold(0, |cut, face| cut | 1 << face)
    }

    /// Bonds a node to its upper neighbours. A bond along the border belongs by half to the body
    /// behind it.
    fn bond(&mut self, node: UVec3, index: usize) {
        for family in 0..FAMILY_COUNT {
            let step = IVec3::from_array(FAMILIES[family]);
            let Some(far) = self.layout.index_of(node.as_ivec3() + step) else {
                continue;
            };
            let shared = (self.cut[index] & self.cut[far]).count_ones();
            let gives = self.is_mobile(index) || self.is_mobile(far);
            let stiffness = pair_stiffness(self.node_stiffness[index], self.node_stiffness[far]);
            self.bonds.stiffness[family][index] = match gives {
                true => self.stiffening * stiffness * 0.5f64.powi(shared as i32),
                false => 0.0,
            };
        }
    }

    /// The volume term of a cell of 8 nodes: their harmonic mean; none where one has none.
    fn modulus_of_cell(&self, node: UVec3, index: usize) -> f64 {
        if node.cmpge(self.layout.size() - 1).any() {
            return 0.0;
        }
        let corners = corners(&self.layout);
        let modulus = |offset: usize| {
            let solid = self.matter[index + offset].solid();
            solid.map_or(0.0, |solid| LatticeModuli::of(solid, self.spacing).volume)
        };
        let compliance: f64 = corners.iter().map(|&offset| modulus(offset).recip()).sum();
        let mobile = corners.iter().any(|&offset| self.is_mobile(index + offset));
        if compliance.is_finite() && mobile {
            8.0 / compliance
        } else {
            0.0
        }
    }

    /// Ties border nodes to the body behind.
    fn ground_border(&mut self) {
        self.ground.clear();
        for (_, index) in self.layout.nodes() {
            if self.cut[index] == 0 || !self.is_mobile(index) {
                continue;
            }
            match self.border {
                Border::Free => {}
                Border::Held => {
                    for axis in &mut self.held {
                        axis[index] = true;
                    }
                }
                Border::Endless { load } => {
                    let stiffness = self.spring_behind(index, self.cut[index], load);
                    self.ground.push(Ground {
                        node: index as u32,
                        stiffness,
                        led: DVec3::ZERO,
                    });
                }
            }
        }
    }

    /// The springs of all cut faces of a border node.
    fn spring_behind(&self, index: usize, cut: u8, load: DVec3) -> DMat3 {
        let NodeMatter::Deformable(solid) = self.matter[index] else {
            return DMat3::ZERO;
        };
        let poisson = LatticeModuli::of(&solid, self.spacing).poisson;
        let solid = Solid { poisson, ..solid };
        let from_load = self.rest_place(index) - load;
        // a load in the border itself would be held by an endless spring
        let from_load = from_load * (self.spacing / from_load.length().max(1e-9)).max(1.0);
        let mut spring = DMat3::ZERO;
        for face in (0..6).filter(|face| cut >> face & 1 == 1) {
            // an edge of the box belongs by half to each of its faces
            let others = (cut & !(1 << face)).count_ones();
            let area = self.spacing * self.spacing * 0.5f64.powi(others as i32);
            spring += spring_of_endless_body(&solid, from_load, outward(face).as_dvec3()) * area;
        }
        spring
    }

    /// Works out what follows from bonds and cells: masses, free nodes, chunks in use.
    pub(super) fn settle_structure(&mut self) {
        self.bonds.find_used();
        self.cells.find_used();
        self.find_masses();
        self.find_free_nodes();
    }

    fn find_masses(&mut self) {
        let mut along = zero_field(self.layout.len());
        for family in 0..FAMILY_COUNT {
            let offset = self.layout.offset(family);
            let length = rest_length(family, self.spacing);
            for axis in 0..3 {
                let share = (f64::from(FAMILIES[family][axis]) * self.spacing / length).powi(2);
                for (_, index) in self.layout.nodes() {
                    let stiffness = share * self.bonds.stiffness[family][index];
                    along[axis][index] += stiffness;
                    along[axis][index + offset] += stiffness;
                }
            }
        }
        let corners = corners(&self.layout);
        for (_, index) in self.layout.nodes() {
            for axis in &mut along {
                for offset in corners {
                    axis[index + offset] += self.cells.modulus[index] * self.spacing / 4.0;
                }
            }
        }
        for ground in &self.ground {
            for (axis, along) in along.iter_mut().enumerate() {
                along[ground.node as usize] += ground.stiffness.col(axis)[axis];
            }
        }
        for (index, mass) in self.mass.iter_mut().enumerate() {
            *mass = along[0][index].max(along[1][index]).max(along[2][index]);
        }
    }

    fn find_free_nodes(&mut self) {
        self.free_nodes.clear();
        for index in 0..self.layout.len() {
            if self.node_stiffness[index] > 0.0 && self.misses_a_bond(index) {
                self.free_nodes.push(index as u32);
            }
        }
    }

    /// Whether a node has no bond to one of its 18 neighbours in the box.
    fn misses_a_bond(&self, index: usize) -> bool {
        let Some(node) = self.layout.node_at(index) else {
            return false;
        };
        FAMILIES.iter().enumerate().any(|(family, step)| {
            let step = IVec3::from_array(*step);
            let upper = self.layout.index_of(node.as_ivec3() + step);
            let lower = self.layout.index_of(node.as_ivec3() - step);
            let bonds = &self.bonds.stiffness[family];
            let both_held = |far: usize| {
                self.node_stiffness[far] > 0.0 && !self.is_mobile(index) && !self.is_mobile(far)
            };
            upper.is_some_and(|far| bonds[index] == 0.0 && !both_held(far))
                || lower.is_some_and(|far| bonds[far] == 0.0 && !both_held(far))
        })
    }
}

/// The outward normal of a face of the box; faces come in pairs, lower and upper.
fn outward(face: usize) -> IVec3 {
    let mut normal = IVec3::ZERO;
    normal[face / 2] = 2 * (face as i32 % 2) - 1;
    normal
}
