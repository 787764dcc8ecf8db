//! Timing of touch on real segments, for `palpate bench haptics`.
//!
//! What is timed is what the servo runs: the same bodies ([`Touchable`]), the same tick with
//! friction, smoothing and safety stage, the owner of the touched voxel looked up as there.
//! Every contact model gets the path on which `exact` presses and slides.
//!
//! Budgets (design, section 8): detection of rays 4 voxels long at least 15 M/s, the hard proxy
//! at least 2 M/s, the complete tick 1, 0.4 and 0.15 M/s for a point, balls of 1 and 2 voxels,
//! and a ball of 5, with 99.9 % within 20 µs.

mod embedded;
mod ground;
mod rays;
mod stroke;

pub use crate::timing::Timing;
pub use embedded::{Embedded, compare};
pub use ground::Ground;
pub use rays::free_rays;
pub(crate) use stroke::touched_point;
pub use stroke::{DEPTH, STEP, Stroke, stroke};

use std::hint::black_box;

use glam::DVec3;
use palpate_engine::touch::{Model, Owners, Settings, TouchFeels, Touchable, TouchedSurfaces};
use palpate_haptics::ball::BallError;
use palpate_haptics::contact::{ContactModel, Exact, Proxy};
use palpate_haptics::force::{ForceLimits, Safety};
use palpate_haptics::smooth::Smoothing;
use palpate_haptics::thesis::{ThesisImproved, ThesisOriginal};
use palpate_haptics::tick::{TickCache, TickInput, TickState, tick};
use palpate_volume::first_solid::first_solid;
use palpate_volume::grid::Grid;

/// What is timed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Work {
    /// One traversal of a ray that meets nothing: of `exact` the traversal alone, of the
    /// thesis' models a move of the proxy over that way, which is theirs.
    Detection {
        /// Length of the ray [voxels].
        length: f64,
    },
    /// The contact model alone, the device pressing and sliding.
    Proxy,
    /// A complete tick: frames, friction, contact model, smooth point, coupling, safety stage.
    Tick {
        /// Where the force comes from.
        smoothing: Smoothing,
        /// Whether bone is rough.
        friction: bool,
    },
}

impl Work {
    /// The tick as it is.
    pub const TICK: Self = Self::Tick {
        smoothing: Smoothing::Intensities,
        friction: true,
    };
}

/// What came out.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Time of single calls, and calls per second without a clock between them.
    pub timing: Timing,
    /// Fraction of the updates in contact; 0 for detection.
    pub contact_fraction: f64,
    /// Voxels read per call, on average; 0 where the model's own detection is timed.
    pub mean_visits: f64,
    /// Length of the device's moves in smallest spacings, on average; of rays in voxels.
    pub mean_step: f64,
}

/// Why nothing can be timed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum BenchError {
    /// Nothing to touch.
    #[error("segments without a surface given; allowed: some that can be touched")]
    NoSurface,
    /// Not a probe.
    #[error(transparent)]
    Ball(#[from] BallError),
    /// The thesis knows no balls.
    #[error("{0} with a ball given; allowed: a point, which is all that the thesis has")]
    PointsOnly(&'static str),
}

/// A probe that presses and slides over a ground: the same seed gives the same path.
#[derive(Debug)]
pub struct TouchBench {
    grid: Grid,
    touchable: Touchable,
    exact: Exact,
    stroke: Stroke,
    seed: u64,
}

impl TouchBench {
    /// A path of `count` updates for a probe of a radius [smallest spacings]; 0 is a point. A
    /// ball presses as deep as a point, measured from its own surface.
    ///
    /// # Errors
    /// Where there is no surface to touch, or the ball is too large.
    pub fn new(ground: &Ground, radius: f64, count: usize, seed: u64) -> Result<Self, BenchError> {
        let grid = ground.grid;
        let radius_mm = radius * grid.smallest_spacing();
        let touchable = Touchable::new(&grid, ground.parts(), radius_mm)?;
        let exact = Exact {
            limits: touchable.limits(),
        };
        let stroke =
            stroke(&grid, &touchable.world, &exact, count, seed).ok_or(BenchError::NoSurface)?;
        Ok(Self {
            grid,
            touchable,
            exact,
            stroke,
            seed,
        })
    }

    /// Times a call for each update of the path.
    ///
    /// # Errors
    /// Where a model of the thesis shall have a ball.
    pub fn run(&self, work: Work, model: Model) -> Result<Report, BenchError> {
        let is_point = self.touchable.radius == 0.0;
        match model {
            Model::Exact => Ok(self.time(work, &self.exact)),
            _ if !is_point => Err(BenchError::PointsOnly(model.name())),
            Model::ThesisOriginal => Ok(self.time(work, &ThesisOriginal::default())),
            Model::ThesisImproved => Ok(self.time(work, &ThesisImproved::default())),
        }
    }

    fn time(&self, work: Work, model: &impl ContactModel) -> Report {
        match work {
            Work::Detection { length } if model.has_own_force() => self.time_moves(model, length),
            Work::Detection { length } => self.time_traversals(length),
            Work::Proxy => self.time_proxy(model),
            Work::Tick {
                smoothing,
                friction,
            } => self.time_tick(model, smoothing, friction),
        }
    }

    fn time_traversals(&self, length: f64) -> Report {
        let solid = &self.touchable.world;
        let rays = free_rays(&self.grid, solid, &self.stroke, length, self.seed);
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
            contact_fraction: 0.0,
            mean_visits: visits as f64 / rays.len().max(1) as f64,
            mean_step: length,
        }
    }

    /// Detection as a model does it by itself: its proxy goes along each ray.
    fn time_moves(&self, model: &impl ContactModel, length: f64) -> Report {
        let scene = self.touchable.scene(&self.grid);
        let rays = free_rays(&self.grid, scene.occupancy, &self.stroke, length, self.seed);
        let moves: Vec<(Proxy, DVec3)> = rays
            .iter()
            .filter_map(|(start, end)| Some((Proxy::at(*start)?, *end)))
            .collect();
        let timing = Timing::of(moves.len(), || {
            let (moves, scene) = (&moves, &scene);
            move |call: usize| {
                let (mut proxy, end) = moves[call];
                let contact = model.advance(scene, end, &mut proxy);
                black_box(proxy);
                contact.touching
            }
        });
        Report {
            timing,
            contact_fraction: 0.0,
            mean_visits: 0.0,
            mean_step: length,
        }
    }

    fn time_proxy(&self, model: &impl ContactModel) -> Report {
        let scene = self.touchable.scene(&self.grid);
        let grid_from_scene = self.grid.grid_from_patient();
        let path: Vec<DVec3> = self
            .stroke
            .device
            .iter()
            .map(|point| grid_from_scene.transform_point3(*point))
            .collect();
        let timing = Timing::of(path.len(), || {
            let mut proxy = self.first_proxy();
            let (path, scene) = (&path, &scene);
            move |call: usize| model.advance(scene, path[call], &mut proxy).touching
        });

        let mut proxy = self.first_proxy();
        let updates = path.iter().map(|device| {
            let contact = model.advance(&scene, *device, &mut proxy);
            (contact.touching, contact.visits)
        });
        self.report(timing, updates)
    }

    fn time_tick(&self, model: &impl ContactModel, smoothing: Smoothing, friction: bool) -> Report {
        let scene = self.touchable.scene(&self.grid);
        let (friction_static, friction_kinetic) = if friction { (0.3, 0.2) } else { (0.0, 0.0) };
        let settings = Settings {
            friction_static,
            friction_kinetic,
            ..Settings::default()
        };
        let feels = TouchFeels::default();
        let owners = Owners::default();
        let surfaces = TouchedSurfaces {
            touchable: &self.touchable,
            owners: &owners,
            settings: &settings,
            feels: Some(&feels),
        };
        let input = |call: usize| TickInput {
            device_in_scene: self.stroke.device[call],
            velocity_in_scene: DVec3::ZERO,
            damping: settings.damping,
            smoothing,
        };
        let count = self.stroke.device.len();
        let timing = Timing::of(count, || {
            let mut state = TickState::new(self.first_proxy());
            let mut cache = TickCache::default();
            let mut safety = Safety::new(ForceLimits::default());
            let (scene, surfaces, input) = (&scene, &surfaces, &input);
            move |call: usize| {
                let input = input(call);
                let output = tick(scene, model, surfaces, &input, &mut state, &mut cache);
                // as the servo and the device thread do after it
                let held_by = output.held_by;
                black_box(held_by.and_then(|solid| surfaces.owner(solid)));
                black_box(safety.limit(output.force, 1e-3));
                output.contact
            }
        });

        let mut state = TickState::new(self.first_proxy());
        let mut cache = TickCache::default();
        let updates = (0..count).map(|call| {
            let input = input(call);
            let output = tick(&scene, model, &surfaces, &input, &mut state, &mut cache);
            (output.contact, output.visits)
        });
        self.report(timing, updates)
    }

    fn first_proxy(&self) -> Proxy {
        let grid_from_scene = self.grid.grid_from_patient();
        Proxy::at(grid_from_scene.transform_point3(self.stroke.start))
            .expect("a stroke begins at a free point near its solid")
    }

    /// The report on a model whose updates are given as contact and voxels read.
    fn report(
        &self,
        timing: Timing,
        updates: impl ExactSizeIterator<Item = (bool, u32)>,
    ) -> Report {
        let count = updates.len().max(1) as f64;
        let (contacts, visits) =
            updates.fold((0_u64, 0_u64), |(contacts, sum), (contact, visits)| {
                (contacts + u64::from(contact), sum + u64::from(visits))
            });
        Report {
            timing,
            contact_fraction: contacts as f64 / count,
            mean_visits: visits as f64 / count,
            mean_step: self.stroke.mean_step() / self.grid.smallest_spacing(),
        }
    }
}
