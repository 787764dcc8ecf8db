//! How fast and how near the bonded lattice comes to rest under a ball, what a node costs, and
//! how well its border stands for the body behind it: for `palpate bench deform`.
//!
//! A box of nodes 1 mm apart, half of it tissue, under a ball of 2 mm that presses 1 mm deep and
//! then slides, a quarter of a node a frame. Goals (design, section 8): 30 frames a second on one
//! core with the force within 1 % of that at a residual of 1e-6, also soft tissue over bone.

use std::time::Instant;

use glam::{DVec3, UVec3};
use palpate_deform::lattice::{
    Border, Lattice, LatticeSettings, LatticeTool, NodeMaterial, RelaxSettings, Relaxer,
};
use palpate_deform::material::{MaterialError, Solid, SolidSi};

/// Frames of a run: four that press, the rest slide.
pub const FRAMES: u32 = 16;
const PRESSING: u32 = 4;
/// Way of the ball in a frame [nodes].
const WAY: f64 = 0.25;
const RADIUS: f64 = 2.0;
/// Residual of the force that counts as exact, and iterations for it at most.
const EXACT: f64 = 1e-6;
const EXACT_ITERATIONS: u32 = 6000;
/// Young's modulus of the soft tissue [Pa].
const YOUNG: f64 = 1e4;
/// Iterations between two rests when the cost is measured.
const COST_ITERATIONS: u32 = 30;

/// What is pressed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layers {
    /// Poisson's ratio of all of it.
    pub poisson: f64,
    /// Nodes of soft tissue over the stiff; more than the box has for one material.
    pub soft: i32,
    /// Young's modulus of the stiff tissue over that of the soft.
    pub ratio: f64,
}

/// How a run of frames went.
#[derive(Clone, Debug, PartialEq)]
pub struct Frames {
    /// Time of each frame on a core [s].
    pub seconds: Vec<f64>,
    /// Largest error of the force, over the force at rest.
    pub worst_error: f64,
    /// Largest residual of what counts as exact.
    pub worst_exact: f64,
}

/// Presses a box of `count`³ nodes and slides over it, each frame until its nodes are as far at
/// rest as in a session, with so many iterations at most.
///
/// # Errors
/// Where the layers are none.
pub fn frames(count: u32, layers: Layers, iterations: u32) -> Result<Frames, MaterialError> {
    let mut lattice = half_space(count, layers)?;
    let mut exact = lattice.clone();
    let (mut relaxer, mut exact_relaxer) = (Relaxer::default(), Relaxer::default());
    let usual = LatticeSettings::default().tolerance;
    let mut found = Frames {
        seconds: Vec::new(),
        worst_error: 0.0,
        worst_exact: 0.0,
    };
    let clock = Instant::now();
    for frame in 1..=FRAMES {
        let depth = WAY * f64::from(frame.min(PRESSING));
        let aside = WAY * f64::from(frame.saturating_sub(PRESSING));
        let tool = ball(count, depth, aside);
        let begin = on_core(clock);
        let (force, _) = relax(&mut relaxer, &mut lattice, tool, (usual, iterations));
        found.seconds.push(on_core(clock) - begin);
        let exactly = (EXACT, EXACT_ITERATIONS);
        let (rest, left) = relax(&mut exact_relaxer, &mut exact, tool, exactly);
        let error = (force - rest).length() / rest.length();
        found.worst_error = found.worst_error.max(error);
        found.worst_exact = found.worst_exact.max(left);
    }
    Ok(found)
}

/// Time of an iteration for a node with matter [s], in a box of `count`³ nodes, over `updates`
/// updates of nodes at least.
///
/// # Errors
/// Never: the matter is one.
pub fn cost(count: u32, updates: f64) -> Result<f64, MaterialError> {
    let mut lattice = half_space(count, Layers::one(0.25))?;
    let nodes = lattice.matter_nodes().count() as f64;
    let mut relaxer = Relaxer::default();
    let rounds = (updates / nodes / f64::from(COST_ITERATIONS))
        .ceil()
        .max(1.0) as u32;
    let clock = Instant::now();
    let begin = on_core(clock);
    let mut iterations = 0;
    for _ in 0..rounds {
        let settings = RelaxSettings {
            tolerance: 0.0,
            iterations: COST_ITERATIONS,
            reference: 0.0,
        };
        let tool = ball(count, 0.5, 0.0);
        iterations += relaxer
            .relax(&mut lattice, &[tool], &settings, &|| false)
            .iterations;
        lattice.put_to_rest();
    }
    // the clock of a core goes in steps of some ms, and a short run may lie within one
    let busy = match on_core(clock) - begin {
        busy if busy > 0.0 => busy,
        _ => clock.elapsed().as_secs_f64(),
    };
    Ok(busy / (f64::from(iterations) * nodes))
}

/// Force on a ball 1 mm deep in a box of `count`³ nodes, at rest [N].
///
/// # Errors
/// Never: the matter is one.
pub fn force_in_box(count: u32, iterations: u32) -> Result<f64, MaterialError> {
    let mut lattice = half_space(count, Layers::one(0.25))?;
    let tool = ball(count, 1.0, 0.0);
    Ok(relax(
        &mut Relaxer::default(),
        &mut lattice,
        tool,
        (EXACT, iterations),
    )
    .0
    .z)
}

impl Layers {
    /// One material.
    #[must_use]
    pub const fn one(poisson: f64) -> Self {
        Self {
            poisson,
            soft: i32::MAX,
            ratio: 1.0,
        }
    }
}

/// Half a box of tissue under a plane through its middle.
fn half_space(count: u32, layers: Layers) -> Result<Lattice, MaterialError> {
    let soft = solid(layers.poisson, 1.0)?;
    let stiff = solid(layers.poisson, layers.ratio)?;
    let half = count as i32 / 2;
    let load = DVec3::splat(f64::from(half));
    let border = Border::Endless { load };
    Ok(Lattice::new(
        UVec3::splat(count),
        1.0,
        border,
        |node| match half - node.z {
            ..0 => NodeMaterial::Empty,
            depth if depth < layers.soft => NodeMaterial::Deformable(soft),
            _ => NodeMaterial::Deformable(stiff),
        },
    ))
}

fn solid(poisson: f64, ratio: f64) -> Result<Solid, MaterialError> {
    let si = SolidSi {
        young: ratio * YOUNG,
        poisson,
        density: 1000.0,
        fracture_energy: f64::INFINITY,
        friction: 0.0,
        stiffening: 0.0,
    };
    si.checked()
}

/// A ball that reaches `depth` into the half space.
fn ball(count: u32, depth: f64, aside: f64) -> LatticeTool {
    let middle = DVec3::splat(f64::from(count / 2));
    // matter reaches half a spacing beyond its nodes
    let up = 0.5 + RADIUS - depth;
    LatticeTool::ball(middle + DVec3::new(aside, 0.0, up), RADIUS)
}

fn relax(
    relaxer: &mut Relaxer,
    lattice: &mut Lattice,
    tool: LatticeTool,
    (tolerance, iterations): (f64, u32),
) -> (DVec3, f64) {
    let settings = RelaxSettings {
        tolerance,
        iterations,
        reference: 0.0,
    };
    let report = relaxer.relax(lattice, &[tool], &settings, &|| false);
    (relaxer.felt()[0].force, report.residual)
}

/// Time that this thread was on a core [s], so that other programs count less; the clock's where
/// the system does not tell.
fn on_core(clock: Instant) -> f64 {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|told| told.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| clock.elapsed().as_secs_f64(), |ns| ns * 1e-9)
}
