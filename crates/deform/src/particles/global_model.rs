//! The thesis' prototype of a global model: coarse particles through whole segments.
//!
//! Particles as large as the count allows stand on an FCC lattice inside the segments, come to
//! rest once, and are then bound to where they rest by springs, since nothing else holds them.
//! Voxels follow the particles near them: each reads what stood where it came from (the
//! prototype moves voxels forward, which leaves holes between them; reading backward leaves
//! none). The lattice has the modulus that was asked for; the springs add to it, by an amount that
//! grows with the square of the size of what is pressed (docs/understand/particles.md).
//!
//! Frame: mm along the axes of the grid. Source: thesis 5.26.

use std::time::Instant;

use glam::DVec3;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;

use super::body::ParticleBody;
use super::calibration::{Calibration, LatticeKind, LatticeScale};
use super::global_field::{GlobalField, VISIBLE};
use super::global_sites::{extent, matter_around};
use super::lattices::FCC_BASIS;
use super::local_model::Motion;
use super::pair_laws::FadedLaw;
use super::tool_push::ParticleTool;
use super::voxel_following::{FollowRule, Following};
use crate::material::{Materials, Treatment};
use crate::model::{
    Budget, DeformationModel, ModelAnswer, ModelEvent, ModelInput, ModelParts, ModelReport,
    ToolContact, ToolState,
};
use crate::observed_voxels::ObservedVoxels;
use crate::voxel_ledger::{Ledger, Wanted, solid_of};

/// Steps in which particles come to rest before the first call is answered.
const SETTLING: u32 = 200;
/// Farthest displacement that is looked for [a].
const FARTHEST: f64 = 3.0;
/// Voxels that one answer gives back after a reset, at most.
const GIVEN_BACK: usize = 8192;
/// Share of the time after which particles are as far at rest as they come.
const RELAXED: f64 = 0.6;
/// Share of the time after which no other voxels follow: the rest is for what the picture is told.
const FOLLOWED: f64 = 0.8;
/// Half axis of a tool, at least: a thinner one would slip between particles [a].
const THINNEST: f64 = 0.5;

/// What can be chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlobalSettings {
    /// Particles at most, 100 to 100 000; their size follows.
    pub max_particles: u32,
    /// Rule by which D follows from the material.
    pub calibration: Calibration,
    /// Springs to where particles rest, as a share of a link's stiffness (5.12).
    pub binding: f64,
    /// Distance up to which a particle takes voxels along, d_a [a]; 0.5 to 2.
    pub owned_radius: f64,
    /// Displacement below which voxels stay [smallest voxel side].
    pub threshold: f64,
    /// What the scan reads where tissue left, in its own unit.
    pub air: f64,
}

impl Default for GlobalSettings {
    fn default() -> Self {
        Self {
            max_particles: 4000,
            calibration: Calibration::Young,
            binding: 0.3,
            owned_radius: 1.2,
            threshold: 0.5,
            air: -1000.0,
        }
    }
}

impl GlobalSettings {
    /// Stored value where tissue left.
    fn stored_air(&self, input: &ModelInput<'_>) -> i16 {
        let intensities = input.voxels.intensities();
        let air = (self.air - intensities.intercept()) / intensities.slope();
        air.round() as i16
    }

    /// The nearest settings that make sense; comparisons with NaN are false.
    fn sane(mut self) -> Self {
        let within = |value: f64, low: f64, high: f64, other: f64| {
            if value >= low { value.min(high) } else { other }
        };
        self.max_particles = self.max_particles.clamp(100, 100_000);
        self.binding = within(self.binding, 1e-3, 10.0, 1e-3);
        self.owned_radius = within(self.owned_radius, 0.5, 2.0, 0.5);
        self.threshold = within(self.threshold, 0.01, 10.0, 0.01);
        self
    }
}

/// Coarse particles through whole segments.
#[derive(Debug)]
pub struct GlobalModel {
    settings: GlobalSettings,
    state: Option<GlobalState>,
    /// What voxels were before it moved them; outlives a reset, so that it can give them back.
    ledger: Ledger,
    reported_poisson: bool,
}

#[derive(Debug)]
struct GlobalState {
    body: ParticleBody<FadedLaw>,
    following: Following,
    observed: ObservedVoxels,
}

impl GlobalModel {
    /// The thesis' prototype.
    pub fn global_lj(settings: GlobalSettings) -> Self {
        Self {
            settings: settings.sane(),
            state: None,
            ledger: Ledger::default(),
            reported_poisson: false,
        }
    }

    /// Where each particle is and how far it has moved [mm, frame of the grid].
    pub fn particles(&self) -> impl Iterator<Item = (DVec3, DVec3)> {
        self.state.iter().flat_map(|state| state.body.places())
    }
}

impl DeformationModel for GlobalModel {
    fn advance(&mut self, input: &ModelInput<'_>) -> ModelAnswer {
        let began = Instant::now();
        let grid = input.voxels.grid();
        self.state.take_if(|state| state.body.grid != *grid);
        // particles are made of tissue at rest
        if self.state.is_none() && self.ledger.len() > 0 {
            return self.give_back(input);
        }
        let state = self
            .state
            .get_or_insert_with(|| GlobalState::new(&self.settings, input));
        let ledger = &mut self.ledger;
        let mut tools = ParticleTool::usable(input.tools, grid);
        for (_, tool) in &mut tools {
            tool.widen(THINNEST * state.body.scale.equilibrium);
        }
        state.follow_edits(input.voxels, input.materials, ledger);
        // the rest of the time is for the voxels
        let budget = input.budget.until(began, RELAXED);
        let relaxed = state.body.relax(&tools, &budget, None);
        let mut answer = ModelAnswer {
            contacts: state.body.contacts(input.tools, &tools, &relaxed.felt),
            report: relaxed.report,
            ..ModelAnswer::default()
        };
        if !state.body.is_sound(FARTHEST * state.body.scale.equilibrium) {
            state.go_home();
            answer.contacts = state.body.contacts(input.tools, &[], &[]);
            answer.events.push(ModelEvent::Reset);
        }
        let unlike = state.body.report_poisson(&mut self.reported_poisson);
        answer.events.extend(unlike);
        let first = tools.first().map(|(_, tool)| tool.centre);
        let (field, middle) = GlobalField::of(&state.body, &self.settings, first);
        let effort = &mut answer.report.effort;
        effort.evaluations = u64::from(answer.report.iterations) + 1;
        let rule = FollowRule {
            input,
            budget: input.budget.until(began, FOLLOWED),
            field: field.as_ref(),
            middle,
            least: self.settings.threshold * state.body.grid.smallest_spacing(),
            air: self.settings.stored_air(input),
        };
        answer.edit = state.following.advance(&rule, ledger, effort);
        state.observed.note(ledger);
        answer.at_rest = Some(ledger.at_rest());
        answer.report.moved_voxels = ledger.len() as u32;
        let field = field.map(|field| field.on_nodes(middle));
        answer.displacement =
            field.and_then(|field| field.residual(input.voxels, ledger, VISIBLE * field.spacing));
        answer
    }

    fn parts(&self) -> ModelParts {
        let state = self.state.as_ref();
        state.map(|state| state.body.parts()).unwrap_or_default()
    }

    fn reset(&mut self) {
        self.state = None;
    }
}

impl GlobalModel {
    /// Voxels back to what they are at rest, before anything else, as many as an answer has the
    /// time for.
    fn give_back(&mut self, input: &ModelInput<'_>) -> ModelAnswer {
        let voxels = input.voxels;
        let mut wanted = Wanted::new();
        self.ledger.take_overruled(voxels);
        self.ledger
            .give_back_outside(voxels, &VoxelBox::EMPTY, &mut wanted);
        if let Some(first_left) = wanted.keys().nth(GIVEN_BACK).copied() {
            wanted.split_off(&first_left);
        }
        let edit = self.ledger.write(voxels, &wanted);
        let none = |tool: &ToolState| ToolContact {
            tool: tool.id,
            contact: None,
        };
        ModelAnswer {
            edit,
            at_rest: Some(self.ledger.at_rest()),
            contacts: input.tools.iter().map(none).collect(),
            report: ModelReport {
                moved_voxels: self.ledger.len() as u32,
                ..ModelReport::default()
            },
            ..ModelAnswer::default()
        }
    }
}

impl GlobalState {
    /// Fills all segments that take part and lets the particles come to rest (5.26, step 1).
    fn new(settings: &GlobalSettings, input: &ModelInput<'_>) -> Self {
        let grid = input.voxels.grid();
        let (region, count) = extent(input);
        let volume = count as f64 * grid.voxel_volume();
        let side = (4.0 * volume / f64::from(settings.max_particles)).cbrt();
        let scale = LatticeScale::new(LatticeKind::Fcc, side.max(grid.smallest_spacing()));
        let length = (region.size().as_dvec3() * grid.spacing()).max_element();
        let most = settings.max_particles as usize;
        let body = ParticleBody::new(grid, scale, most, Motion::SCALED_TIME);
        let length = length.max(scale.cell).min(20.0 * scale.cell);
        let mut state = Self {
            body: body.bound(0.0, length),
            following: Following::default(),
            observed: ObservedVoxels::now(input.voxels),
        };
        state.fill(settings, input, &region);
        state.body.relax(&[], &Budget::iterations(SETTLING), None);
        // where they rest is home, and springs hold them there
        state.body.settle();
        state.body = state.body.bound(settings.binding, length);
        state
    }

    /// Takes particles for all places of the lattice with enough tissue around.
    fn fill(&mut self, settings: &GlobalSettings, input: &ModelInput<'_>, region: &VoxelBox) {
        let (grid, scale) = (self.body.grid, self.body.scale);
        let spacing = grid.spacing();
        let first = (region.min.as_dvec3() * spacing / scale.cell)
            .floor()
            .as_ivec3();
        let last = (region.max.as_dvec3() * spacing / scale.cell)
            .ceil()
            .as_ivec3();
        for cell in VoxelBox::new(first, last).voxels() {
            for place in FCC_BASIS {
                let home = scale.cell * (cell.as_dvec3() + place);
                let Some((origin, solid, treatment)) =
                    matter_around(input, &grid, home, 0.5 * scale.equilibrium)
                else {
                    continue;
                };
                let depth = self.body.depth(&solid, treatment, settings.calibration);
                let mass = self.body.inertia(depth);
                let particles = &mut self.body.system.particles;
                particles.take(home, depth, mass, origin);
                if treatment == Treatment::Rigid {
                    particles.free.pop();
                    particles.free.push(DVec3::ZERO);
                }
            }
        }
    }

    /// Puts all particles back to where they rest.
    fn go_home(&mut self) {
        let particles = &mut self.body.system.particles;
        for (site, home) in particles.sites.iter_mut().zip(&particles.homes) {
            site.set_position(*home);
        }
        particles.velocities.fill(DVec3::ZERO);
    }

    /// Gives back particles whose own voxel somebody else has emptied.
    fn follow_edits(&mut self, voxels: &Voxels, materials: &Materials, ledger: &mut Ledger) {
        let observed = std::mem::replace(&mut self.observed, ObservedVoxels::now(voxels));
        if observed.is_followed(voxels) {
            return;
        }
        self.following.forget();
        ledger.take_overruled(voxels);
        let origins = &self.body.system.particles.origins;
        let mut gone = Vec::with_capacity(origins.len());
        for origin in origins {
            let rest = ledger.rest(voxels, origin.voxel);
            let solid = rest.and_then(|rest| solid_of(voxels, materials, origin.voxel, &rest));
            gone.push(solid.is_none());
        }
        self.body.system.particles.give_back(|_, index| gone[index]);
    }
}
