//! From a solid's constants to the depth D and mass m of particles.
//!
//! Two ways. The thesis': the stiffness of a link from the speed of longitudinal waves, C = m
//! (v_l/λa)² and D = C a²/72 (5.41–5.52), in which the density cancels. Ours: D from Young's
//! modulus by the lattice sum of the very law that is used. The first sets the P-wave modulus
//! and makes soft tissue (ν .48) some five times too stiff; Poisson's ratio follows from the
//! lattice either way.
//!
//! Units: mm, N, N/mm², masses in N·s²/mm (1 kg = 1e-3 N·s²/mm).

use std::f64::consts::FRAC_1_SQRT_2;

use glam::DVec3;

use super::elasticity::{
    CubicModuli, compression_moduli, cubic_offsets, fcc_offsets, spacing_without_pressure,
};
use super::pair_laws::{CuboidLaw, FadedLaw};
use crate::material::Solid;
use crate::potential::{CuboidLennardJones, LennardJones, Limited, PairLaw, Switched};

/// N·s²/mm in a kg.
const PER_KILOGRAM: f64 = 1e-3;
/// Where the pull of the models fades out [a]: between the fourth shell, at 1.957 a, and the
/// fifth, at 2.188 a. Over 1.9 a to 2.1 a it would fade on the fourth shell and change E.
pub const FADE: [f64; 2] = [2.0, 2.15];
/// Greatest force of a pair [D/a], thesis 5.88; reached at 0.77 a.
pub const FORCE_LIMIT: f64 = 300.0;
/// Chebyshev cut-off of the cuboid law [side].
pub const CUBOID_CUT: f64 = 2.1;
/// Strain at which the cuboid law's modulus is taken: its answer is not linear.
const CUBOID_STRAIN: f64 = 2e-3;

/// Poisson's ratios that are nearer to one another are as good as equal.
const SAME_POISSON: f64 = 0.005;

/// Rule by which D follows from a solid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Calibration {
    /// So that compression along an axis of the lattice gives Young's modulus.
    #[default]
    Young,
    /// The thesis' rule: longitudinal waves have the speed of the solid.
    WaveSpeed,
}

/// Which lattice particles stand on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LatticeKind {
    /// Face-centred cubic, four particles a cell.
    Fcc,
    /// Cubes, one particle a cell.
    Cuboid,
}

/// Lengths and moduli of particles on a lattice, for D = 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatticeScale {
    kind: LatticeKind,
    /// Side h of a cell [mm].
    pub cell: f64,
    /// Equilibrium distance a of a pair [mm].
    pub equilibrium: f64,
    /// E·a³/D along an axis.
    young: f64,
    /// Poisson's ratio along an axis, whatever is asked.
    poisson: f64,
}

impl LatticeScale {
    /// A lattice of cells of this side [mm], without pressure at rest.
    pub fn new(kind: LatticeKind, cell: f64) -> Self {
        let (chi, young, poisson) = match kind {
            LatticeKind::Fcc => fcc_constants(),
            LatticeKind::Cuboid => cuboid_at(CUBOID_STRAIN),
        };
        let mut scale = Self {
            kind,
            cell,
            equilibrium: 0.0,
            young,
            poisson,
        };
        scale.equilibrium = scale.nearest() / chi;
        scale
    }

    /// Between nearest neighbours at rest [mm].
    pub fn nearest(&self) -> f64 {
        match self.kind {
            LatticeKind::Fcc => self.cell * FRAC_1_SQRT_2,
            LatticeKind::Cuboid => self.cell,
        }
    }

    /// Volume of one particle at rest [mm³].
    pub fn volume(&self) -> f64 {
        match self.kind {
            LatticeKind::Fcc => self.cell.powi(3) / 4.0,
            LatticeKind::Cuboid => self.cell.powi(3),
        }
    }

    /// Mass of a particle [N·s²/mm].
    pub fn mass(&self, solid: &Solid) -> f64 {
        solid.density * PER_KILOGRAM * self.volume()
    }

    /// D of a particle's tissue [N·mm].
    pub fn depth(&self, solid: &Solid, calibration: Calibration) -> f64 {
        match calibration {
            Calibration::Young => solid.young * self.equilibrium.powi(3) / self.young,
            // 5.41, 5.45, 5.52 with m = ρ V₀: the density cancels
            Calibration::WaveSpeed => {
                let speed_ratio_squared = match self.kind {
                    LatticeKind::Fcc => 6.0 / 5.0,
                    LatticeKind::Cuboid => 13.0 / 5.0,
                };
                let modulus = solid.lame() + 2.0 * solid.shear();
                modulus * self.volume() / (72.0 * speed_ratio_squared)
            }
        }
    }

    /// Poisson's ratio that tissue has, where it is not the one that is asked for.
    pub fn other_poisson(&self, asked: f64) -> Option<f64> {
        ((asked - self.poisson).abs() > SAME_POISSON).then_some(self.poisson)
    }

    /// Young's modulus along an axis that a depth makes [N/mm²].
    pub fn young_of_depth(&self, depth: f64) -> f64 {
        self.young * depth / self.equilibrium.powi(3)
    }

    /// The mean over all directions (Voigt), by which a small tool is pushed back [N/mm²].
    pub fn mean_young_of_depth(&self, depth: f64) -> f64 {
        let over_axis = match self.kind {
            LatticeKind::Fcc => 142.8 / 81.15,
            LatticeKind::Cuboid => 2.167 / 1.918,
        };
        over_axis * self.young_of_depth(depth)
    }

    /// T₀ = 2π √(m/C): period of one particle on one link [s].
    pub fn period(&self, depth: f64, mass: f64) -> f64 {
        std::f64::consts::TAU * (mass * self.equilibrium.powi(2) / (72.0 * depth)).sqrt()
    }

    /// The law of the models' FCC particles.
    pub fn faded_law(&self) -> FadedLaw {
        let [from, to] = FADE.map(|share| share * self.equilibrium);
        FadedLaw::new(self.equilibrium, from, to, FORCE_LIMIT)
            .expect("the range lies beyond b and the limit above f* for every a")
    }

    /// The law of the models' cuboid particles.
    pub fn cuboid_law(&self) -> CuboidLaw {
        let a = self.equilibrium;
        CuboidLaw::new(a, CUBOID_CUT * a, 0.77 * a)
    }
}

/// The law of the FCC models as a potential, a = 1 and D = 1.
pub fn unit_law() -> Switched<Limited<LennardJones>> {
    let law = LennardJones::new(1.0, 1.0).expect("one is positive");
    let limited = Limited::new(law, FORCE_LIMIT).expect("the limit is above f*");
    Switched::new(limited, FADE[0], FADE[1]).expect("the range lies beyond b")
}

/// χ, E and Poisson's ratio along an axis of the FCC models.
fn fcc_constants() -> (f64, f64, f64) {
    let (chi, moduli) = fcc_at_rest();
    (chi, moduli.young(DVec3::X), moduli.poisson_along_axis())
}

/// Moduli of the FCC model without pressure [D/a³].
pub fn fcc_moduli() -> CubicModuli {
    fcc_at_rest().1
}

/// χ and moduli of the FCC model.
fn fcc_at_rest() -> (f64, CubicModuli) {
    let law = unit_law();
    let force = |d: DVec3| law.force(d.length()) * d.normalize();
    let offsets = fcc_offsets(FADE[1] / 0.9);
    let chi = spacing_without_pressure(&offsets, FRAC_1_SQRT_2, force);
    let relaxed: Vec<_> = offsets.iter().map(|&d| chi * d).collect();
    let moduli = CubicModuli::of(&relaxed, FRAC_1_SQRT_2 * chi.powi(3), &law);
    (chi, moduli)
}

/// E of the cuboid model compressed along an axis by a strain [D/a³]: its answer is not linear.
pub fn cuboid_modulus(strain: f64) -> f64 {
    cuboid_at(strain).1
}

/// χ, E and Poisson's ratio along an axis of the cuboid model, compressed.
fn cuboid_at(strain: f64) -> (f64, f64, f64) {
    let law = CuboidLennardJones::new(1.0, 1.0).expect("one is positive");
    let force = |d: DVec3| {
        if d.abs().max_element() < CUBOID_CUT {
            law.radial_force(d)
        } else {
            DVec3::ZERO
        }
    };
    let offsets = cubic_offsets(2.5);
    let chi = spacing_without_pressure(&offsets, 1.0, force);
    let relaxed: Vec<_> = offsets.iter().map(|&d| chi * d).collect();
    let (young, poisson) = compression_moduli(&relaxed, chi.powi(3), strain, force);
    (chi, young, poisson)
}
