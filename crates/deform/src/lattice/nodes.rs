//! A box of nodes with their bonds and what each is made of.

use glam::{DMat3, DVec3, IVec3, UVec3};

use super::bond_forces::{Bonds, add_bond_forces, bond_energy, rest_length};
use super::border::{Border, Ground, spring_of_endless_body};
use super::coarse::Coarse;
use super::layout::{FAMILIES, FAMILY_COUNT, Layout};
use super::moduli::LatticeModuli;
use super::tool_contact::ContactNode;
use super::vectors::{Field, zero_field};
use super::volume_forces::{Cells, add_volume_forces, corners, volume_energy};
use crate::material::{Solid, pair_stiffness};

/// From here on, stiffer nodes are held: what they would give is below a thousandth of what
/// their neighbours give.
const HELD_RATIO: f64 = 1e3;

/// What a node is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NodeMatter {
    /// Nothing.
    Empty,
    /// It gives.
    Deformable(Solid),
    /// It stays where it is.
    Rigid(Solid),
}

impl NodeMatter {
    /// Its constants; none where there is nothing.
    #[must_use]
    pub fn solid(&self) -> Option<&Solid> {
        match self {
            Self::Empty => None,
            Self::Deformable(solid) | Self::Rigid(solid) => Some(solid),
        }
    }
}

/// A box of nodes: what they are, how they are bonded and where they stand.
///
/// Arrays have one entry for each place in memory; see [`Layout`].
#[derive(Clone, Debug)]
pub struct Lattice {
    pub(super) layout: Layout,
    /// Between nodes [mm].
    pub(super) spacing: f64,
    /// What each node is made of.
    pub(super) matter: Vec<NodeMatter>,
    /// Stiffness of the bonds of a body all of this node's matter [N/mm]; 0 where empty.
    pub(super) node_stiffness: Vec<f64>,
    pub(super) bonds: Bonds,
    pub(super) cells: Cells,
    pub(super) ground: Vec<Ground>,
    /// The smooth displacements of the whole box; only where the body goes on behind it.
    pub(super) coarse: Option<Coarse>,
    /// Stiffness that each node feels along the stiffest axis [N/mm]: its mass.
    pub(super) mass: Vec<f64>,
    /// Along which axes a node never moves. Shape [3, nodes].
    pub(super) held: [Vec<bool>; 3],
    /// Nodes with matter that miss a bond inside the box, by rising place.
    pub(super) free_nodes: Vec<u32>,
    /// Displacement from rest [mm].
    pub(super) moved: Field,
    /// Force of the last evaluation [N].
    pub(super) force: Field,
}

impl Lattice {
    /// A box of `size` nodes, at rest; `matter` is asked for every node and for those one step
    /// outside, by which the border knows where matter goes on.
    ///
    /// # Panics
    /// Where the spacing is no length or the box has fewer than 2 or more than 256 nodes along
    /// an axis.
    #[must_use]
    pub fn new(
        size: UVec3,
        spacing: f64,
        border: Border,
        matter: impl Fn(IVec3) -> NodeMatter,
    ) -> Self {
        assert!(spacing > 0.0 && spacing.is_finite(), "spacing {spacing}");
        let layout = Layout::new(size);
        let length = layout.len();
        let mut lattice = Self {
            layout,
            spacing,
            matter: vec![NodeMatter::Empty; length],
            node_stiffness: vec![0.0; length],
            bonds: Bonds::none(&layout, spacing),
            cells: Cells::none(&layout),
            ground: Vec::new(),
            coarse: None,
            mass: vec![0.0; length],
            held: std::array::from_fn(|_| vec![true; length]),
            free_nodes: Vec::new(),
            moved: zero_field(length),
            force: zero_field(length),
        };
        lattice.fill(&matter);
        let cut = lattice.cut_faces(&matter);
        lattice.bond(&cut);
        lattice.close_cells();
        lattice.ground_border(border, &cut);
        lattice.settle_structure();
        if let Border::Endless { load } = border {
            lattice.coarse = Some(Coarse::new(&lattice, load));
        }
        lattice
    }

    /// Sizes and places in memory.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Between nodes [mm].
    #[must_use]
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// What a node is made of.
    #[must_use]
    pub fn matter(&self, index: usize) -> &NodeMatter {
        &self.matter[index]
    }

    /// Where a node stands [mm].
    #[must_use]
    pub fn place(&self, index: usize) -> DVec3 {
        self.rest_place(index) + self.moved(index)
    }

    /// Where a node stands at rest [mm].
    #[must_use]
    pub fn rest_place(&self, index: usize) -> DVec3 {
        let node = self.layout.node_at(index).unwrap_or_default();
        node.as_dvec3() * self.spacing
    }

    /// How far a node has moved from rest [mm].
    #[must_use]
    pub fn moved(&self, index: usize) -> DVec3 {
        DVec3::new(
            self.moved[0][index],
            self.moved[1][index],
            self.moved[2][index],
        )
    }

    /// Moves a node, wherever it is held or not [mm from rest].
    pub fn set_moved(&mut self, index: usize, moved: DVec3) {
        for axis in 0..3 {
            self.moved[axis][index] = moved[axis];
        }
    }

    /// Force on a node at the last evaluation [N].
    #[must_use]
    pub fn force(&self, index: usize) -> DVec3 {
        DVec3::new(
            self.force[0][index],
            self.force[1][index],
            self.force[2][index],
        )
    }

    /// Holds a node along one axis where it is, or lets it go.
    pub fn hold(&mut self, index: usize, axis: usize, held: bool) {
        self.held[axis][index] = held;
    }

    /// Bonds that hold, each with both ends.
    pub fn bonded_pairs(&self) -> impl Iterator<Item = [usize; 2]> {
        (0..FAMILY_COUNT).flat_map(|family| {
            let offset = self.layout.offset(family);
            let bonds = self.bonds.stiffness[family].iter().enumerate();
            bonds
                .filter(|(_, stiffness)| **stiffness > 0.0)
                .map(move |(index, _)| [index, index + offset])
        })
    }

    /// Puts all nodes back to rest, as far as they were not broken or yielded.
    pub fn put_to_rest(&mut self) {
        for axis in &mut self.moved {
            axis.fill(0.0);
        }
    }

    /// Places of all nodes with matter, in the order of memory.
    pub fn matter_nodes(&self) -> impl Iterator<Item = usize> {
        let stiffness = self.node_stiffness.iter().enumerate();
        stiffness.filter(|(_, k)| **k > 0.0).map(|(index, _)| index)
    }

    /// Whether a node moves along any axis.
    #[must_use]
    pub fn is_mobile(&self, index: usize) -> bool {
        (0..3).any(|axis| !self.held[axis][index])
    }

    /// Works the forces of bonds, cells and border out, anew.
    pub fn evaluate(&mut self) {
        for axis in &mut self.force {
            axis.fill(0.0);
        }
        let Self {
            layout,
            spacing,
            bonds,
            cells,
            moved,
            force,
            ..
        } = self;
        add_bond_forces(layout, *spacing, bonds, moved, force);
        add_volume_forces(layout, *spacing, cells, moved, force);
        for ground in &self.ground {
            let node = ground.node as usize;
            let pull = ground.stiffness * self.moved(node);
            for axis in 0..3 {
                self.force[axis][node] -= pull[axis];
            }
        }
    }

    /// Moves all nodes by a step of the coarse level, where there is one.
    pub(super) fn correct_coarsely(&mut self, touched: &[ContactNode]) {
        // taken out, since it changes the lattice that holds it
        if let Some(coarse) = self.coarse.take() {
            coarse.correct(self, touched);
            self.coarse = Some(coarse);
        }
    }

    /// Energy of bonds, cells and border [N·mm].
    #[must_use]
    pub fn energy(&self) -> f64 {
        let ground = |ground: &Ground| {
            let moved = self.moved(ground.node as usize);
            0.5 * moved.dot(ground.stiffness * moved)
        };
        bond_energy(&self.layout, self.spacing, &self.bonds, &self.moved)
            + volume_energy(&self.layout, self.spacing, &self.cells, &self.moved)
            + self.ground.iter().map(ground).sum::<f64>()
    }

    /// Puts matter on the nodes, and holds what is rigid.
    fn fill(&mut self, matter: &impl Fn(IVec3) -> NodeMatter) {
        for (node, index) in self.layout.nodes() {
            self.matter[index] = matter(node.as_ivec3());
            if let Some(solid) = self.matter[index].solid() {
                self.node_stiffness[index] = LatticeModuli::of(solid, self.spacing).bond;
            }
        }
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

    /// For each node, the faces of the box (two bits for each axis) behind which matter goes on.
    fn cut_faces(&self, matter: &impl Fn(IVec3) -> NodeMatter) -> Vec<u8> {
        let mut cut = vec![0; self.layout.len()];
        let last = self.layout.size().as_ivec3() - 1;
        for (node, index) in self.layout.nodes() {
            if self.matter[index] == NodeMatter::Empty {
                continue;
            }
            let node = node.as_ivec3();
            for face in 0..6 {
                let outward = outward(face);
                let axis = face / 2;
                let at_face = node[axis] == if face % 2 == 0 { 0 } else { last[axis] };
                if at_face && matter(node + outward) != NodeMatter::Empty {
                    cut[index] |= 1 << face;
                }
            }
        }
        cut
    }

    /// Bonds all neighbours. A bond along the border belongs by half to the body behind it.
    fn bond(&mut self, cut: &[u8]) {
        for family in 0..FAMILY_COUNT {
            let step = IVec3::from_array(FAMILIES[family]);
            for (node, index) in self.layout.nodes() {
                let Some(far) = self.layout.index_of(node.as_ivec3() + step) else {
                    continue;
                };
                let stiffness =
                    pair_stiffness(self.node_stiffness[index], self.node_stiffness[far]);
                let shared = (cut[index] & cut[far]).count_ones();
                if self.is_mobile(index) || self.is_mobile(far) {
                    self.bonds.stiffness[family][index] = stiffness * 0.5f64.powi(shared as i32);
                }
            }
        }
    }

    /// Gives every cell of 8 nodes with matter its volume term: their harmonic mean.
    fn close_cells(&mut self) {
        let corners = corners(&self.layout);
        let last = self.layout.size() - 1;
        for (node, index) in self.layout.nodes() {
            if node.cmpge(last).any() {
                continue;
            }
            let modulus = |offset: usize| {
                let solid = self.matter[index + offset].solid();
                solid.map_or(0.0, |solid| LatticeModuli::of(solid, self.spacing).volume)
            };
            // a cell with a corner without modulus has none
            let compliance: f64 = corners.iter().map(|&offset| modulus(offset).recip()).sum();
            let mobile = corners.iter().any(|&offset| self.is_mobile(index + offset));
            if compliance.is_finite() && mobile {
                self.cells.modulus[index] = 8.0 / compliance;
            }
        }
    }

    /// Ties border nodes to the body behind.
    fn ground_border(&mut self, border: Border, cut: &[u8]) {
        for (_, index) in self.layout.nodes() {
            if cut[index] == 0 || !self.is_mobile(index) {
                continue;
            }
            match border {
                Border::Free => {}
                Border::Held => {
                    for axis in &mut self.held {
                        axis[index] = true;
                    }
                }
                Border::Endless { load } => {
                    let stiffness = self.spring_behind(index, cut[index], load);
                    self.ground.push(Ground {
                        node: index as u32,
                        stiffness,
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
