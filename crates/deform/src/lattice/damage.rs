//! What stays in matter while the box is elsewhere: that bonds broke, how far they yielded, and
//! where nodes came to rest since.
//!
//! A bond is known by the place of its lower node in the scan, which is the same wherever the
//! box is. Creep is not kept: it fades while nobody looks.

use std::collections::BTreeMap;

use glam::{DVec3, IVec3};

use super::bond_forces::rest_length;
use super::layout::FAMILY_COUNT;
use super::moving_box::MovingBox;
use super::vectors::vector_at;

/// What does not come back in one bond.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct BondScar {
    broken: bool,
    /// How much longer it is at rest than at first [mm].
    longer: f64,
}

/// What does not come back at one node.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct NodeScar {
    /// The bonds to its upper neighbours.
    bonds: [BondScar; FAMILY_COUNT],
    /// How far it rests from where it was at first [mm].
    lasting: DVec3,
}

/// All nodes that are not as at first, counted from the corner of the grid.
#[derive(Clone, Debug, Default)]
pub(super) struct Scars(BTreeMap<[i32; 3], NodeScar>);

impl Scars {
    /// Keeps what happened in a box.
    pub fn keep(&mut self, matter: &MovingBox) {
        let (lattice, inelastic) = (&matter.lattice, &matter.inelastic);
        for (node, index) in lattice.layout().nodes() {
            let scar = NodeScar {
                bonds: std::array::from_fn(|family| BondScar {
                    broken: inelastic.broken[family][index],
                    longer: inelastic.base[family][index] - rest_length(family, lattice.spacing()),
                }),
                lasting: vector_at(&matter.lasting, index),
            };
            let place = (matter.origin + node.as_ivec3()).to_array();
            if scar == NodeScar::default() {
                self.0.remove(&place);
            } else {
                self.0.insert(place, scar);
            }
        }
    }

    /// Puts what is known of the places of a box into it. Nodes that it did not have before stand
    /// where they came to rest.
    pub fn recall(&self, matter: &mut MovingBox, is_new: impl Fn(IVec3) -> bool) {
        if self.0.is_empty() {
            return;
        }
        let spacing = matter.lattice.spacing();
        for (node, index) in matter.lattice.layout.nodes() {
            let node = node.as_ivec3();
            let Some(scar) = self.0.get(&(matter.origin + node).to_array()) else {
                continue;
            };
            for (family, bond) in scar.bonds.iter().enumerate() {
                let rest = rest_length(family, spacing) + bond.longer;
                matter.inelastic.broken[family][index] = bond.broken;
                matter.inelastic.base[family][index] = rest;
                matter.lattice.bonds.rest[family][index] = rest;
            }
            if is_new(node) {
                matter.begin_at(index, scar.lasting);
            }
        }
        matter.inelastic.break_again(&mut matter.lattice);
    }
}
