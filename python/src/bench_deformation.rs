//! Soft tissue, measured: for `palpate bench deform`, `session`, `truth-cube` and
//! `stress --deform`.

use glam::UVec3;
use palpate_bench::deformation::lattice::{self, Layers};
use palpate_bench::deformation::session::{self, Plan, SessionBenchError};
use palpate_bench::deformation::stress;
use palpate_bench::stress::on_threads;
use palpate_deform::material::SolidSi;
use palpate_deform::particles::Workers;
use palpate_deform::particles::bench::{LjCrystal, LjRun, bench_lj_pairs as run_crystal};
use palpate_deform::particles::limits::{HEAT_AT_START, cuboid_heat, fcc_limits};
use palpate_deform::pressed_block::PressedBlock;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{Triple, rows, triple, vector};
use crate::errors::CoreError;
use crate::frame::dictionary;
use crate::segment::PySegment;
use crate::volume::PyVolume;

impl From<SessionBenchError> for CoreError {
    fn from(error: SessionBenchError) -> Self {
        Self::value(error.to_string())
    }
}

/// Refuses what is not within two ends.
fn within<T: PartialOrd + std::fmt::Display + Copy>(
    what: &str,
    given: T,
    [low, high]: [T; 2],
) -> Result<T, CoreError> {
    if low <= given && given <= high {
        return Ok(given);
    }
    Err(CoreError::value(format!(
        "{what} {given} given; allowed: {low} to {high}"
    )))
}

/// A block between plates that it sticks to, at rest.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "they are keywords in Python")]
pub fn press_block<'py>(
    py: Python<'py>,
    nodes: (u32, u32, u32),
    spacing: f64,
    young: f64,
    poisson: f64,
    low: Triple,
    high: Triple,
    tolerance: f64,
    iterations: u32,
) -> PyResult<Bound<'py, PyDict>> {
    let nodes = UVec3::from(nodes);
    within("nodes", nodes.min_element(), [3, 129])?;
    within("nodes", nodes.max_element(), [3, 129])?;
    let solid = SolidSi {
        young,
        poisson,
        density: 1000.0,
        fracture_energy: f64::INFINITY,
        friction: 0.0,
        stiffening: 0.0,
    };
    let block = PressedBlock {
        nodes,
        spacing: within("spacing [mm]", spacing, [1e-3, 1e3])?,
        solid: solid.checked().map_err(CoreError::from)?,
        plates: [vector(low), vector(high)],
        tolerance: within("tolerance", tolerance, [1e-9, 1.0])?,
        iterations,
    };
    if !block.plates.iter().all(|plate| plate.is_finite()) {
        return Err(CoreError::value("plates given that move by no number of mm").into());
    }
    let rest = py.detach(|| block.relax());
    dictionary!(py,
        "moved": rows(py, &rest.moved),
        "force": triple(rest.force),
        "iterations": rest.report.iterations,
        "residual": rest.report.residual,
    )
}

/// The lattice under a ball that presses and slides.
#[pyfunction]
pub fn bench_lattice_frames<'py>(
    py: Python<'py>,
    count: u32,
    poisson: f64,
    soft: i32,
    ratio: f64,
    iterations: u32,
) -> PyResult<Bound<'py, PyDict>> {
    within("nodes", count, [7, 101])?;
    let layers = Layers {
        poisson,
        soft,
        ratio,
    };
    let frames = py.detach(|| lattice::frames(count, layers, iterations));
    let frames = frames.map_err(CoreError::from)?;
    dictionary!(py,
        "seconds": frames.seconds,
        "worst_error": frames.worst_error,
        "worst_exact": frames.worst_exact,
    )
}

/// Time of an iteration for a node [s].
#[pyfunction]
pub fn bench_lattice_cost(py: Python<'_>, count: u32, updates: f64) -> PyResult<f64> {
    within("nodes", count, [7, 101])?;
    within("updates", updates, [1.0, 1e12])?;
    let cost = py.detach(|| lattice::cost(count, updates));
    Ok(cost.map_err(CoreError::from)?)
}

/// Force on a ball 1 mm deep in a box of nodes 1 mm apart [N].
#[pyfunction]
pub fn bench_lattice_force(py: Python<'_>, count: u32, iterations: u32) -> PyResult<f64> {
    within("nodes", count, [7, 129])?;
    let force = py.detach(|| lattice::force_in_box(count, iterations));
    Ok(force.map_err(CoreError::from)?)
}

/// Lennard-Jones pairs on one thread, and the crystal for another program.
#[pyfunction]
pub fn bench_lj_pairs<'py>(
    py: Python<'py>,
    cells: u32,
    temperature: f64,
    warm_up: u32,
    steps: u32,
    seed: u64,
) -> PyResult<Bound<'py, PyDict>> {
    within("cells", cells, [4, 64])?;
    within("temperature", temperature, [0.0, 10.0])?;
    let crystal = LjCrystal::new(cells, temperature, seed);
    let run = LjRun {
        warm_up,
        steps,
        workers: Workers::One,
        ..LjRun::default()
    };
    let figures = py.detach(|| run_crystal(&crystal, &run));
    dictionary!(py,
        "side": crystal.side,
        "positions": rows(py, &crystal.positions),
        "velocities": rows(py, &crystal.velocities),
        "step": run.step,
        "seconds": figures.seconds,
        "pairs_per_second": figures.pairs_per_second,
        "builds": figures.builds,
        "potential_at_start": figures.potential_at_start,
        "potential_after_warm_up": figures.potential_after_warm_up,
        "total_at_end": figures.total_at_end,
    )
}

/// What the thesis' particles cannot do.
#[pyfunction]
pub fn particle_limits(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let fcc = fcc_limits();
    let [face, space] = fcc.young_over_axis;
    let (early, late, damped) = py.detach(|| {
        (
            cuboid_heat(10, 0.0),
            cuboid_heat(50, 0.0),
            cuboid_heat(50, 1.0),
        )
    });
    dictionary!(py,
        "young_110": face,
        "young_111": space,
        "poisson": fcc.poisson,
        "heat_at_start": HEAT_AT_START,
        "heat_early": early,
        "heat_late": late,
        "heat_damped": damped,
    )
}

/// Servo and model as often as they can; in step where ticks are given.
#[pyfunction]
#[pyo3(signature = (volume, segment, model, samples, seed, ticks_in_step = None))]
pub fn bench_session<'py>(
    py: Python<'py>,
    volume: &PyVolume,
    segment: &PySegment,
    model: Option<&str>,
    samples: u32,
    seed: u64,
    ticks_in_step: Option<u32>,
) -> PyResult<Bound<'py, PyDict>> {
    within("samples", samples, [1, 3600])?;
    within("ticks", ticks_in_step.unwrap_or(100), [100, 1_000_000])?;
    let plan = Plan {
        scan: (volume.grid, volume.intensities.clone()),
        segment: &segment.segment,
        model,
        samples,
        ticks_in_step,
        seed,
    };
    let found = py
        .detach(|| session::measure(&plan))
        .map_err(CoreError::from)?;
    let each = |of: fn(&session::Sample) -> f64| found.samples.iter().map(of).collect::<Vec<_>>();
    dictionary!(py,
        "ticks": each(|sample| sample.ticks as f64),
        "contacts": each(|sample| sample.contacts as f64),
        "answers": each(|sample| sample.answers as f64),
        "seconds": each(|sample| sample.seconds),
        "nodes": found.nodes,
        "iterations": found.iterations,
        "violations": found.violations,
    )
}

/// Runs `first` to `first + count` of a seed, with a model.
#[pyfunction]
pub fn bench_matter_stress<'py>(
    py: Python<'py>,
    model: &str,
    seed: u64,
    first: u64,
    count: u64,
    ticks: u64,
    threads: usize,
) -> PyResult<Bound<'py, PyDict>> {
    within("threads", threads, [1, 256])?;
    within("ticks", ticks, [1, 1_000_000_000])?;
    let end = first.checked_add(count).ok_or_else(|| {
        CoreError::value(format!("{count} runs from {first} given; allowed: 64 bits"))
    })?;
    let report = py.detach(|| on_threads(threads, || stress::runs(model, seed, first..end, ticks)));
    let report = report
        .map_err(|error| CoreError::value(format!("{threads} threads given: {error}")))?
        .map_err(CoreError::from)?;
    let violation = report
        .violation
        .as_ref()
        .map(|found| -> PyResult<Bound<'py, PyDict>> {
            dictionary!(py,
                "run": found.run,
                "tick": found.tick,
                "guarantee": found.violation.guarantee as u8,
                "what": found.violation.what.clone(),
            )
        });
    dictionary!(py,
        "ticks": report.ticks,
        "contacts": report.contacts,
        "bits": report.bits,
        "edits": report.edits,
        "answers": report.answers,
        "in_bone": report.in_bone,
        "drilled": report.drilled,
        "punctures": report.punctures,
        "rests": report.rests,
        "violation": violation.transpose()?,
    )
}
