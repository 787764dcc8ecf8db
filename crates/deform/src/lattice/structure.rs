//! What follows from what the nodes are made of: bonds, cells, border springs, masses.

use glam::{DMat3, DVec3, IVec3, UVec3};

use super::bond_forces::rest_length;
use super::border::{Border, Ground, spring_of_endless_body};
use super::coarse::{Coarse, MODES};
use super::layout::{FAMILIES, FAMILY_COUNT, Layout};
use super::moduli::LatticeModuli;
use super::nodes::{Lattice, NodeMaterial};
use super::pressure_easing::EASED_FROM;
use super::stiffening::Stiffening;
use super::turning::{Turning, TurningNode, turning_stiffness};
use super::vectors::zero_field;
use super::volume_forces::corners;
use crate::material::{Solid, pair_stiffness};

/// From here on, stiffer nodes are held: what they would give is below a thousandth of what
/// their neighbours give.
const HELD_RATIO: f64 = 1e3;

impl Lattice {
    /// Asks what every node is made of, and those one step outside, and builds all of it.
    pub(super) fn build(&mut self, matter: &impl Fn(IVec3) -> NodeMaterial) {
        let all: Vec<_> = self.layout.nodes().collect();
        for &(node, index) in &all {
            self.put(index, matter(node.as_ivec3()));
        }
        self.hold_what_is_rigid();
        for &(node, index) in &all {
            self.cut[index] = self.cut_faces(node, index, faces_at(&self.layout, node), matter);
        }
        let all = vec![true; self.layout.len()];
        self.connect(&all, None);
    }

    /// Puts other tissue on some nodes, and builds anew what hangs on them; broken bonds come
    /// back whole. Nodes that have become empty are at rest.
    pub(super) fn change(
        &mut self,
        changes: &[(usize, NodeMaterial)],
        matter: &impl Fn(IVec3) -> NodeMaterial,
    ) {
        let mut near = vec![false; self.layout.len()];
        for &(index, matter) in changes {
            self.put(index, matter);
            if let Some(node) = self.layout.node_at(index) {
                self.mark_around(node, &mut near);
            }
        }
        self.hold_anew(&mut near);
        for (node, index) in self.layout.nodes().filter(|&(_, n)| near[n]) {
            self.cut[index] = self.cut_faces(node, index, faces_at(&self.layout, node), matter);
        }
        self.connect(&near, None);
    }

    /// Holds what is rigid by now, and marks what hangs on nodes that are held or let go by that. Nodes
    /// that are held are at rest.
    pub(super) fn hold_anew(&mut self, near: &mut [bool]) {
        let held_before = self.held[0].clone();
        self.hold_what_is_rigid();
        for (node, index) in self.layout.nodes() {
            if self.held[0][index] != held_before[index] {
                self.mark_around(node, near);
            }
            if !self.is_mobile(index) {
                self.set_moved(index, DVec3::ZERO);
            }
        }
    }

    /// Marks a node and all from which a bond or a cell leads to it.
    pub(super) fn mark_around(&self, node: UVec3, near: &mut [bool]) {
        for corner in 0..27 {
            let step = IVec3::new(corner % 3, corner / 3 % 3, corner / 9) - 1;
            if let Some(place) = self.layout.index_of(node.as_ivec3() + step) {
                near[place] = true;
            }
        }
    }

    pub(super) fn put(&mut self, index: usize, matter: NodeMaterial) {
        self.matter[index] = matter;
        let moduli = matter
            .solid()
            .map(|solid| LatticeModuli::of(solid, self.spacing));
        self.node_stiffness[index] = moduli.map_or(0.0, |moduli| moduli.bond);
        self.node_volume[index] = moduli.map_or(0.0, |moduli| moduli.volume);
    }

    /// Holds what is rigid or much stiffer than the rest.
    fn hold_what_is_rigid(&mut self) {
        let moduli = self.matter.iter().filter_map(|matter| match matter {
            NodeMaterial::Deformable(solid) => Some(solid.young),
            _ => None,
        });
        let softest = moduli.fold(f64::INFINITY, f64::min);
        for (index, matter) in self.matter.iter().enumerate() {
            let gives = matches!(matter, NodeMaterial::Deformable(solid)
                if solid.young <= HELD_RATIO * softest);
            for axis in &mut self.held {
                axis[index] = !gives;
            }
        }
    }

    /// Builds what begins at the marked nodes, and all that follows; `gone` is how far the box went,
    /// where it is the same tissue.
    pub(super) fn connect(&mut self, marked: &[bool], gone: Option<IVec3>) {
        for (node, index) in self.layout.nodes().filter(|&(_, index)| marked[index]) {
            self.bond(node, index);
            self.cells.modulus[index] = self.modulus_of_cell(node, index);
            self.effort.built += 1;
        }
        self.ground_border();
        self.settle_frame();
        self.settle_structure();
        if let Border::Endless { load } = self.border {
            let last = self.coarse.take();
            let last = last
                .zip(gone)
                .filter(|(coarse, gone)| coarse.serves(self, *gone));
            let coarse = match last {
                Some((coarse, gone)) => coarse.at(self, gone),
                None => {
                    self.effort.evaluations += MODES as u64;
                    Coarse::new(self, load)
                }
            };
            self.coarse = Some(coarse);
        }
    }

    /// Of some faces of the box at which a node lies, two bits for each axis, those behind which its
    /// tissue goes on.
    pub(super) fn cut_faces(
        &self,
        node: UVec3,
        index: usize,
        faces: u8,
        matter: &impl Fn(IVec3) -> NodeMaterial,
    ) -> u8 {
        if self.matter[index] == NodeMaterial::Empty {
            return 0;
        }
        let goes_on = |face: &usize| {
            faces >> face & 1 == 1
                && matter(node.as_ivec3() + outward(*face)) != NodeMaterial::Empty
        };
        (0..6).filter(goes_on).fold(0, |cut, face| cut | 1 << face)
    }

    /// Bonds a node to its upper neighbours. A bond along the border belongs by half to the body
    /// behind it.
    fn bond(&mut self, node: UVec3, index: usize) {
        for family in 0..FAMILY_COUNT {
            let step = IVec3::from_array(FAMILIES[family]);
            let Some(far) = self.layout.index_of(node.as_ivec3() + step) else {
                self.bonds.stiffness[family][index] = 0.0;
                continue;
            };
            let shared = (self.cut[index] & self.cut[far]).count_ones();
            let gives = self.is_mobile(index) || self.is_mobile(far);
            let stiffness = pair_stiffness(self.node_stiffness[index], self.node_stiffness[far]);
            self.bonds.stiffness[family][index] = match gives {
                true => self.instant * stiffness * 0.5f64.powi(shared as i32),
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
        let compliance = |offset: &usize| self.node_volume[index + offset].recip();
        let compliance: f64 = corners.iter().map(compliance).sum();
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
        let mut turning = Vec::new();
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
                    let (stiffness, node) = self.held_behind(index, load);
                    turning.push(TurningNode {
                        ground: self.ground.len() as u32,
                        ..node
                    });
                    self.ground.push(Ground {
                        node: index as u32,
                        stiffness,
                        led: DVec3::ZERO,
                    });
                }
            }
        }
        self.turning = Turning::new(turning);
    }

    /// The springs of all cut faces of a border node, and what holds it back from turning.
    fn held_behind(&self, index: usize, load: DVec3) -> (DMat3, TurningNode) {
        let arm = self.rest_place(index) - load;
        // a load in the border itself would be held by an endless spring
        let arm = arm * (self.spacing / arm.length().max(1e-9)).max(1.0);
        let (mut spring, mut stiffness) = (DMat3::ZERO, 0.0);
        if let NodeMaterial::Deformable(solid) = self.matter[index] {
            let poisson = LatticeModuli::of(&solid, self.spacing).poisson;
            let solid = Solid { poisson, ..solid };
            let turning = turning_stiffness(solid.shear(), poisson, arm.length());
            let cut = self.cut[index];
            for face in (0..6).filter(|face| cut >> face & 1 == 1) {
                // an edge of the box belongs by half to each of its faces
                let others = (cut & !(1 << face)).count_ones();
                let area = self.spacing * self.spacing * 0.5f64.powi(others as i32);
                let outward = outward(face).as_dvec3();
                spring += spring_of_endless_body(&solid, arm, outward) * area;
                stiffness += turning * area * arm.normalize_or_zero().dot(outward).max(0.0);
            }
        }
        let turning = TurningNode {
            ground: 0,
            arm,
            stiffness,
        };
        (spring, turning)
    }

    /// Works out what follows from bonds and cells: stiffening, masses, free nodes, chunks in use.
    pub(super) fn settle_structure(&mut self) {
        self.stiffening = Stiffening::of(self);
        self.bonds.find_used();
        self.cells.find_used();
        self.find_eased_cells();
        self.find_masses();
        self.find_free_nodes();
    }

    /// Finds the cells with a node of nearly incompressible tissue.
    fn find_eased_cells(&mut self) {
        let matter = self.matter.iter();
        let near: Vec<bool> = matter
            .map(|matter| matter.solid().is_some_and(|s| s.poisson > EASED_FROM))
            .collect();
        let any = near.contains(&true);
        let corners = corners(&self.layout);
        let is_near = |index: usize| corners.iter().any(|offset| near[index + offset]);
        for (index, eased) in self.cells.eased.iter_mut().enumerate() {
            *eased = any && self.cells.modulus[index] > 0.0 && is_near(index);
        }
    }

    fn find_masses(&mut self) {
        let mut along = zero_field(self.layout.len());
        for family in 0..FAMILY_COUNT {
            let offset = self.layout.offset(family);
            let length = rest_length(family, self.spacing);
            for axis in (0..3).filter(|axis| FAMILIES[family][*axis] != 0) {
                let share = (f64::from(FAMILIES[family][axis]) * self.spacing / length).powi(2);
                for (index, stiffness) in self.bonds.stiffness[family].iter().enumerate() {
                    if *stiffness > 0.0 {
                        along[axis][index] += share * stiffness;
                        along[axis][index + offset] += share * stiffness;
                    }
                }
            }
        }
        let corners = corners(&self.layout);
        for (index, modulus) in self.cells.modulus.iter().enumerate() {
            if *modulus > 0.0 && !self.cells.eased[index] {
                for axis in &mut along {
                    for offset in corners {
                        axis[index + offset] += modulus * self.spacing / 4.0;
                    }
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
        for (node, index) in self.layout.nodes() {
            if self.node_stiffness[index] > 0.0 && self.misses_a_bond(node, index) {
                self.free_nodes.push(index as u32);
            }
        }
    }

    /// Whether a node has no bond to one of its 18 neighbours in the box.
    fn misses_a_bond(&self, node: UVec3, index: usize) -> bool {
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

/// The faces of the box at which a node lies, two bits for each axis.
pub(super) fn faces_at(layout: &Layout, node: UVec3) -> u8 {
    let last = layout.size() - 1;
    let at_face = |face: &usize| node[face / 2] == [0, last[face / 2]][face % 2];
    (0..6)
        .filter(at_face)
        .fold(0, |faces, face| faces | 1 << face)
}

/// The outward normal of a face of the box; faces come in pairs, lower and upper.
fn outward(face: usize) -> IVec3 {
    let mut normal = IVec3::ZERO;
    normal[face / 2] = 2 * (face as i32 % 2) - 1;
    normal
}
