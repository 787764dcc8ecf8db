//! A whole block of tissue between two plates that it sticks to: the lattice off-line, for
//! comparison with measured bodies and with other programs.
//!
//! Nodes stand on the faces of the block, so that bonds along a face belong to it by half, as
//! if tissue went on behind. Frame: the block's own [mm], corner at 0, plates at both ends of z.
//! Units: mm, N. The experiment: Kerdok et al., Med. Image Anal. 7 (2003), "Truth Cube".

use glam::{DVec3, UVec3};

use crate::lattice::{Border, Lattice, NodeMaterial, RelaxReport, RelaxSettings, Relaxer};
use crate::material::Solid;

/// A block and how far its plates move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressedBlock {
    /// Nodes along each axis, 3 to 129; the block's sides are one spacing less.
    pub nodes: UVec3,
    /// Between nodes [mm].
    pub spacing: f64,
    /// Elastic constants of the block.
    pub solid: Solid,
    /// Displacements of the plates at the lower and the upper end of z [mm].
    pub plates: [DVec3; 2],
    /// Unbalanced force at rest, as a share of the force on a plate.
    pub tolerance: f64,
    /// Iterations at most.
    pub iterations: u32,
}

/// A block at rest between its plates.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockAtRest {
    /// Displacement of each node [mm]; x fastest.
    pub moved: Vec<DVec3>,
    /// Force of the block on the lower plate [N].
    pub force: DVec3,
    /// Report of the relaxation.
    pub report: RelaxReport,
}

impl PressedBlock {
    /// Moves the plates and brings the block to rest, from a displacement linear in z.
    #[must_use]
    pub fn relax(&self) -> BlockAtRest {
        let mut lattice = self.lattice();
        let settings = RelaxSettings {
            tolerance: self.tolerance,
            iterations: self.iterations,
            reference: self.plate_force(),
        };
        let report = Relaxer::default().relax(&mut lattice, &[], &settings, &|| false);
        let layout = *lattice.layout();
        let low = layout.nodes().filter(|(node, _)| node.z == 0);
        BlockAtRest {
            moved: layout.nodes().map(|(_, i)| lattice.moved(i)).collect(),
            force: low.map(|(_, i)| lattice.force(i)).sum(),
            report,
        }
    }

    fn lattice(&self) -> Lattice {
        // tissue is told to go on behind all faces, so that their bonds count by half
        let matter = |_| NodeMaterial::Deformable(self.solid);
        let mut lattice = Lattice::new(self.nodes, self.spacing, Border::Free, matter);
        let layout = *lattice.layout();
        let last = self.nodes.z - 1;
        let [low, high] = self.plates;
        for (node, index) in layout.nodes() {
            let share = f64::from(node.z) / f64::from(last);
            lattice.set_moved(index, low.lerp(high, share));
            for axis in 0..3 {
                lattice.hold(index, axis, node.z == 0 || node.z == last);
            }
        }
        lattice
    }

    /// What a slender block would push with [N]: the scale of forces.
    fn plate_force(&self) -> f64 {
        let sides = (self.nodes - 1).as_dvec3() * self.spacing;
        let strain = self.plates[1].distance(self.plates[0]) / sides.z;
        self.solid.young * sides.x * sides.y * strain.max(f64::MIN_POSITIVE)
    }
}
