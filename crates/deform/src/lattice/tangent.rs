//! How stiff a contact is: how the force on a tool at rest changes when the tool moves a little
//! against it and the nodes follow.
//!
//! One more linear problem of the kind that brings nodes to rest. Bone below, cracks and other
//! tools are in it, as far as the box knows them. Nodes need not be at rest: only what the tool's way adds to
//! their forces is brought to zero. Iterations that are cut off have gained too little energy back, and find the
//! contact too stiff (Nocedal & Wright, Numerical Optimization, 2006, theorem 5.2), never too soft.

use super::nodes::Lattice;
use super::relax::{Relaxer, Wish};
use super::tool_contact::LatticeTool;

/// Displacement of the tool for the tangent [spacings].
const WAY: f64 = 0.05;
/// Share of the forces that may be left.
const GAIN: f64 = 0.02;

impl Relaxer {
    /// Stiffness of the contact of one tool along its force [N/mm], the nodes at rest under all;
    /// 0 without contact. `most` evaluations, fewer where `is_late`; leaves nodes and forces as they
    /// were.
    pub fn stiffness(
        &mut self,
        lattice: &mut Lattice,
        tools: &[LatticeTool],
        which: usize,
        most: u32,
        is_late: &dyn Fn() -> bool,
    ) -> f64 {
        let force = self.felt()[which].force;
        let normal = force.normalize_or_zero();
        if !(force.is_finite() && force.length() > 0.0) {
            return 0.0;
        }
        let (way, moved) = (WAY * lattice.spacing, lattice.moved.clone());
        let mut nearer = tools.to_vec();
        nearer[which].centre -= way * normal;

        self.evaluate(lattice, tools);
        let before = lattice.force.clone();
        self.evaluate(lattice, &nearer);
        self.weigh(lattice);
        let wish = Wish {
            most: most.saturating_sub(3).max(1),
            residual: 0.0,
            gain: GAIN,
            reference: 0.0,
            stay: Some(&before),
        };
        self.find_step(lattice, &nearer, &wish, is_late);
        self.problem.go(1.0, &mut lattice.moved);
        self.evaluate(lattice, &nearer);
        let grown = (self.felt()[which].force - force).dot(normal);

        lattice.moved = moved;
        self.evaluate(lattice, tools);
        let stiffness = grown / way;
        if stiffness.is_finite() {
            stiffness.max(0.0)
        } else {
            0.0
        }
    }
}
