//! Contact between nodes that are not bonded: free surfaces that meet, and faces of cracks.
//!
//! Only nodes that miss a bond can meet others. They are sorted into cells as wide as the
//! reach, and pairs of them near each other are kept for one relaxation.

use super::contact_law::{LARGEST_STIFFNESS, contact_push};
use super::layout::FAMILIES;
use super::nodes::Lattice;
use crate::material::pair_stiffness;
use glam::{DVec3, IVec3, UVec3};

/// Distance up to which pairs of nodes are listed [spacings]; they touch at 1.
const REACH: f64 = 1.3;

/// A pair that may touch.
#[derive(Clone, Copy, Debug)]
struct Pair {
    first: u32,
    second: u32,
    /// Stiffness at the distance where they begin to touch [N/mm].
    stiffness: f64,
}

/// All pairs that may touch.
#[derive(Clone, Debug, Default)]
pub(super) struct NodeContacts {
    pairs: Vec<Pair>,
    /// Free nodes sorted by cell, with scratch of the sort.
    sorted: Vec<(u32, u32)>,
}

impl NodeContacts {
    /// Looks for the pairs as the nodes stand now.
    pub fn find(&mut self, lattice: &Lattice) {
        self.pairs.clear();
        self.sort(lattice);
        for place in 0..self.sorted.len() {
            let (_, node) = self.sorted[place];
            for step in half_of_the_cells_around() {
                self.pair_with_cell(lattice, place, node, step);
            }
        }
    }

    /// Sorts free nodes by the cell that they are in.
    fn sort(&mut self, lattice: &Lattice) {
        self.sorted.clear();
        for &node in &lattice.free_nodes {
            let cell = cell_of(lattice, lattice.place(node as usize));
            self.sorted.push((cell_key(cell), node));
        }
        self.sorted.sort_unstable();
    }

    fn pair_with_cell(&mut self, lattice: &Lattice, place: usize, node: u32, step: IVec3) {
        let here = lattice.place(node as usize);
        let key = cell_key(cell_of(lattice, here) + step);
        let begin = if step == IVec3::ZERO {
            place + 1
        } else {
            self.sorted.partition_point(|&(other, _)| other < key)
        };
        let reach = REACH * lattice.spacing;
        for &(other_key, other) in &self.sorted[begin..] {
            if other_key != key {
                break;
            }
            let near = lattice.place(other as usize).distance_squared(here) < reach * reach;
            if near && !is_bonded(lattice, node as usize, other as usize) {
                self.pairs.push(Pair {
                    first: node,
                    second: other,
                    stiffness: pair_stiffness(
                        lattice.node_stiffness[node as usize],
                        lattice.node_stiffness[other as usize],
                    ),
                });
            }
        }
    }

    /// Adds the push of every pair that touches to the forces on its nodes.
    pub fn push(&self, lattice: &mut Lattice) {
        for pair in &self.pairs {
            let [first, second] = [pair.first as usize, pair.second as usize];
            let apart = lattice.place(second) - lattice.place(first);
            let distance = apart.length();
            let push = contact_push(distance, lattice.spacing, pair.stiffness);
            if push.force == 0.0 || distance < 1e-9 * lattice.spacing {
                continue;
            }
            let force = apart * (push.force / distance);
            for axis in 0..3 {
                lattice.force[axis][first] -= force[axis];
                lattice.force[axis][second] += force[axis];
            }
        }
    }

    /// Nodes of all pairs with the largest stiffness that the pair adds to them [N/mm].
    pub fn stiffnesses(&self) -> impl Iterator<Item = (usize, f64)> {
        let both = |pair: &Pair| {
            let stiffness = LARGEST_STIFFNESS * pair.stiffness;
            [
                (pair.first as usize, stiffness),
                (pair.second as usize, stiffness),
            ]
        };
        self.pairs.iter().flat_map(both)
    }
}

/// Cells around the box are those at its border, so that none is ever out of reach.
fn cell_of(lattice: &Lattice, place: DVec3) -> IVec3 {
    let cell = place / (REACH * lattice.spacing);
    // a place that is none ends in cell 0
    cell.clamp(DVec3::splat(-100.0), DVec3::splat(900.0))
        .as_ivec3()
        + 101
}

fn cell_key(cell: IVec3) -> u32 {
    let UVec3 { x, y, z } = cell.as_uvec3();
    (z << 20) | (y << 10) | x
}

/// A cell and those above it in the order of keys.
fn half_of_the_cells_around() -> impl Iterator<Item = IVec3> {
    (0..27)
        .map(|n| IVec3::new(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1))
        .filter(|step| (step.z, step.y, step.x) >= (0, 0, 0))
}

fn is_bonded(lattice: &Lattice, first: usize, second: usize) -> bool {
    let (lower, upper) = (first.min(second), first.max(second));
    let [Some(a), Some(b)] = [lower, upper].map(|index| lattice.layout.node_at(index)) else {
        return false;
    };
    let step = b.as_ivec3() - a.as_ivec3();
    let family = FAMILIES
        .iter()
        .position(|family| step == IVec3::from_array(*family));
    family.is_some_and(|family| lattice.bonds.stiffness[family][lower] > 0.0)
}
