//! How fast and how near the lattice comes to rest while a ball moves 0.25 node a frame, and what
//! a node costs in boxes of 11³ to 41³ nodes; with `border`, the force against an 81³ box.
//!
//! Goals: ≥ 30 frames a second on one core with the force within 1 % of that at a residual of
//! 1e-6, at 21³ nodes, also soft tissue over bone; cost per node flat; force of a 21³ box within
//! 5 % of that of an 81³ box. Run: `cargo run --release -p palpate-deform --example lattice_speed`.
#![allow(clippy::print_stdout, reason = "it prints a table")]

use std::time::Instant;

use glam::{DVec3, UVec3};
use palpate_deform::lattice::{Border, Lattice, LatticeTool, NodeMatter, RelaxSettings, Relaxer};
use palpate_deform::material::{Solid, SolidSi};

/// Iterations of one frame.
const ITERATIONS: u32 = 60;

fn solid(poisson: f64) -> Solid {
    let si = SolidSi {
        young: 1e4,
        poisson,
        density: 1000.0,
        breaking_strain: f64::INFINITY,
        friction: 0.0,
    };
    si.checked().expect("a solid")
}

/// Time that this thread was on a core [ms], so that other programs count less; the wall clock
/// where the system does not tell.
fn busy_ms(start: Instant) -> f64 {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|told| told.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.map_or(start.elapsed().as_secs_f64() * 1e3, |ns| ns * 1e-6)
}

/// Half a box of matter, `depth` layers of it over matter `ratio` times stiffer.
fn half_space(count: u32, soft: Solid, depth: i32, ratio: f64) -> Lattice {
    let half = count as i32 / 2;
    let load = DVec3::splat(f64::from(half));
    let stiff = Solid {
        young: ratio * soft.young,
        ..soft
    };
    Lattice::new(UVec3::splat(count), 1.0, Border::Endless { load }, |node| {
        if node.z > half {
            NodeMatter::Empty
        } else if node.z > half - depth {
            NodeMatter::Deformable(soft)
        } else {
            NodeMatter::Deformable(stiff)
        }
    })
}

/// A ball of radius 2 that reaches `depth` into the half space.
fn ball(count: u32, depth: f64, aside: f64) -> LatticeTool {
    let middle = DVec3::splat(f64::from(count / 2));
    LatticeTool::ball(middle + DVec3::new(aside, 0.0, 2.5 - depth), 2.0)
}

fn relax(
    relaxer: &mut Relaxer,
    lattice: &mut Lattice,
    tool: LatticeTool,
    iterations: u32,
) -> DVec3 {
    let settings = RelaxSettings {
        tolerance: 1e-6,
        iterations,
        reference: 0.0,
    };
    relaxer.relax(lattice, &[tool], &settings, &|| false);
    relaxer.felt()[0].force
}

fn frames(name: &str, poisson: f64, depth: i32, ratio: f64, iterations: u32) {
    let mut lattice = half_space(21, solid(poisson), depth, ratio);
    let mut exact = lattice.clone();
    let (mut relaxer, mut exact_relaxer) = (Relaxer::default(), Relaxer::default());
    let (mut times, mut worst): (Vec<f64>, f64) = (Vec::new(), 0.0);
    let start = Instant::now();
    for frame in 1..=16 {
        let pressed = 0.25 * f64::from(frame.min(4));
        let aside = 0.25 * f64::from((frame - 4).max(0));
        let tool = ball(21, pressed, aside);
        let begin = busy_ms(start);
        let force = relax(&mut relaxer, &mut lattice, tool, iterations);
        times.push(busy_ms(start) - begin);
        let rest = relax(&mut exact_relaxer, &mut exact, tool, 6000);
        worst = worst.max((force - rest).length() / rest.length());
    }
    times.sort_by(f64::total_cmp);
    println!(
        "{name:28} nu {poisson}  fastest {:6.2}, median {:6.2} ms ({:5.1} Hz)  worst error {:.2} %",
        times[0],
        times[8],
        1e3 / times[8],
        100.0 * worst
    );
}

fn cost(count: u32) {
    let one = solid(0.25);
    let mut lattice = half_space(count, one, 99, 1.0);
    let nodes = lattice.matter_nodes().count() as f64;
    let mut relaxer = Relaxer::default();
    // the clock of the thread goes in steps of some ms: as many nodes for each size
    let rounds = (2e6 / nodes / 30.0).ceil() as u32;
    let start = Instant::now();
    let begin = busy_ms(start);
    for _ in 0..rounds {
        relax(&mut relaxer, &mut lattice, ball(count, 0.5, 0.0), 30);
        lattice.put_to_rest();
    }
    let each = (busy_ms(start) - begin) / f64::from(30 * rounds);
    println!(
        "{count}³: {each:.4} ms an iteration, {:.1} ns a node with matter",
        each * 1e6 / nodes
    );
}

fn main() {
    if std::env::args().any(|argument| argument == "border") {
        for count in [11, 21, 41, 81] {
            let mut lattice = half_space(count, solid(0.25), 99, 1.0);
            let force = relax(
                &mut Relaxer::default(),
                &mut lattice,
                ball(count, 1.0, 0.0),
                1500,
            );
            println!("{count}³: {:.5} N", force.z);
        }
        return;
    }
    let given = std::env::args().nth(1).and_then(|count| count.parse().ok());
    let iterations = given.unwrap_or(ITERATIONS);
    println!("{iterations} iterations a frame, 21³ nodes, 0.25 node a frame");
    for poisson in [0.25, 0.45] {
        frames("one material", poisson, 99, 1.0, iterations);
        frames("6 layers over 100 x stiffer", poisson, 6, 100.0, iterations);
        frames("6 layers over bone", poisson, 6, 6e5, iterations);
    }
    for count in [11, 21, 31, 41] {
        cost(count);
    }
}
