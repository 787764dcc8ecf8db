//! Points around the proxy, 8×8×8, and ways from one to the next among several bodies.
//!
//! The nodes stand at equal steps along the axes of one body, and the proxy is one of them. A
//! node is open where it lies in a solid voxel of no body. Ways lead from node to node along
//! the axes; that nothing stands between two of them is assumed until whoever takes a way and
//! walks it finds otherwise.
//!
//! Frame: the world's grid; memory as in a brick: one word per z, bit y·8 + x.

use crate::contact::bodies::{Bodies, Visits};
use glam::{DVec3, IVec3};
use palpate_volume::occupancy::Occupancy;

/// Nodes of a lattice, each of which costs a look into a body.
pub(crate) const NODES: u32 = 8 * 8 * 8;

/// Longest way [steps]; longer ones are not found.
const MAX_STEPS: usize = 31;

/// Bit x = 0 of every row, and x = 7.
const LEFT: u64 = 0x0101_0101_0101_0101;
const RIGHT: u64 = 0x8080_8080_8080_8080;

/// A lattice and which of its nodes are open.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodeLattice {
    /// The proxy, and its place among the nodes.
    pub origin: DVec3,
    pub start: IVec3,
    /// Steps along x, y and z.
    pub steps: [DVec3; 3],
    /// Open nodes.
    pub open: [u64; 8],
    /// Steps that something stands in, by the node from which they go up along x, y, z.
    pub blocked: [[u64; 8]; 3],
}

/// Ways from the proxy to every node that can be reached: those at each number of steps.
#[derive(Clone, Debug)]
pub(crate) struct Ways {
    fronts: [[u64; 8]; MAX_STEPS + 1],
    pub reached: [u64; 8],
}

impl NodeLattice {
    pub(crate) fn point(&self, node: IVec3) -> DVec3 {
        let offset = (node - self.start).as_dvec3();
        let [x, y, z] = self.steps;
        self.origin + x * offset.x + y * offset.y + z * offset.z
    }

    /// Closes the nodes of `among` that are in solid voxels of a body; false without visits.
    pub(crate) fn close_solid<O: Occupancy>(
        &mut self,
        bodies: &Bodies<'_, O>,
        body: u8,
        among: &[u64; 8],
        visits: &mut Visits,
    ) -> bool {
        let map = bodies.body_from_world(body);
        let [x, y, z] = self.steps.map(|step| map.transform_vector3(step));
        let first = map.transform_point3(self.point(IVec3::ZERO));
        if !bodies.may_hold(body, first, first + (x + y + z) * 7.0, [x, y, z]) {
            return true;
        }
        if !visits.take(NODES) {
            return false;
        }
        for (layer, word) in self.open.iter_mut().enumerate() {
            let in_layer = first + z * layer as f64;
            let mut left = *word & among.get(layer).copied().unwrap_or(0);
            while left != 0 {
                let bit = left.trailing_zeros();
                left &= left - 1;
                let point = in_layer + x * f64::from(bit & 7) + y * f64::from(bit >> 3);
                if bodies.is_solid(body, point.floor().as_ivec3()) {
                    *word &= !(1 << bit);
                }
            }
        }
        true
    }

    /// Closes the step between two neighbours.
    pub(crate) fn block(&mut self, from: IVec3, to: IVec3) {
        let axis = (to - from).abs().max_position();
        let lower = from.min(to);
        if let Some(word) = self.blocked[axis].get_mut(lower.z as usize) {
            *word |= 1 << ((lower.y & 7) * 8 + (lower.x & 7));
        }
    }

    /// Whether nothing is known to stand between two neighbours.
    fn is_passable(&self, from: IVec3, to: IVec3) -> bool {
        let axis = (to - from).abs().max_position();
        !has(&self.blocked[axis], from.min(to))
    }

    /// The open nodes beside a front that were not reached before.
    fn next_front(&self, front: &[u64; 8], reached: &[u64; 8]) -> [u64; 8] {
        let [x, y, z] = &self.blocked;
        std::array::from_fn(|k| {
            let layer = front[k];
            // up from a node that is not blocked, or down to one
            let mut beside = (layer & !RIGHT & !x[k]) << 1 | (layer & !LEFT) >> 1 & !x[k];
            beside |= (layer & !y[k]) << 8 | layer >> 8 & !y[k];
            if k > 0 {
                beside |= front[k - 1] & !z[k - 1];
            }
            if k < 7 {
                beside |= front[k + 1] & !z[k];
            }
            beside & self.open[k] & !reached[k]
        })
    }

    /// Finds the shortest ways from the proxy through open nodes.
    pub(crate) fn ways(&self) -> Ways {
        let mut ways = Ways {
            fronts: [[0; 8]; MAX_STEPS + 1],
            reached: [0; 8],
        };
        let mut front = [0; 8];
        if let Some(word) = front.get_mut(self.start.z as usize) {
            *word = 1 << (self.start.y * 8 + self.start.x);
        }
        for place in &mut ways.fronts {
            *place = front;
            let reached = &mut ways.reached;
            for z in 0..8 {
                reached[z] |= front[z];
            }
            front = self.next_front(&front, reached);
            if front == [0; 8] {
                break;
            }
        }
        ways
    }
}

/// A way, from the node beside the proxy to the one that was asked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way {
    nodes: [IVec3; MAX_STEPS],
    count: usize,
}

impl Way {
    /// The nodes in order.
    pub(crate) fn nodes(&self) -> &[IVec3] {
        self.nodes.get(..self.count).unwrap_or(&[])
    }
}

impl Ways {
    /// The way to a node that was reached.
    pub(crate) fn to(&self, lattice: &NodeLattice, node: IVec3) -> Option<Way> {
        let steps = self.fronts.iter().position(|front| has(front, node))?;
        let mut way = Way {
            nodes: [IVec3::ZERO; MAX_STEPS],
            count: steps,
        };
        // back to the start, each time to a node that is one step nearer to it
        let mut at = node;
        for step in (0..steps).rev() {
            *way.nodes.get_mut(step)? = at;
            let front = self.fronts.get(step)?;
            at = STEPS
                .into_iter()
                .map(|step| at + step)
                .find(|&near| has(front, near) && lattice.is_passable(near, at))?;
        }
        Some(way)
    }
}

/// Steps from node to node.
const STEPS: [IVec3; 6] = [
    IVec3::X,
    IVec3::Y,
    IVec3::Z,
    IVec3::NEG_X,
    IVec3::NEG_Y,
    IVec3::NEG_Z,
];

/// Whether a node is set; those beyond the lattice are not.
pub(crate) fn has(nodes: &[u64; 8], node: IVec3) -> bool {
    let inside = node.cmpge(IVec3::ZERO).all() && node.cmplt(IVec3::splat(8)).all();
    inside && nodes[(node.z & 7) as usize] >> (node.y * 8 + node.x) & 1 == 1
}

/// Clears a node.
pub(crate) fn clear(nodes: &mut [u64; 8], node: IVec3) {
    if let Some(word) = nodes.get_mut(node.z as usize) {
        *word &= !(1 << ((node.y & 7) * 8 + (node.x & 7)));
    }
}
