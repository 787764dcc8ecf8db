//! Timing of touch on a real segment, for `palpate bench haptics`.
//!
//! Budgets (design, section 8): detection of rays 4 voxels long at least 15 M/s, the hard proxy
//! pressing and sliding at least 2 M/s (1 M/s on CThead in the first version).

pub mod passivity;
pub mod quality;
mod random;
mod rays;
pub mod stress;
mod stroke;
mod timing;

pub use crate::model::Model;
pub use rays::free_rays;
pub use stroke::{DEPTH, STEP, Stroke, stroke};
pub use timing::Timing;

use std::hint::black_box;

use glam::DVec3;
use palpate_haptics::contact::ContactModel;
use palpate_haptics::exact::Exact;
use palpate_haptics::proxy::Proxy;
use palpate_haptics::safety::{ForceLimits, Safety};
use palpate_haptics::scene::TouchScene;
use palpate_haptics::surface::{Surface, Uniform};
use palpate_haptics::thesis_improved::ThesisImproved;
use palpate_haptics::thesis_original::ThesisOriginal;
use palpate_haptics::tick::{TickCache, TickInput, TickState, tick};
use palpate_volume::bits::Bits;
use palpate_volume::first_solid::first_solid;
use palpate_volume::grid::Grid;

use crate::settings::Settings;

/// What is timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// One traversal of a ray 4 voxels long that meets nothing.
    Detection,
    /// The contact model alone, the device pressing and sliding.
    Proxy,
    /// A complete tick: frames, contact model, coupling and safety stage.
    Tick,
}

/// What came out.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Time of single calls, and calls per second without a clock between them.
    pub timing: Timing,
    /// Share of the updates in contact; 0 for detection.
    pub contact_share: f64,
    /// Voxels read per call, on average.
    pub mean_visits: f64,
    /// Length of the device's moves in smallest spacings, on average; 4 voxels for detection.
    pub mean_step: f64,
}

/// Times `count` calls on a solid; none where it has no surface to touch. The same seed gives
/// the same calls: every model gets the device path on which `exact` presses and slides.
/// Detection is the traversal, whatever the model.
#[must_use]
pub fn run(
    grid: &Grid,
    solid: &Bits,
    work: Work,
    model: Model,
    count: usize,
    seed: u64,
) -> Option<Report> {
    let stroke = stroke(grid, solid, count, seed)?;
    let report = match (work, model) {
        (Work::Detection, _) => time_detection(grid, solid, &stroke, seed),
        (_, Model::Exact) => time_model(grid, solid, work, &Exact::default(), &stroke),
        (_, Model::ThesisOriginal) => {
            time_model(grid, solid, work, &ThesisOriginal::default(), &stroke)
        }
        (_, Model::ThesisImproved) => {
            time_model(grid, solid, work, &ThesisImproved::default(), &stroke)
        }
    };
    Some(report)
}

fn time_model(
    grid: &Grid,
    solid: &Bits,
    work: Work,
    model: &impl ContactModel,
    stroke: &Stroke,
) -> Report {
    if work == Work::Tick {
        time_tick(grid, solid, model, stroke)
    } else {
        time_proxy(grid, solid, model, stroke)
    }
}

fn time_detection(grid: &Grid, solid: &Bits, stroke: &Stroke, seed: u64) -> Report {
    let rays = free_rays(grid, solid, stroke, seed);
    let timing = Timing::of(rays.len(), || {
        let rays = &rays;
        move |call: usize| {
            let (start, end) = rays[call];
            black_box(first_solid(solid, start, end)).is_some()
        }
    });
    let visits: u64 = rays.iter().map(|ray| rays::visits(*ray)).sum();
    Report {
        timing,
        contact_share: 0.0,
        mean_visits: visits as f64 / rays.len().max(1) as f64,
        mean_step: rays::LENGTH,
    }
}

fn time_proxy(grid: &Grid, solid: &Bits, model: &impl ContactModel, stroke: &Stroke) -> Report {
    let scene = TouchScene::of_world(solid, grid);
    let grid_from_scene = grid.grid_from_patient();
    let path: Vec<DVec3> = stroke
        .device
        .iter()
        .map(|point| grid_from_scene.transform_point3(*point))
        .collect();
    let timing = Timing::of(path.len(), || {
        let mut proxy = first_proxy(grid, stroke);
        let (path, scene) = (&path, &scene);
        move |call: usize| model.advance(scene, path[call], &mut proxy).touching
    });

    let mut proxy = first_proxy(grid, stroke);
    let updates = path.iter().map(|device| {
        let contact = model.advance(&scene, *device, &mut proxy);
        (contact.touching, contact.visits)
    });
    report(timing, grid, stroke, updates)
}

fn time_tick(grid: &Grid, solid: &Bits, model: &impl ContactModel, stroke: &Stroke) -> Report {
    let scene = TouchScene::of_world(solid, grid);
    let input = |device: DVec3| TickInput {
        device_in_scene: device,
        velocity_in_scene: DVec3::ZERO,
        damping: Settings::default().damping,
        smoothing: true,
    };
    // with friction, as bone has it
    let surface = Uniform(Surface {
        friction_static: 0.3,
        friction_kinetic: 0.2,
        ..Uniform::smooth(Settings::default().stiffness).0
    });
    let first_state = || TickState::new(first_proxy(grid, stroke));
    let timing = Timing::of(stroke.device.len(), || {
        let mut state = first_state();
        let mut cache = TickCache::default();
        let mut safety = Safety::new(ForceLimits::default());
        let scene = &scene;
        move |call: usize| {
            let input = input(stroke.device[call]);
            let output = tick(scene, model, &surface, &input, &mut state, &mut cache);
            black_box(safety.limit(output.force, 1e-3));
            output.contact
        }
    });

    let mut state = first_state();
    let mut cache = TickCache::default();
    let updates = stroke.device.iter().map(|device| {
        let input = input(*device);
        let output = tick(&scene, model, &surface, &input, &mut state, &mut cache);
        (output.contact, output.visits)
    });
    report(timing, grid, stroke, updates)
}

fn first_proxy(grid: &Grid, stroke: &Stroke) -> Proxy {
    let point_in_grid = grid.grid_from_patient().transform_point3(stroke.start);
    Proxy::at(point_in_grid).expect("a stroke begins at a free point near its solid")
}

/// The report on a model whose updates are given as contact and voxels read.
fn report(
    timing: Timing,
    grid: &Grid,
    stroke: &Stroke,
    updates: impl ExactSizeIterator<Item = (bool, u32)>,
) -> Report {
    let count = updates.len().max(1) as f64;
    let (contacts, visits) = updates.fold((0_u64, 0_u64), |(contacts, sum), (contact, visits)| {
        (contacts + u64::from(contact), sum + u64::from(visits))
    });
    Report {
        timing,
        contact_share: contacts as f64 / count,
        mean_visits: visits as f64 / count,
        mean_step: stroke.mean_step() / grid.smallest_spacing(),
    }
}
