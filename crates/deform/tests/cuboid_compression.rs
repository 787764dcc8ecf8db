//! Virtual compression of a block of cuboid particles, which have no energy to be at rest in:
//! damped until they stand still.

use glam::{DVec3, IVec3};
use palpate_deform::particles::calibration::{LatticeKind, LatticeScale, cuboid_modulus};
use palpate_deform::particles::integrator::VelocityVerlet;
use palpate_deform::particles::lattices::cubes;
use palpate_deform::particles::local_model::LocalLaw;
use palpate_deform::particles::{
    CuboidLaw, PairOptions, ParticleSystem, Particles, Space, Workers,
};

/// Strain of the plates: that at which the law's modulus is taken, since it is not linear.
const STRAIN: f64 = 2e-3;

/// Young's modulus of n³ cubes between frictionless plates, sides free, for D = 1 [N/mm²].
fn block_modulus(cells: i32) -> f64 {
    let scale = LatticeScale::new(LatticeKind::Cuboid, 1.0);
    let places = cubes(IVec3::splat(cells), 1.0);
    // masses 72 D/a²: time in units of T0/2 pi
    let mass = 72.0 / scale.equilibrium.powi(2);
    let particles = Particles::at_rest(&places, 1.0, mass);
    let (law, reach) = (CuboidLaw::on(&scale), CuboidLaw::reach(&scale));
    let mut system = ParticleSystem::new(particles, law, reach, 0.3, Space::Open);
    system.options = PairOptions {
        depth: Some(1.0),
        workers: Workers::Pool,
        ..PairOptions::default()
    };
    let top = f64::from(cells) - 1.0;
    for (free, home) in system.particles.free.iter_mut().zip(&places) {
        if home.z < 1.0 || home.z > top {
            free.z = 0.0;
        }
    }
    // critical for the slowest swing of the block, and not below what keeps it together
    let friction = (2.0 * std::f64::consts::PI / f64::from(cells)).max(0.5);
    let verlet = VelocityVerlet {
        step: 0.25,
        friction,
    };
    let mut plate_force = || {
        system.evaluate();
        for _ in 0..1500 {
            verlet.advance(&mut system, ParticleSystem::evaluate);
        }
        let plate = |(force, home): (&DVec3, &DVec3)| if home.z > top { force.z } else { 0.0 };
        let force: f64 = system.particles.forces.iter().zip(&places).map(plate).sum();
        for (site, home) in system.particles.sites.iter_mut().zip(&places) {
            site.z -= STRAIN * (home.z - 0.5);
        }
        force
    };
    let rest = plate_force();
    let pressed = plate_force();
    (pressed - rest) / (f64::from(cells).powi(2) * STRAIN)
}

#[test]
fn virtual_compression_recovers_youngs_modulus() {
    let (small, large) = (block_modulus(8), block_modulus(16));
    let bulk = 2.0 * large - small;
    let asked = LatticeScale::new(LatticeKind::Cuboid, 1.0).young_of_depth(1.0);
    println!(
        "cuboid-lj: E = {small:.2} (8³ cubes), {large:.2} (16³), extrapolated {bulk:.2}, asked {asked:.2} D/h³"
    );
    assert!(
        (bulk / asked - 1.0).abs() < 0.02,
        "{small} {large} {bulk} {asked}"
    );
}

/// The law has a kink where two cubes stand edge to edge, so that its modulus in compression is
/// not that of a spring: compressed, edge neighbours are pulled as sides bulge, where springs would
/// push. So it is 80 D/a³, not the 138 of 26 springs, and it rises with the strain.
#[test]
fn the_modulus_of_the_cuboid_law_rises_by_a_tenth_at_one_percent() {
    let moduli = [1e-4, 1e-3, 2e-3, 5e-3, 1e-2].map(cuboid_modulus);
    println!("cuboid-lj: E at strains of 1e-4, 1e-3, 2e-3, 5e-3, 1e-2: {moduli:.2?} D/a³");
    assert!(
        moduli.iter().all(|e| (e / moduli[2] - 1.0).abs() < 0.15),
        "{moduli:?}"
    );
}
