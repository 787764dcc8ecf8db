//! What stays in tissue while the box is elsewhere: that bonds broke, how far they yielded, and
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
struct BondDamage {
    broken: bool,
    /// Plastic change of the bond's rest length [mm].
    longer: f64,
}

/// What does not come back at one node.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct NodeDamage {
    /// The bonds to its upper neighbours.
    bonds: [BondDamage; FAMILY_COUNT],
    /// Plastic displacement of the node [mm].
    plastic: DVec3,
}

/// All nodes with damage or plastic change, by their place counted from the corner of the grid.
#[derive(Clone, Debug, Default)]
pub(super) struct Damage(BTreeMap<[i32; 3], NodeDamage>);

impl Damage {
    /// Keeps what happened in a box.
    pub fn keep(&mut self, matter: &MovingBox) {
        let (lattice, inelastic) = (&matter.lattice, &matter.inelastic);
        for (node, index) in lattice.layout().nodes() {
            let damage = NodeDamage {
                bonds: std::array::from_fn(|family| BondDamage {
                    broken: inelastic.broken[family][index],
                    longer: inelastic.base[family][index] - rest_length(family, lattice.spacing()),
                }),
                plastic: vector_at(&matter.plastic, index),
            };
            let place = (matter.origin + node.as_ivec3()).to_array();
            if damage == NodeDamage::default() {
                self.0.remove(&place);
            } else {
                self.0.insert(place, damage);
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
            let Some(damage) = self.0.get(&(matter.origin + node).to_array()) else {
                continue;
            };
            for (family, bond) in damage.bonds.iter().enumerate() {
                let rest = rest_length(family, spacing) + bond.longer;
                matter.inelastic.broken[family][index] = bond.broken;
                matter.inelastic.base[family][index] = rest;
                matter.lattice.bonds.rest[family][index] = rest;
            }
            if is_new(node) {
                matter.begin_at(index, damage.plastic);
            }
        }
        matter.inelastic.break_again(&mut matter.lattice);
    }
}
