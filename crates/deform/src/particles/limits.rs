//! What the thesis' particles cannot do, in figures.
//!
//! Lennard-Jones on an FCC lattice is not equally stiff in all directions, and has the Poisson's
//! ratio of its lattice; the thesis' cuboid force has no energy, so that its tissue heats up by
//! itself. Units a = D = m = 1. Source: thesis errata, sections 2 and 6.

use glam::{DVec3, IVec3};

use super::bench::normal_number;
use super::calibration::fcc_moduli;
use super::lattices::cubes;
use super::pair_laws::CuboidLaw;
use super::space::Space;
use super::state::Particles;
use super::system::ParticleSystem;
use crate::particles::integrator::VelocityVerlet;

/// Kinetic energy of each cuboid particle at the start [D].
pub const HEAT_AT_START: f64 = 6e-4;
/// ω₀ of a link: √72.
const LINK_FREQUENCY: f64 = 8.485_281_374_238_57;
/// Steps in T₀.
const STEPS: u32 = 100;

/// Anisotropy of `fcc-lj`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FccLimits {
    /// E along [110] and along [111] over that along [100].
    pub young_over_axis: [f64; 2],
    /// Poisson's ratio of a pull along an axis, whatever is asked.
    pub poisson: f64,
}

/// The lattice that the models stand on, under their law.
pub fn fcc_limits() -> FccLimits {
    let moduli = fcc_moduli();
    let axis = moduli.young(DVec3::X);
    let diagonals = [DVec3::new(1.0, 1.0, 0.0), DVec3::ONE];
    FccLimits {
        young_over_axis: diagonals.map(|direction| moduli.young(direction) / axis),
        poisson: moduli.poisson_along_axis(),
    }
}

/// Kinetic energy of a particle [D] of a block of 5³ cuboid particles that was left alone for so
/// many T₀; `friction` is a share of the critical one of a link.
pub fn cuboid_heat(periods: u32, friction: f64) -> f64 {
    let mut particles = Particles::at_rest(&cubes(IVec3::splat(5), 1.0), 1.0, 1.0);
    let speed = (2.0 / 3.0 * HEAT_AT_START).sqrt();
    let mut seed = 4;
    for velocity in &mut particles.velocities {
        let mut normal = || normal_number(&mut seed);
        *velocity = speed * DVec3::new(normal(), normal(), normal());
    }
    let law = CuboidLaw::new(1.0, 2.1, 0.5);
    let mut system = ParticleSystem::new(particles, law, 2.1 * 3.0_f64.sqrt(), 0.3, Space::Open);
    system.options.depth = Some(1.0);
    let verlet = VelocityVerlet {
        step: std::f64::consts::TAU / LINK_FREQUENCY / f64::from(STEPS),
        // B0/m = 2 ω0
        friction: 2.0 * LINK_FREQUENCY * friction,
    };
    system.evaluate();
    for _ in 0..STEPS * periods {
        verlet.advance(&mut system, ParticleSystem::evaluate);
    }
    system.particles.kinetic_energy() / system.particles.len() as f64
}
