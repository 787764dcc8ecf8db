//! What bonds remember while the box is elsewhere: that they broke, and how far they yielded.
//!
//! A bond is known by the place of its lower node in the scan, which is the same wherever the
//! box is. Creep is not kept: it fades while nobody looks.

use std::collections::BTreeMap;

use glam::IVec3;

use super::bond_forces::rest_length;
use super::inelastic::Inelastic;
use super::layout::FAMILY_COUNT;
use super::nodes::Lattice;

/// What does not come back in one bond.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Scar {
    broken: bool,
    /// How much longer it is at rest than at first [mm].
    longer: f64,
}

/// All bonds that are not as at first, by their lower node, counted from the corner of the grid.
#[derive(Clone, Debug, Default)]
pub(super) struct BondMemory(BTreeMap<[i32; 3], [Scar; FAMILY_COUNT]>);

impl BondMemory {
    /// Keeps what happened in a box that begins at the node `origin`.
    pub fn keep(&mut self, lattice: &Lattice, inelastic: &Inelastic, origin: IVec3) {
        for (node, index) in lattice.layout.nodes() {
            let scars = std::array::from_fn(|family| Scar {
                broken: inelastic.broken[family][index],
                longer: inelastic.base[family][index] - rest_length(family, lattice.spacing),
            });
            if scars != [Scar::default(); FAMILY_COUNT] {
                let place = origin + node.as_ivec3();
                self.0.insert(place.to_array(), scars);
            }
        }
    }

    /// Puts what is known of the bonds of a box into it.
    pub fn recall(&self, lattice: &mut Lattice, inelastic: &mut Inelastic, origin: IVec3) {
        if self.0.is_empty() {
            return;
        }
        for (node, index) in lattice.layout.nodes() {
            let place = origin + node.as_ivec3();
            let Some(scars) = self.0.get(&place.to_array()) else {
                continue;
            };
            for (family, scar) in scars.iter().enumerate() {
                inelastic.broken[family][index] = scar.broken;
                let rest = rest_length(family, lattice.spacing) + scar.longer;
                inelastic.base[family][index] = rest;
                lattice.bonds.rest[family][index] = rest;
            }
        }
        inelastic.break_again(lattice);
    }
}
