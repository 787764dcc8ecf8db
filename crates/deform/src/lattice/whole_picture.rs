//! What is seen of the whole segment: how far its tissue stands from where its voxels are.
//!
//! Voxels follow the box alone ([`super::write_back`]). The body behind it is moved for the eye, on nodes finer
//! than its lattice so that what is rigid beside it stays: these stand still, empty ones go along with the tissue
//! beside them, and where the box shows tissue itself the body's share ends as that begins.
//!
//! Frame: mm along the axes of the grid, from its corner. Source: thesis 5.29.

use glam::{DVec3, IVec3, UVec3};

use super::layout::Layout;
use super::moving_box::MovingBox;
use super::nodes::NodeMaterial;
use super::whole_sites::MatterAt;
use crate::displacement::BESIDE;
use crate::model::DisplacementField;

/// Nodes of the box around a segment, about, without its margin.
const NODES: f64 = 16384.0;
/// Nodes beyond it, in which what stands beside its surface goes along less and less.
const MARGIN: f64 = BESIDE.len() as f64 + 1.0;
/// Share of the way to where tissue stands in one answer: at a new load it would jump.
const BLEND: f64 = 0.3;
/// What is as good as there [mm].
const SAME: f64 = 1e-3;

/// An empty node that goes along with those of tissue beside it, or with such as do.
#[derive(Clone, Copy, Debug)]
struct Beside {
    node: u32,
    /// The first of those it follows, in [`WholePicture::followed`], and how many.
    first: u32,
    count: u32,
    /// Of their mean displacement.
    share: f64,
}

/// The nodes by which a segment is seen to move.
#[derive(Debug)]
pub(super) struct WholePicture {
    first: DVec3,
    spacing: f64,
    layout: Layout,
    /// Nodes of tissue.
    soft: Vec<u32>,
    /// In the order in which they follow.
    beside: Vec<Beside>,
    followed: Vec<u32>,
    /// How far each node is moved [mm].
    moved: Vec<DVec3>,
}

impl WholePicture {
    /// Of a segment with its lower and upper corner, by what stands there; no finer than `least` [mm].
    pub fn new([low, high]: [DVec3; 2], least: f64, matter: MatterAt<'_>) -> Self {
        let volume = (high - low).element_product();
        let spacing = (volume / NODES).cbrt().max(least);
        let first = low - MARGIN * spacing;
        let size = ((high - first) / spacing + MARGIN).ceil() + 1.0;
        let size = size.clamp(DVec3::splat(2.0), DVec3::splat(256.0));
        let mut picture = Self {
            first,
            spacing,
            layout: Layout::new(size.as_uvec3()),
            soft: Vec::new(),
            beside: Vec::new(),
            followed: Vec::new(),
            moved: Vec::new(),
        };
        picture.moved = vec![DVec3::ZERO; picture.layout.len()];
        let mut empty = vec![false; picture.layout.len()];
        for (node, index) in picture.layout.nodes() {
            match matter(picture.place(node)) {
                NodeMaterial::Empty => empty[index] = true,
                NodeMaterial::Rigid(_) => {}
                NodeMaterial::Deformable(_) => picture.soft.push(index as u32),
            }
        }
        picture.go_along(empty);
        picture
    }

    /// Has empty nodes go along with what is beside them, those that are farther less.
    fn go_along(&mut self, mut empty: Vec<bool>) {
        let mut front = self.soft.clone();
        let mut share_before = 1.0;
        for share in BESIDE {
            let near = front.iter().flat_map(|&node| self.neighbours(node));
            let mut next: Vec<_> = near.filter(|&node| empty[node as usize]).collect();
            next.sort_unstable();
            next.dedup();
            front.sort_unstable();
            for &node in &next {
                let moves = |other: &u32| front.binary_search(other).is_ok();
                let first = self.followed.len();
                let near: Vec<_> = self.neighbours(node).filter(moves).collect();
                self.followed.extend(&near);
                self.beside.push(Beside {
                    node,
                    first: first as u32,
                    count: near.len() as u32,
                    share: share / share_before,
                });
            }
            next.iter().for_each(|&node| empty[node as usize] = false);
            (front, share_before) = (next, share);
        }
    }

    /// Where its nodes of tissue rest.
    pub fn soft_places(&self) -> impl Iterator<Item = DVec3> {
        let node = |index: &u32| self.layout.node_at(*index as usize).unwrap_or_default();
        self.soft.iter().map(move |index| self.place(node(index)))
    }

    /// Goes toward where the tissue of those nodes stands, moved by so much [mm].
    pub fn follow(&mut self, moved: impl Iterator<Item = DVec3>) {
        for (&index, moved) in self.soft.iter().zip(moved) {
            let shown = &mut self.moved[index as usize];
            let way = moved - *shown;
            let share = if way.length() < SAME { 1.0 } else { BLEND };
            *shown += way * share;
        }
        for beside in &self.beside {
            let Beside { first, count, .. } = *beside;
            let near = &self.followed[first as usize..(first + count) as usize];
            let sum: DVec3 = near.iter().map(|node| self.moved[*node as usize]).sum();
            self.moved[beside.node as usize] = sum * (beside.share / f64::from(count));
        }
    }

    /// Everything stands in its voxels.
    pub fn let_go(&mut self) {
        self.moved.fill(DVec3::ZERO);
    }

    /// What is seen beside a box that shows its own tissue; none where all is below `least` [mm].
    pub fn field(&self, near: &MovingBox, least: f64) -> Option<DisplacementField> {
        let seen = self.moved.iter().any(|moved| moved.length() >= least);
        let axes = near.grid.direction();
        let shown = |(node, index): (UVec3, usize)| {
            let share = 1.0 - near.share_at(self.place(node));
            (axes * (self.moved[index] * share)).as_vec3()
        };
        seen.then(|| DisplacementField {
            origin: near.patient_place(self.first - near.corner()),
            axes,
            spacing: self.spacing,
            size: self.layout.size(),
            moved: self.layout.nodes().map(shown).collect(),
        })
    }

    /// The six nodes beside one, as far as they are there.
    fn neighbours(&self, index: u32) -> impl Iterator<Item = u32> {
        let layout = self.layout;
        let node = layout
            .node_at(index as usize)
            .unwrap_or_default()
            .as_ivec3();
        let steps = IVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
        let near = steps.filter_map(move |step| layout.index_of(node + step));
        near.map(|index| index as u32)
    }

    fn place(&self, node: UVec3) -> DVec3 {
        self.first + node.as_dvec3() * self.spacing
    }
}
