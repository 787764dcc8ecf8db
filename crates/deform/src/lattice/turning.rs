//! The body behind the border resists that all of the box turns at once.
//!
//! The springs of the border stand for the field of a force, whose stress is radial alone where Poisson's
//! ratio comes near ½: a turn about the load, which moves nothing along the radius, would cost nothing
//! then, and tissue under a tool would roll out from below it. The field of a couple is another one: a
//! sphere that turns in an endless body is held by a stress of 3 μ / r for each displacement, along its
//! face (rotlet: Chwang & Wu, J. Fluid Mech. 63, 1974, by the analogy of Stokes flow and incompressible
//! tissue). It is put on the turn of the border as a whole, and on nothing else that the border does.

use glam::{DMat3, DVec3};

use super::border::{Ground, outer};
use super::vectors::{Field, vector_at};

/// Stress along the face over displacement, in parts of μ / r.
const COUPLE: f64 = 3.0;

/// Share of the stiffness against turns that is put on each axis, so that all of them have some.
const SLIGHT: f64 = 1e-9;

/// A border node, and what holds it back from turning.
#[derive(Clone, Copy, Debug)]
pub(super) struct TurningNode {
    /// Number of its spring among those of the border.
    pub ground: u32,
    /// From the load to where it rests [mm].
    pub arm: DVec3,
    /// Along the face [N/mm].
    pub stiffness: f64,
}

/// What holds the border back from turning as one; nothing by default.
#[derive(Clone, Debug, Default)]
pub(super) struct Turning {
    nodes: Vec<TurningNode>,
    /// Turn by moment [1/(N·mm)].
    by_moment: DMat3,
}

impl Turning {
    /// For the nodes of a border.
    pub fn new(nodes: Vec<TurningNode>) -> Self {
        let of = |node: &TurningNode| {
            let across = DMat3::IDENTITY * node.arm.length_squared() - outer(node.arm, node.arm);
            across * node.stiffness
        };
        let by_turn: DMat3 = nodes.iter().map(of).sum();
        // nodes in a line with the load turn about it without a moment
        let least = SLIGHT * (by_turn.x_axis.x + by_turn.y_axis.y + by_turn.z_axis.z);
        let by_moment = (by_turn + DMat3::IDENTITY * least).inverse();
        // none where nothing holds the border
        match by_moment.is_finite() {
            true => Self { nodes, by_moment },
            false => Self::default(),
        }
    }

    /// The turn of the border [rad], where nodes have moved so far from where the body behind has them.
    fn turn(&self, moved: impl Fn(u32) -> DVec3) -> DVec3 {
        let moment = |node: &TurningNode| node.arm.cross(moved(node.ground)) * node.stiffness;
        self.by_moment * self.nodes.iter().map(moment).sum::<DVec3>()
    }

    /// Adds the forces by which the border is held back [N].
    pub fn add_forces(&self, ground: &[Ground], behind: DVec3, moved: &Field, force: &mut Field) {
        let away = |ground: &Ground| vector_at(moved, ground.node as usize) - ground.led - behind;
        let turn = self.turn(|number| away(&ground[number as usize]));
        for node in &self.nodes {
            let pull = turn.cross(node.arm) * node.stiffness;
            let index = ground[node.ground as usize].node as usize;
            for axis in 0..3 {
                force[axis][index] -= pull[axis];
            }
        }
    }

    /// Energy of the turn [N·mm], the body behind not moved.
    pub fn energy(&self, ground: &[Ground], moved: &Field) -> f64 {
        let away = |ground: &Ground| vector_at(moved, ground.node as usize) - ground.led;
        let turn = self.turn(|number| away(&ground[number as usize]));
        let held = |node: &TurningNode| turn.cross(node.arm).length_squared() * node.stiffness;
        0.5 * self.nodes.iter().map(held).sum::<f64>()
    }
}

/// Stiffness for its area with which a border node is held back from turning [N/mm³], beside its own
/// spring: `distance` [mm] from the load.
pub(super) fn turning_stiffness(shear: f64, poisson: f64, distance: f64) -> f64 {
    let by_spring = 2.0 * (1.0 - 2.0 * poisson) / (3.0 - 4.0 * poisson);
    (COUPLE - by_spring) * shear / distance
}
