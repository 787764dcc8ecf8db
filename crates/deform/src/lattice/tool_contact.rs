//! A rigid tool among the nodes: a ball or an ellipsoid that pushes them away.
//!
//! A node is felt as if tissue reached half a spacing beyond it, so that a voxel's face, not its
//! middle, is where touch begins. For the ellipsoid, distance is that of the ellipsoid with
//! half axes larger by half a spacing, scaled by the smallest of them: exact for a ball, and a
//! function of place alone for all, so that the force is conservative. There is no friction:
//! friction with the hand belongs to the touch.
//! Source: thesis 5.16 (isotropic, or an ellipsoid).

use glam::{DMat3, DVec3};

use super::contact_law::contact_push;
use super::nodes::Lattice;

/// Stiffness of a tool's contact with a node over that of the node's bonds.
const CONTACT_STIFFNESS: f64 = 4.0;
/// How deep in the tool a node's push begins to be linear, ten times over [spacings]: short, so that
/// the tool hardly gets into tissue.
const RANGE: f64 = 0.25;
/// Margin by which nodes may come nearer before they are searched again [spacings].
const MARGIN: f64 = 2.0;

/// A rigid ellipsoid in the lattice's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatticeTool {
    /// Centre of the tool [mm].
    pub centre: DVec3,
    /// Half axes [mm], along its own axes.
    pub half_axes: DVec3,
    /// Takes its own axes to the lattice's.
    pub orientation: DMat3,
}

impl LatticeTool {
    /// A ball [mm].
    #[must_use]
    pub fn ball(centre: DVec3, radius: f64) -> Self {
        Self {
            centre,
            half_axes: DVec3::splat(radius),
            orientation: DMat3::IDENTITY,
        }
    }
}

/// What a tool feels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolForce {
    /// Force on it [N].
    pub force: DVec3,
    /// Nodes that it touches.
    pub nodes: u32,
    /// The middle of what it touches, weighted by force [mm]; zero without contact.
    pub place: DVec3,
}

/// A node that a tool pushes now.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactNode {
    pub node: usize,
    /// Out of the tool.
    pub normal: DVec3,
    /// Decrease of the push along the normal [N/mm].
    pub stiffness: f64,
}

/// The nodes that a tool may reach.
#[derive(Clone, Debug, Default)]
pub(super) struct ToolReach {
    nodes: Vec<u32>,
}

impl ToolReach {
    /// Looks for them as they stand now.
    pub fn find(&mut self, lattice: &Lattice, tool: &LatticeTool) {
        let reach = tool.half_axes.max_element() + (0.5 + MARGIN) * lattice.spacing;
        self.nodes.clear();
        let near = |index: usize| lattice.place(index).distance(tool.centre) < reach;
        self.nodes.extend(
            lattice
                .matter_nodes()
                .filter(|&n| near(n))
                .map(|n| n as u32),
        );
    }

    /// Adds the tool's push to the force on each node, and tells what the tool feels.
    pub fn push(
        &self,
        lattice: &mut Lattice,
        tool: &LatticeTool,
        touched: &mut Vec<ContactNode>,
    ) -> ToolForce {
        let body = Body::new(tool, lattice.spacing);
        let mut felt = ToolForce::default();
        let mut weight = 0.0;
        for &node in &self.nodes {
            let node = node as usize;
            let Some((push, stiffness)) = body.push_on(lattice, node) else {
                continue;
            };
            touched.push(ContactNode {
                node,
                normal: push.normalize_or_zero(),
                stiffness,
            });
            for axis in 0..3 {
                lattice.force[axis][node] += push[axis];
            }
            let size = push.length();
            felt.force -= push;
            felt.nodes += 1;
            felt.place += size * lattice.place(node);
            weight += size;
        }
        if weight > 0.0 {
            felt.place /= weight;
        }
        felt
    }
}

/// A tool made larger by half a spacing, ready to be asked for its push.
struct Body {
    centre: DVec3,
    own_from_lattice: DMat3,
    lattice_from_own: DMat3,
    inverse_axes: DVec3,
    scale: f64,
}

impl Body {
    fn new(tool: &LatticeTool, spacing: f64) -> Self {
        let half_axes = tool.half_axes + 0.5 * spacing;
        Self {
            centre: tool.centre,
            own_from_lattice: tool.orientation.transpose(),
            lattice_from_own: tool.orientation,
            inverse_axes: half_axes.recip(),
            scale: half_axes.min_element(),
        }
    }

    /// Push on a node [N] and its stiffness [N/mm]; none out of reach, and none at the very centre, where it has no
    /// direction.
    fn push_on(&self, lattice: &Lattice, node: usize) -> Option<(DVec3, f64)> {
        let from_centre = self.own_from_lattice * (lattice.place(node) - self.centre);
        let scaled = from_centre * self.inverse_axes;
        let level = scaled.length();
        if !(level < 1.0 && level > 1e-9) {
            return None;
        }
        let range = RANGE * lattice.spacing;
        let distance = range + (level - 1.0) * self.scale;
        let stiffness = CONTACT_STIFFNESS * lattice.node_stiffness[node];
        let push = contact_push(distance, range, stiffness);
        let direction = self.scale / level * (scaled * self.inverse_axes);
        Some((
            self.lattice_from_own * (push.force * direction),
            push.stiffness * direction.length_squared(),
        ))
    }
}
