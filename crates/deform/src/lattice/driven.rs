//! Nodes that are led: a stiff spring each, that ends where the node is to stand. All others lie in a
//! soft bed that rests.

use glam::DVec3;

use super::nodes::Lattice;
use super::tool_contact::ContactNode;

/// A node that is led.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DrivenNode {
    pub node: usize,
    /// Of the spring, the same along all axes [N/mm].
    pub stiffness: f64,
    /// Displacement from rest to which it is led [mm].
    pub led: DVec3,
}

/// All that is led, and the bed of the rest.
#[derive(Clone, Debug, Default)]
pub(super) struct Driven {
    pub nodes: Vec<DrivenNode>,
    /// Stiffness of the bed over that of a node's bonds.
    pub bed: f64,
}

impl Driven {
    /// Adds the pull of all springs to the forces on their nodes, and tells what eases a relaxation of them.
    pub fn pull(&self, lattice: &mut Lattice, touched: &mut Vec<ContactNode>) {
        if self.bed > 0.0 {
            self.rest(lattice);
        }
        for driven in &self.nodes {
            let pull = (driven.led - lattice.moved(driven.node)) * driven.stiffness;
            for axis in 0..3 {
                lattice.force[axis][driven.node] += pull[axis];
            }
            // a third of it along each axis, each that much longer: together the whole of it, for the
            // node's mass as for the modes of the box
            touched.extend(DVec3::AXES.map(|axis| ContactNode {
                node: driven.node,
                normal: axis * 3.0_f64.sqrt(),
                stiffness: driven.stiffness / 3.0,
            }));
        }
    }

    fn rest(&self, lattice: &mut Lattice) {
        for (force, moved) in lattice.force.iter_mut().zip(&lattice.moved) {
            let nodes = force.iter_mut().zip(moved).zip(&lattice.node_stiffness);
            nodes.for_each(|((force, moved), stiffness)| *force -= self.bed * stiffness * moved);
        }
    }
}
