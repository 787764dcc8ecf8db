//! What is seen of the whole segment: how far its tissue stands from where its voxels are.
//!
//! Voxels follow the box alone ([`super::write_back`]). The body behind it is moved for the eye, on nodes finer
//! than its lattice so that what is rigid beside it stays: these stand still, empty ones go along with the tissue
//! beside them, and where the box shows tissue itself the body's share ends as that begins.
//!
//! Frame: mm along the axes of the grid, from its corner. Source: thesis 5.29.

use glam::{DVec3, UVec3};

use super::moving_box::MovingBox;
use super::nodes::NodeMaterial;
use super::whole_sites::MatterAt;
use crate::displacement::{BESIDE, Displacement, node_at};
use crate::model::DisplacementField;

/// Nodes of the box around a segment, about, without its margin: eight bytes each for the page in an answer.
const NODES: f64 = 8192.0;
/// Nodes beyond it, in which what stands beside its surface goes along less and less.
const MARGIN: f64 = BESIDE.len() as f64 + 1.0;
/// Share of the way to where tissue stands in one answer: at a new load it would jump.
const BLEND: f64 = 0.3;
/// What is as good as there [mm].
const SAME: f64 = 1e-3;

/// What stands at a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Empty,
    Rigid,
    Soft,
}

/// The nodes by which a segment is seen to move.
#[derive(Debug)]
pub(super) struct WholePicture {
    first: DVec3,
    spacing: f64,
    size: UVec3,
    kinds: Vec<Kind>,
    /// How far each of the soft ones is moved [mm].
    moved: Vec<DVec3>,
}

impl WholePicture {
    /// Of a segment with its lower and upper corner, by what stands there; no finer than `least` [mm].
    pub fn new([low, high]: [DVec3; 2], least: f64, matter: MatterAt<'_>) -> Self {
        let volume = (high - low).element_product();
        let spacing = (volume / NODES).cbrt().max(least);
        let first = low - MARGIN * spacing;
        let size = ((high - first) / spacing + MARGIN).ceil() + 1.0;
        let size = size
            .clamp(DVec3::splat(2.0), DVec3::splat(256.0))
            .as_uvec3();
        let count = size.element_product() as usize;
        let kind = |index| match matter(place_of(first, spacing, size, index)) {
            NodeMaterial::Empty => Kind::Empty,
            NodeMaterial::Rigid(_) => Kind::Rigid,
            NodeMaterial::Deformable(_) => Kind::Soft,
        };
        Self {
            first,
            spacing,
            size,
            kinds: (0..count).map(kind).collect(),
            moved: vec![DVec3::ZERO; count],
        }
    }

    /// Where its nodes of tissue rest.
    pub fn soft_places(&self) -> impl Iterator<Item = DVec3> {
        self.soft().map(|index| self.place(index))
    }

    /// Goes toward where the tissue of those nodes stands, moved by so much [mm].
    pub fn follow(&mut self, moved: &[DVec3]) {
        let soft: Vec<_> = self.soft().collect();
        for (index, moved) in soft.into_iter().zip(moved) {
            let way = *moved - self.moved[index];
            let share = if way.length() < SAME { 1.0 } else { BLEND };
            self.moved[index] += way * share;
        }
    }

    /// Everything stands in its voxels.
    pub fn let_go(&mut self) {
        self.moved.fill(DVec3::ZERO);
    }

    /// What is seen beside a box that shows its own tissue; none where all is below `least` [mm].
    pub fn field(&self, near: &MovingBox, least: f64) -> Option<DisplacementField> {
        let moved = |index: usize| match self.kinds[index] {
            Kind::Empty => None,
            Kind::Rigid => Some(DVec3::ZERO),
            Kind::Soft => Some(self.moved[index] * (1.0 - near.share_at(self.place(index)))),
        };
        let moved = (0..self.moved.len()).map(moved).collect();
        let field = Displacement::new(self.first, self.spacing, self.size, moved);
        field.whole(&near.grid, least, f64::INFINITY)
    }

    fn soft(&self) -> impl Iterator<Item = usize> {
        (0..self.kinds.len()).filter(|index| self.kinds[*index] == Kind::Soft)
    }

    fn place(&self, index: usize) -> DVec3 {
        place_of(self.first, self.spacing, self.size, index)
    }
}

/// Of a node in a box of so many, the first of which stands at `first`.
fn place_of(first: DVec3, spacing: f64, size: UVec3, index: usize) -> DVec3 {
    first + node_at(size, index).as_dvec3() * spacing
}
