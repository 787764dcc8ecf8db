//! How the lattice works, as it is chosen.

use super::inelastic::InelasticSettings;

/// Settings of the lattice model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatticeSettings {
    /// Nodes along each edge of the box, odd, 5 to 101.
    pub nodes: u32,
    /// Between nodes [mm]; none for the smallest side of a voxel.
    pub spacing: Option<f64>,
    /// Unbalanced force at rest, as a share of the tools' force.
    pub tolerance: f64,
    /// Breaking, yielding and relaxation of stress.
    pub inelastic: InelasticSettings,
    /// Whether the body behind the box gives as the whole segment does (thesis 5.29); else as an endless
    /// one.
    pub whole: bool,
    /// What the scan reads where the tool is in tissue, in its own unit.
    pub air: f64,
}

impl Default for LatticeSettings {
    fn default() -> Self {
        Self {
            nodes: 21,
            spacing: None,
            tolerance: 1e-3,
            inelastic: InelasticSettings::default(),
            whole: false,
            air: -1000.0,
        }
    }
}
