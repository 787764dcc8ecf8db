//! Lennard-Jones pairs per second on an FCC crystal.
//!
//! A periodic crystal without pressure, plain cut at 2.1 a, velocity Verlet without friction,
//! double precision, lists rebuilt as particles move. Units a = D = m = 1, as `units lj` of
//! LAMMPS with σ = 2^(−1/6); its `neigh_modify delay 0 every 1 check yes` is the rule here.

use std::time::Instant;

use glam::{DVec3, IVec3};

use super::lattices::{FCC_CHI, fcc};
use super::pair_force::{PairOptions, Workers};
use super::pair_laws::CutLaw;
use super::space::Space;
use super::state::Particles;
use super::system::ParticleSystem;
use crate::particles::integrator::VelocityVerlet;

/// Cut-off [a].
pub const CUT: f64 = 2.1;
/// Pairs per particle within the cut-off of the perfect crystal, each counted once: what both
/// programs are credited with, whatever their lists hold.
pub const PAIRS_PER_PARTICLE: f64 = 27.0;

/// A crystal at the start of a run.
#[derive(Clone, Debug)]
pub struct LjCrystal {
    /// Side of the periodic box [a].
    pub side: f64,
    /// Places, shape `[n]` [a].
    pub positions: Vec<DVec3>,
    /// Velocities without a common motion, shape `[n]` [√(D/m)].
    pub velocities: Vec<DVec3>,
}

impl LjCrystal {
    /// `cells`³ cubic cells of four particles, with random velocities of a temperature [D]; half
    /// of it goes into the crystal's own energy.
    pub fn new(cells: u32, temperature: f64, seed: u64) -> Self {
        let positions = fcc(IVec3::splat(cells as i32), FCC_CHI);
        let mut random = seed;
        let mut velocities: Vec<_> = positions
            .iter()
            .map(|_| {
                let mut normal = || normal_number(&mut random);
                temperature.max(0.0).sqrt() * DVec3::new(normal(), normal(), normal())
            })
            .collect();
        let mean = velocities.iter().sum::<DVec3>() / velocities.len().max(1) as f64;
        velocities.iter_mut().for_each(|velocity| *velocity -= mean);
        Self {
            side: f64::from(cells) * FCC_CHI * std::f64::consts::SQRT_2,
            positions,
            velocities,
        }
    }
}

/// A number close to normal: the sum of twelve even ones (splitmix64), less six.
pub(super) fn normal_number(state: &mut u64) -> f64 {
    let mut even = || {
        *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = *state;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..12).map(|_| even()).sum::<f64>() - 6.0
}

/// Settings of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LjRun {
    /// Steps before the clock starts.
    pub warm_up: u32,
    /// Steps that are timed.
    pub steps: u32,
    /// Δt [a √(m/D)].
    pub step: f64,
    /// Margin of the lists [a].
    pub margin: f64,
    /// Threads.
    pub workers: Workers,
}

impl Default for LjRun {
    fn default() -> Self {
        Self {
            warm_up: 100,
            steps: 500,
            step: 0.005,
            margin: 0.4,
            workers: Workers::One,
        }
    }
}

/// What a run gave. Energies are per particle [D].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LjFigures {
    /// Particles.
    pub particles: usize,
    /// Time of the timed steps [s].
    pub seconds: f64,
    /// Particle-steps per second.
    pub particle_steps_per_second: f64,
    /// Pairs per second, [`PAIRS_PER_PARTICLE`] for each particle-step.
    pub pairs_per_second: f64,
    /// Number of times that lists were built within the timed steps.
    pub builds: u64,
    /// Potential energy at the start.
    pub potential_at_start: f64,
    /// Potential energy after the warm-up.
    pub potential_after_warm_up: f64,
    /// Kinetic and potential energy at the end.
    pub total_at_end: f64,
}

/// Runs a crystal and times it.
///
/// # Panics
/// Where the crystal has not one velocity per particle.
pub fn bench_lj_pairs(crystal: &LjCrystal, run: &LjRun) -> LjFigures {
    assert_eq!(
        crystal.positions.len(),
        crystal.velocities.len(),
        "one velocity per particle"
    );
    let mut particles = Particles::at_rest(&crystal.positions, 1.0, 1.0);
    particles.velocities.clone_from(&crystal.velocities);
    let count = particles.len() as f64;
    let space = Space::Periodic(DVec3::splat(crystal.side));
    let mut system = ParticleSystem::new(particles, CutLaw::new(1.0, CUT), CUT, run.margin, space);
    system.options = PairOptions {
        depth: Some(1.0),
        workers: run.workers,
        ..PairOptions::default()
    };
    let verlet = VelocityVerlet {
        step: run.step,
        friction: 0.0,
    };

    let potential_at_start = potential(&mut system) / count;
    for _ in 0..run.warm_up {
        verlet.advance(&mut system, ParticleSystem::evaluate);
    }
    let potential_after_warm_up = potential(&mut system) / count;
    let builds = system.list().builds();
    let start = Instant::now();
    for _ in 0..run.steps {
        verlet.advance(&mut system, ParticleSystem::evaluate);
    }
    let seconds = start.elapsed().as_secs_f64();
    let builds = system.list().builds() - builds;
    let total = potential(&mut system) + system.particles.kinetic_energy();
    let rate = count * f64::from(run.steps) / seconds.max(1e-9);
    LjFigures {
        particles: crystal.positions.len(),
        seconds,
        particle_steps_per_second: rate,
        pairs_per_second: PAIRS_PER_PARTICLE * rate,
        builds,
        potential_at_start,
        potential_after_warm_up,
        total_at_end: total / count,
    }
}

/// Potential energy at the present places.
fn potential(system: &mut ParticleSystem<CutLaw>) -> f64 {
    system.options.sums = true;
    let energy = system.evaluate().energy;
    system.options.sums = false;
    energy
}
