//! Lennard-Jones pairs per second, and the crystal for another program to run.
//!
//! `cargo run --release -p palpate-deform --example lj_pairs -- 10 500 1.0 [FILE]`: cells along
//! an axis, steps, temperature [D]; with a file, places and velocities are written to it, one
//! particle a line, the side of the box first.
#![expect(clippy::print_stdout, reason = "a table is what this example is for")]
#![expect(
    clippy::unwrap_used,
    reason = "an example stops where it is told nonsense"
)]

use std::fmt::Write as _;

use palpate_deform::particles::Workers;
use palpate_deform::particles::bench::{LjCrystal, LjRun, bench_lj_pairs};

fn main() {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let number = |place: usize, other: f64| given.get(place).map_or(other, |g| g.parse().unwrap());
    let crystal = LjCrystal::new(number(0, 10.0) as u32, number(2, 1.0), 1);
    if let Some(file) = given.get(3) {
        let mut text = format!("{:?}\n", crystal.side);
        for (p, v) in crystal.positions.iter().zip(&crystal.velocities) {
            writeln!(
                text,
                "{:?} {:?} {:?} {:?} {:?} {:?}",
                p.x, p.y, p.z, v.x, v.y, v.z
            )
            .unwrap();
        }
        std::fs::write(file, text).unwrap();
    }
    for workers in [Workers::One, Workers::Pool] {
        let run = LjRun {
            steps: number(1, 500.0) as u32,
            workers,
            ..LjRun::default()
        };
        let figures = bench_lj_pairs(&crystal, &run);
        println!(
            "{workers:?}: {} particles, {:.2} M particle-steps/s, {:.1} M pairs/s, {} lists built; \
             energy {:.12} at the start, {:.12} after {} steps, {:.12} in all at the end",
            figures.particles,
            figures.particle_steps_per_second * 1e-6,
            figures.pairs_per_second * 1e-6,
            figures.builds,
            figures.potential_at_start,
            figures.potential_after_warm_up,
            run.warm_up,
            figures.total_at_end,
        );
    }
}
