//! A box of nodes with their bonds and what each is made of.

use glam::{DVec3, IVec3, UVec3};

use super::bond_forces::{Bonds, add_bond_forces, bond_energy};
use super::border::{Border, Frame, Ground};
use super::coarse::Coarse;
use super::layout::{FAMILY_COUNT, Layout};
use super::stiffening::Stiffening;
use super::turning::Turning;
use super::vectors::{Field, vector_at, zero_field};
use super::volume_forces::{Cells, add_volume_forces, volume_energy};
use crate::material::Solid;
use crate::model::Effort;

/// What a node is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NodeMaterial {
    /// No tissue.
    Empty,
    /// Deformable tissue.
    Deformable(Solid),
    /// Rigid: the node stays where it is.
    Rigid(Solid),
}

impl NodeMaterial {
    /// Elastic constants; none for an empty node.
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
    pub(super) matter: Vec<NodeMaterial>,
    /// Stiffness of the bonds of a body all of this node's tissue [N/mm]; 0 where empty.
    pub(super) node_stiffness: Vec<f64>,
    /// Bulk modulus that the volume term adds in a body all of this node's tissue [N/mm²].
    pub(super) node_volume: Vec<f64>,
    pub(super) bonds: Bonds,
    /// How bonds stiffen with strain; none where nothing does.
    pub(super) stiffening: Option<Stiffening>,
    pub(super) cells: Cells,
    pub(super) ground: Vec<Ground>,
    pub(super) border: Border,
    /// What holds the border back from turning as one.
    pub(super) turning: Turning,
    /// The body behind the border, as one.
    pub(super) frame: Frame,
    /// Forces from elsewhere, each on a node [N].
    pub(super) loads: Vec<(u32, DVec3)>,
    /// For each node, the faces of the box (a bit each) behind which tissue goes on.
    pub(super) cut: Vec<u8>,
    /// Stiffness of bonds as they are put under strain at once over that in the end.
    pub(super) instant: f64,
    /// The smooth displacements of the whole box; only where the body goes on behind it.
    pub(super) coarse: Option<Coarse>,
    /// Stiffness that each node feels along the stiffest axis [N/mm]: its mass.
    pub(super) mass: Vec<f64>,
    /// Along which axes a node never moves. Shape [3, nodes].
    pub(super) held: [Vec<bool>; 3],
    /// Nodes with tissue that miss a bond inside the box, by rising place.
    pub(super) free_nodes: Vec<u32>,
    /// Displacement from rest [mm].
    pub(super) moved: Field,
    /// Force of the last evaluation [N].
    pub(super) force: Field,
    /// What was built since this was last taken.
    pub(super) effort: Effort,
}

impl Lattice {
    /// A box of `size` nodes, at rest; `matter` is asked for every node and for those one step
    /// outside, by which the border knows where tissue goes on.
    ///
    /// # Panics
    /// Where the spacing is no length or the box has fewer than 2 or more than 256 nodes along
    /// an axis.
    #[must_use]
    pub fn new(
        size: UVec3,
        spacing: f64,
        border: Border,
        matter: impl Fn(IVec3) -> NodeMaterial,
    ) -> Self {
        assert!(spacing > 0.0 && spacing.is_finite(), "spacing {spacing}");
        let layout = Layout::new(size);
        let length = layout.len();
        let mut lattice = Self {
            layout,
            spacing,
            matter: vec![NodeMaterial::Empty; length],
            node_stiffness: vec![0.0; length],
            node_volume: vec![0.0; length],
            bonds: Bonds::none(&layout, spacing),
            stiffening: None,
            cells: Cells::none(&layout),
            ground: Vec::new(),
            border,
            turning: Turning::default(),
            frame: Frame::HELD,
            loads: Vec::new(),
            cut: vec![0; length],
            instant: 1.0,
            coarse: None,
            mass: vec![0.0; length],
            held: std::array::from_fn(|_| vec![true; length]),
            free_nodes: Vec::new(),
            moved: zero_field(length),
            force: zero_field(length),
            effort: Effort::default(),
        };
        lattice.build(&matter);
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
    pub fn matter(&self, index: usize) -> &NodeMaterial {
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

    /// Displacement of a node from rest [mm].
    #[must_use]
    pub fn moved(&self, index: usize) -> DVec3 {
        vector_at(&self.moved, index)
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
        vector_at(&self.force, index)
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

    /// Places of all nodes with tissue, in the order of memory.
    pub fn matter_nodes(&self) -> impl Iterator<Item = usize> {
        let stiffness = self.node_stiffness.iter().enumerate();
        stiffness.filter(|(_, k)| **k > 0.0).map(|(index, _)| index)
    }

    /// Whether tissue is at a node, counted from the first one; there is none outside.
    pub(super) fn has_matter(&self, node: IVec3) -> bool {
        let index = self.layout.index_of(node);
        index.is_some_and(|index| self.node_stiffness[index] > 0.0)
    }

    /// Stiffness of the bonds of the softest tissue that moves [N/mm]; 0 where none does.
    pub(super) fn softest_bond(&self) -> f64 {
        let moving = self.matter_nodes().filter(|node| self.is_mobile(*node));
        let softest = moving.map(|node| self.node_stiffness[node]);
        let softest = softest.fold(f64::INFINITY, f64::min);
        if softest.is_finite() { softest } else { 0.0 }
    }

    /// Whether a node moves along any axis.
    #[must_use]
    pub fn is_mobile(&self, index: usize) -> bool {
        (0..3).any(|axis| !self.held[axis][index])
    }

    /// Works the forces of bonds, cells and border out, anew.
    pub fn evaluate(&mut self) {
        let mut force = std::mem::take(&mut self.force);
        self.forces_at(&self.moved, &mut force);
        self.force = force;
    }

    /// Forces of bonds, cells and border [N] where the nodes have moved so far [mm].
    pub(super) fn forces_at(&self, moved: &Field, force: &mut Field) {
        for axis in &mut *force {
            axis.fill(0.0);
        }
        let growth = self.stiffening.as_ref().map(|s| (s, s.growth(self, moved)));
        let stiffened = growth.as_ref().map(|(s, growth)| (*s, growth.as_slice()));
        add_bond_forces(
            &self.layout,
            self.spacing,
            &self.bonds,
            stiffened,
            moved,
            force,
        );
        add_volume_forces(&self.layout, self.spacing, &self.cells, moved, force);
        let behind = self.border_moved(moved);
        for ground in &self.ground {
            let node = ground.node as usize;
            let at = vector_at(moved, node);
            let pull = ground.stiffness * (at - ground.led - behind);
            for axis in 0..3 {
                force[axis][node] -= pull[axis];
            }
        }
        self.turning.add_forces(&self.ground, behind, moved, force);
        for &(node, load) in &self.loads {
            for axis in 0..3 {
                force[axis][node as usize] += load[axis];
            }
        }
    }

    /// Energy of bonds, cells and border springs [N·mm], nothing behind them moved.
    #[must_use]
    pub fn energy(&self) -> f64 {
        let ground = |ground: &Ground| {
            let moved = self.moved(ground.node as usize) - ground.led;
            0.5 * moved.dot(ground.stiffness * moved)
        };
        let bonds = match &self.stiffening {
            Some(stiffening) => stiffening.energy(self),
            None => bond_energy(&self.layout, self.spacing, &self.bonds, &self.moved),
        };
        bonds
            + volume_energy(&self.layout, self.spacing, &self.cells, &self.moved)
            + self.ground.iter().map(ground).sum::<f64>()
            + self.turning.energy(&self.ground, &self.moved)
    }
}
