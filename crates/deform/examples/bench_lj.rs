//! temp
#![expect(clippy::print_stdout, reason = "a table is what this example is for")]
use glam::{DVec3, IVec3};
use palpate_deform::integrator::VelocityVerlet;
use palpate_deform::particles::lattices::fcc;
use palpate_deform::particles::*;
fn main() {
    let n: i32 = std::env::args().nth(1).map_or(10, |s| s.parse().unwrap());
    let steps: u32 = std::env::args().nth(2).map_or(500, |s| s.parse().unwrap());
    let t: f64 = std::env::args().nth(3).map_or(1.0, |s| s.parse().unwrap());
    let margin: f64 = std::env::args().nth(4).map_or(0.3, |s| s.parse().unwrap());
    let spacing = 0.97841;
    let mut p = Particles::at_rest(&fcc(IVec3::splat(n), spacing), 1.0, 1.0);
    let mut random = oorandom::Rand64::new(5);
    let mut g = || (0..12).map(|_| random.rand_float()).sum::<f64>() - 6.0;
    for v in &mut p.velocities {
        *v = t.sqrt() * DVec3::new(g(), g(), g());
    }
    let mean = p.momentum() / p.len() as f64;
    for v in &mut p.velocities {
        *v -= mean;
    }
    let side = f64::from(n) * spacing * 2f64.sqrt();
    let mut list = NeighbourList::new(2.1, margin, Space::Periodic(DVec3::splat(side)));
    let law = CutLaw::new(1.0, 2.1);
    list.update(&p.sites);
    let mut forces = std::mem::take(&mut p.forces);
    let s = pair_forces(
        &law,
        &p.sites,
        &list,
        Some(1.0),
        &mut forces,
        true,
        Workers::One,
    );
    p.forces = forces;
    println!(
        "pe0 {} pairs {} members {}",
        s.energy / p.len() as f64,
        s.pairs,
        list.member_count()
    );
    let verlet = VelocityVerlet {
        step: 0.005,
        friction: 0.0,
    };
    let mut run = |steps: u32, p: &mut Particles, list: &mut NeighbourList| {
        let t0 = std::time::Instant::now();
        let mut e = 0.0;
        for i in 0..steps {
            e = verlet.advance(p, |p| {
                list.update(&p.sites);
                pair_forces(
                    &law,
                    &p.sites,
                    list,
                    Some(1.0),
                    &mut p.forces,
                    i + 1 == steps,
                    Workers::One,
                )
                .energy
            });
        }
        (t0.elapsed().as_secs_f64(), e)
    };
    run(100, &mut p, &mut list);
    let b0 = list.builds();
    let (dt, e) = run(steps, &mut p, &mut list);
    println!(
        "{} particles {:.2} M steps/s {:.1} M pairs/s builds {} etot {}",
        p.len(),
        p.len() as f64 * f64::from(steps) / dt / 1e6,
        27.0 * p.len() as f64 * f64::from(steps) / dt / 1e6,
        list.builds() - b0,
        (e + p.kinetic_energy()) / p.len() as f64
    );
}
