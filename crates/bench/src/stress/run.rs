//! One run: a world, a hand, and the checker after each thing that happens.

mod changes;

use std::ops::Range;

use glam::DVec3;
use palpate_engine::touch::{LimitedModel, Model};
use palpate_haptics::admission::{PoseMotion, nearest_free};
use palpate_haptics::ball::{BallShape, ball_limits};
use palpate_haptics::contact::{ContactModel, ExactLimits, Proxy};
use palpate_haptics::force::{ForceLimits, Safety, Surface, Uniform};
use palpate_haptics::tick::{TickCache, TickInput, TickOutput, TickState, tick};
use palpate_volume::grid::Grid;
use palpate_volume::voxel_box::VoxelBox;
use rayon::prelude::*;

use super::checker::Checker;
use super::constants::Constants;
use super::dense::Dense;
use super::felt::Felt;
use super::force_check::ForceCheck;
use super::guarantee::{Guarantee, Violation};
use super::hand::{Hand, anywhere};
use super::object::{Made, Object};
use super::plan::{Plan, Terrain};
use super::report::{Found, Report, Source};
use super::touched::Touched;
use super::world::World;
use crate::random::Random;

/// Time between ticks [s].
const DT: f64 = 1e-3;
/// How often rests and nonsense come, per move.
const RESTS: f64 = 1.0 / 512.0;
const NONSENSE: f64 = 1.0 / 2048.0;
/// Ticks after which the proxy rests.
const PROXY_RESTS: usize = 16;
/// Ticks after which the force does, and those that its way takes besides.
const FORCE_RESTS: usize = 64;
/// Ticks at rest that must be equal to the bit.
const STILL: usize = 8;
/// How far around a point a free place for the probe is sought [voxels].
const START_REACH: i32 = 6;
/// Points tried.
const STARTS: usize = 8;

/// Runs with these numbers, on as many threads as [`on_threads`] gave, or on all cores. What
/// comes of a run does not depend on how many there are.
#[must_use]
pub fn runs(seed: u64, numbers: Range<u64>, model: Model, bone: Option<Source<'_>>) -> Report {
    numbers
        .into_par_iter()
        .map(|number| run(seed, number, model, bone))
        .reduce(Report::default, Report::and)
}

/// Does some work, such as [`runs`], with so many threads.
///
/// # Errors
/// The system gives no such threads.
pub fn on_threads<T: Send>(
    count: usize,
    work: impl FnOnce() -> T + Send,
) -> Result<T, rayon::ThreadPoolBuildError> {
    let threads = rayon::ThreadPoolBuilder::new().num_threads(count).build()?;
    Ok(threads.install(work))
}

/// The run of a number, up to its first violation.
#[must_use]
pub fn run(seed: u64, number: u64, model: Model, bone: Option<Source<'_>>) -> Report {
    let mut random = Random::of_stream(seed, number);
    let mut plan = Plan::new(number, bone.is_some(), &mut random);
    if let (Terrain::Bone, Some(bone)) = (plan.terrain, bone) {
        plan.spacing = bone.grid.spacing();
    }
    let world = World::new(&plan, bone.map(|bone| bone.bits), &mut random);
    let grid = plan.grid();
    let radius = plan.radius * grid.smallest_spacing();
    let limits = BallShape::new(radius, grid.spacing())
        .ok()
        .filter(|_| radius > 0.0)
        .map_or_else(ExactLimits::default, |shape| ball_limits(&shape));
    let model = LimitedModel { model, limits };
    Run::new(&plan, world, &grid, model, random).report(number)
}

struct Run<'a, M> {
    plan: &'a Plan,
    grid: &'a Grid,
    constants: Constants,
    touched: Touched,
    model: M,
    random: Random,
    /// What edits want, be it touched already or held back.
    wanted: Dense,
    fixed: Dense,
    /// Boxes of edits that may not all be touched yet.
    unsettled: Vec<VoxelBox>,
    made: Vec<Made>,
    motions: Vec<Option<PoseMotion>>,
    checker: Checker,
    force_check: ForceCheck,
    hand: Hand,
    surface: Uniform,
    cache: TickCache,
    /// Changes of what is solid.
    epoch: u64,
    safety: Safety,
    last_device: DVec3,
    report: Report,
}

impl<'a, M: ContactModel> Run<'a, M> {
    fn new(plan: &'a Plan, world: World, grid: &'a Grid, model: M, mut random: Random) -> Self {
        let limits = ForceLimits::default();
        let friction = if random.share() < 0.5 { 0.0 } else { 0.5 };
        let radius = plan.radius * grid.smallest_spacing();
        let constants = Constants {
            spacing: plan.spacing,
            direction: plan.direction,
            origin: plan.origin,
            radius,
            // to where friction holds the probe, and to the device
            visit_bound: 2 * model.visit_bound(),
            limits,
            dt: DT,
            stiffness: 0.2 + 5.0 * random.share(),
            damping: if random.share() < 0.5 { 0.0 } else { 0.01 },
            frictionless: friction == 0.0,
            felt: if model.has_own_force() {
                Felt::Stairs
            } else {
                Felt::random(&mut random)
            },
        };
        let made: Vec<(Object, Made)> = (0..plan.objects)
            .map(|_| Object::random(plan, grid, &mut random))
            .collect();
        let (objects, made): (Vec<Object>, Vec<Made>) = made.into_iter().unzip();
        let touched = Touched::new((world.bits(), plan.spacing), radius, &made, |bits| {
            constants.felt.fractions(bits, &mut random)
        });
        // without edits, all that is solid stays
        let constant = if plan.edits {
            &world.fixed
        } else {
            &world.dense
        }
        .clone();
        Self {
            plan,
            grid,
            constants,
            touched,
            model,
            checker: Checker::new(constants, world.dense.clone(), &constant, objects),
            wanted: world.dense,
            fixed: world.fixed,
            unsettled: Vec::new(),
            motions: vec![None; made.len()],
            made,
            hand: Hand::new(&mut random),
            force_check: ForceCheck::new(constants, DVec3::ZERO),
            surface: Uniform(Surface {
                friction_static: friction,
                friction_kinetic: 0.8 * friction,
                ..Uniform::smooth(constants.stiffness).0
            }),
            cache: TickCache::default(),
            epoch: 0,
            safety: Safety::new(limits),
            last_device: DVec3::ZERO,
            random,
            report: Report::default(),
        }
    }

    fn report(mut self, number: u64) -> Report {
        let ended = self.all_moves();
        self.report.cuts = self.force_check.cuts;
        if let Err(violation) = ended {
            self.report.violation = Some(Found {
                run: number,
                at_move: self.report.moves,
                plan: *self.plan,
                violation,
            });
        }
        self.report
    }

    fn all_moves(&mut self) -> Result<(), Violation> {
        // a world may have no room for the probe
        let Some(proxy) = (0..STARTS).find_map(|_| self.free_place()) else {
            return Ok(());
        };
        let mut state = TickState::new(proxy);
        self.last_device = proxy.point();
        self.force_check = ForceCheck::new(self.constants, proxy.point());
        for _ in 0..self.plan.moves {
            if self.plan.edits {
                self.edit(&mut state.proxy)?;
            }
            if self.plan.motion {
                self.move_objects(&mut state.proxy)?;
            }
            if self.random.share() < NONSENSE {
                self.nonsense(&mut state)?;
            }
            let device = self.hand.go(state.proxy.point(), &mut self.random);
            self.go(device, &mut state)?;
            self.report.moves += 1;
            if self.random.share() < RESTS {
                self.rest(device, &mut state)?;
            }
        }
        Ok(())
    }

    /// A place for the probe, free in every body.
    fn free_place(&mut self) -> Option<Proxy> {
        let start = anywhere(&mut self.random);
        let scene = self.touched.scene(self.grid);
        let proxy = nearest_free(scene.occupancy, self.grid, start, START_REACH)?;
        let is_inside = self.wanted.index(proxy.voxel()).is_some();
        // touch keeps a ball a little farther from an object than it has to
        let is_free = is_inside && scene.solid_at(proxy.point()).is_none();
        (is_free && self.checker.after_changes(&proxy).is_ok()).then_some(proxy)
    }

    /// One tick, checked.
    fn go(&mut self, device: DVec3, state: &mut TickState) -> Result<TickOutput, Violation> {
        let from = state.proxy;
        let output = self.tick(device, state);
        let ends = [&from, &state.proxy];
        self.checker.after_tick(device, ends, &output)?;
        self.force_check.after_tick(device, &state.proxy, &output)?;
        let sent = self.safety.limit(output.force, DT);
        self.force_check.after_safety(output.force, sent)?;
        self.report.contacts += u64::from(output.contact);
        Ok(output)
    }

    fn tick(&mut self, device: DVec3, state: &mut TickState) -> TickOutput {
        let device_in_scene = self.constants.in_scene(device);
        let moved = device_in_scene - self.constants.in_scene(self.last_device);
        self.last_device = device;
        let scene = self.touched.scene(self.grid);
        let input = TickInput {
            device_in_scene,
            velocity_in_scene: moved / DT,
            damping: self.constants.damping,
            smoothing: self.constants.felt.smoothing(),
        };
        self.cache.set_epoch(self.epoch);
        let (model, surface) = (&self.model, &self.surface);
        tick(&scene, model, surface, &input, state, &mut self.cache)
    }

    /// Guarantee 4: the proxy rests soon; the force follows it by a tenth of the smallest
    /// spacing in each tick, and so rests after as many as its way is long.
    fn rest(&mut self, device: DVec3, state: &mut TickState) -> Result<(), Violation> {
        let h = self.grid.smallest_spacing();
        let mut output = self.go(device, state)?;
        for _ in 1..PROXY_RESTS {
            output = self.go(device, state)?;
        }
        let proxy = state.proxy;
        let depth = ((proxy.point() - device) * self.constants.spacing).length();
        let force_rests =
            ((output.spring.length() + depth) / (0.1 * h)).ceil() as usize + FORCE_RESTS;
        let mut still = 0;
        for tick in 0.. {
            let again = self.go(device, state)?;
            still = if again == output { still + 1 } else { 0 };
            if state.proxy != proxy || (still == 0 && tick > force_rests) {
                return Err(Violation {
                    guarantee: Guarantee::ComesToRest,
                    what: format!("{output:?}, then {again:?}"),
                });
            }
            if still == STILL {
                break;
            }
            output = again;
        }
        Ok(())
    }

    /// An input that is none.
    fn nonsense(&mut self, state: &mut TickState) -> Result<(), Violation> {
        let bad = [f64::NAN, f64::INFINITY, -1e300, 1e18];
        let bad = bad[(4.0 * self.random.share()) as usize];
        let from = state.proxy;
        let device = self.hand.device.with_y(bad);
        let last_device = self.last_device;
        let output = self.tick(device, state);
        self.last_device = last_device;
        self.force_check
            .after_nonsense([&from, &state.proxy], &output)
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use palpate_haptics::contact::{Contact, Exact};
    use palpate_haptics::scene::TouchScene;
    use palpate_volume::occupancy::Occupancy;

    use super::*;

    /// `exact` with a fault of its own after so many calls.
    struct Faulty<F> {
        calls: Cell<u32>,
        visit_bound: u32,
        fault: F,
    }

    impl<F: Fn(u32, DVec3, &mut Proxy, &mut Contact)> ContactModel for Faulty<F> {
        fn advance<O: Occupancy>(
            &self,
            scene: &TouchScene<'_, O>,
            device: DVec3,
            proxy: &mut Proxy,
        ) -> Contact {
            let mut contact = Exact::default().advance(scene, device, proxy);
            self.calls.set(self.calls.get() + 1);
            (self.fault)(self.calls.get(), device, proxy, &mut contact);
            contact
        }

        fn visit_bound(&self) -> u32 {
            self.visit_bound
        }
    }

    /// The first promise that is broken by a fault in a run of the first walls.
    fn broken(
        visit_bound: u32,
        fault: impl Fn(u32, DVec3, &mut Proxy, &mut Contact),
    ) -> Option<Guarantee> {
        let mut random = Random::of_stream(7, 0);
        let plan = Plan::new(0, false, &mut random);
        let world = World::new(&plan, None, &mut random);
        let model = Faulty {
            calls: Cell::new(0),
            visit_bound,
            fault,
        };
        let grid = plan.grid();
        let report = Run::new(&plan, world, &grid, model, random).report(0);
        report.violation.map(|found| found.violation.guarantee)
    }

    #[test]
    fn planted_faults_are_found_by_their_number() {
        let bound = Exact::default().visit_bound();
        assert_eq!(broken(bound, |_, _, _, _| ()), None);
        assert_eq!(broken(20, |_, _, _, _| ()), Some(Guarantee::BoundedWork));
        // into the wall with the device, or through it
        let follow = |_: u32, device: DVec3, proxy: &mut Proxy, _: &mut Contact| {
            *proxy = Proxy::at(device).unwrap_or(*proxy);
        };
        let through = [Guarantee::StaysOut, Guarantee::CrossesNoWall].map(Some);
        assert!(through.contains(&broken(bound, follow)));
        let press = |_: u32, _: DVec3, proxy: &mut Proxy, contact: &mut Contact| {
            if let Some(solid) = contact.stopped_by {
                *proxy = Proxy::nearest_in(solid.voxel, proxy.point());
            }
        };
        assert_eq!(broken(bound, press), Some(Guarantee::StaysOut));
        // a contact that is none: the spring pulls the hand back to where it was
        let sticky = |call: u32, device: DVec3, proxy: &mut Proxy, contact: &mut Contact| {
            if !contact.touching && call > 100 {
                let lower = device - DVec3::splat(1e-9) * f64::from(call % 2);
                *proxy = Proxy::nearest_in(proxy.voxel(), lower);
                contact.touching = true;
            }
        };
        assert_eq!(broken(bound, sticky), Some(Guarantee::ComesToRest));
    }

    #[test]
    fn an_edit_that_is_not_asked_for_admission_is_found() {
        let mut random = Random::of_stream(7, 0);
        let mut plan = Plan::new(0, false, &mut random);
        plan.edits = true;
        let world = World::new(&plan, None, &mut random);
        let grid = plan.grid();
        let mut run = Run::new(&plan, world, &grid, Exact::default(), random);
        run.touched.careless = true;
        let report = run.report(3);
        let found = report.violation.unwrap();
        assert_eq!(found.violation.guarantee, Guarantee::StaysOut);
        assert_eq!((found.run, found.plan), (3, plan));
    }
}
