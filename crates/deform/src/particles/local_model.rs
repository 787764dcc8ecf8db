//! The thesis' two local models: particles in a box that moves with the tool.
//!
//! `fcc-lj`: four Lennard-Jones particles a voxel on an FCC lattice. `cuboid-lj`: one particle
//! a voxel under the thesis' cuboid law, which is not conservative and lives by its friction.
//! Both corrected as `docs/understand/particles.md` says. They move in scaled time, or come to
//! rest (FIRE), from where they were; the box's outer cells stand still.
//!
//! Frame: mm along the axes of the grid, from its corner. Source: thesis 5.8–5.25.

use glam::DVec3;

use super::calibration::{CUBOID_CUT, Calibration, FADE, LatticeKind, LatticeScale};
use super::local_state::LocalState;
use super::pair_laws::{CuboidLaw, FadedLaw, LaneLaw};
use super::tool_push::ParticleTool;
use crate::model::{DeformationModel, ModelAnswer, ModelEvent, ModelInput, ModelParts};

/// Half axis of a tool, at least: a thinner one would slip between particles [a].
const THINNEST: f64 = 0.5;

/// Layers at most.
pub const MOST_LAYERS: u32 = 8;

/// Method by which particles come to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// Velocity Verlet in scaled time (masses in proportion to D), with viscous friction as a
    /// share of B₀, the critical one of a link (5.61: B₀ = 4π m/T₀).
    ScaledTime {
        /// Δt/T₀ (5.48).
        step_share: f64,
        /// B/B₀. None takes what is critical for the slowest swing of the box; half of B₀
        /// at least for `cuboid-lj`.
        friction: Option<f64>,
    },
    /// FIRE. For conservative laws only: `cuboid-lj` takes scaled time instead.
    Rest,
}

impl Motion {
    /// The default motion.
    pub const SCALED_TIME: Self = Self::ScaledTime {
        step_share: 0.05,
        friction: None,
    };
}

/// What can be chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalSettings {
    /// Cells of the box along each axis; odd, 7 to 41.
    pub box_cells: i32,
    /// Outermost cells of the box that stand still: as many as the law reaches.
    pub border_cells: i32,
    /// Rule by which D follows from the material.
    pub calibration: Calibration,
    /// Method by which particles come to rest.
    pub motion: Motion,
    /// Springs to the initial positions, as a share of a link's stiffness (5.12). They make
    /// the material stiffer than asked; zero for none.
    pub binding: f64,
    /// Whether particles are kept out of empty voxels (5.13); free surfaces then never bulge.
    pub walls: bool,
    /// Parts of the work of a call: the cells near the tool first, those farther away frozen,
    /// then more of them (5.21). One for none.
    pub layers: u32,
    /// Whether what particles show stays where the tool has left them: they rearrange (5.28.3); else all of it
    /// comes back.
    pub rearranges: bool,
    /// What the scan reads where tissue left, in its own unit.
    pub air: f64,
}

impl Default for LocalSettings {
    fn default() -> Self {
        Self {
            box_cells: 13,
            border_cells: 2,
            calibration: Calibration::Young,
            motion: Motion::SCALED_TIME,
            binding: 0.0,
            walls: false,
            layers: 1,
            rearranges: false,
            air: -1000.0,
        }
    }
}

impl LocalSettings {
    /// The nearest settings that make sense.
    pub(super) fn sane(mut self) -> Self {
        self.box_cells = self.box_cells.clamp(7, 41) | 1;
        self.border_cells = self.border_cells.clamp(1, (self.box_cells - 3) / 2);
        self.layers = self.layers.clamp(1, MOST_LAYERS);
        // comparisons with NaN are false
        self.binding = if self.binding > 0.0 {
            self.binding.min(10.0)
        } else {
            0.0
        };
        if let Motion::ScaledTime {
            step_share,
            friction,
        } = &mut self.motion
        {
            *step_share = if *step_share > 0.0 {
                step_share.clamp(1e-4, 0.06)
            } else {
                0.05
            };
            *friction = friction
                .filter(|share| *share >= 0.0)
                .map(|share| share.min(100.0));
        }
        self
    }
}

/// A law on its lattice.
pub trait LocalLaw: LaneLaw + std::fmt::Debug + 'static {
    /// Where its particles stand.
    const KIND: LatticeKind;
    /// Whether its forces have a potential energy.
    const CONSERVATIVE: bool;
    /// The law for this lattice.
    fn on(scale: &LatticeScale) -> Self;
    /// Farthest distance of particles that act on one another [mm].
    fn reach(scale: &LatticeScale) -> f64;
}

impl LocalLaw for FadedLaw {
    const KIND: LatticeKind = LatticeKind::Fcc;
    const CONSERVATIVE: bool = true;

    fn on(scale: &LatticeScale) -> Self {
        scale.faded_law()
    }

    fn reach(scale: &LatticeScale) -> f64 {
        FADE[1] * scale.equilibrium
    }
}

impl LocalLaw for CuboidLaw {
    const KIND: LatticeKind = LatticeKind::Cuboid;
    const CONSERVATIVE: bool = false;

    fn on(scale: &LatticeScale) -> Self {
        scale.cuboid_law()
    }

    fn reach(scale: &LatticeScale) -> f64 {
        CUBOID_CUT * scale.equilibrium * 3.0_f64.sqrt()
    }
}

/// Particles in a box that moves with the first tool.
#[derive(Debug)]
pub struct LocalModel<L> {
    settings: LocalSettings,
    state: Option<LocalState<L>>,
    reported_poisson: bool,
}

impl LocalModel<FadedLaw> {
    /// The thesis' model on an FCC lattice.
    pub fn fcc_lj(settings: LocalSettings) -> Self {
        Self::new(settings)
    }
}

impl LocalModel<CuboidLaw> {
    /// The thesis' model of cuboid potential fields.
    pub fn cuboid_lj(settings: LocalSettings) -> Self {
        Self::new(settings)
    }
}

impl<L: LocalLaw> LocalModel<L> {
    fn new(settings: LocalSettings) -> Self {
        let mut settings = settings.sane();
        if !L::CONSERVATIVE && settings.motion == Motion::Rest {
            settings.motion = Motion::SCALED_TIME;
        }
        Self {
            settings,
            state: None,
            reported_poisson: false,
        }
    }

    /// The settings in use: those given, brought to what makes sense.
    pub fn settings(&self) -> &LocalSettings {
        &self.settings
    }

    /// Particles in the box.
    pub fn particle_count(&self) -> usize {
        self.state
            .as_ref()
            .map_or(0, |state| state.body.system.particles.len())
    }

    /// Where each particle is and how far it has moved from its initial position [mm, frame of
    /// the grid].
    pub fn particles(&self) -> impl Iterator<Item = (DVec3, DVec3)> {
        self.state.iter().flat_map(|state| state.body.places())
    }
}

impl<L: LocalLaw> DeformationModel for LocalModel<L> {
    fn advance(&mut self, input: &ModelInput<'_>) -> ModelAnswer {
        let grid = input.voxels.grid();
        if self
            .state
            .as_ref()
            .is_none_or(|state| state.body.grid != *grid)
        {
            self.state = Some(LocalState::new(&self.settings, grid));
        }
        let Some(state) = &mut self.state else {
            return ModelAnswer::default();
        };

        let mut tools = ParticleTool::usable(input.tools, grid);
        for (_, tool) in &mut tools {
            tool.widen(THINNEST * state.body.scale.equilibrium);
        }
        state.follow_edits(input);
        if let Some((_, tool)) = tools.first() {
            state.move_box(input, tool);
        }
        let relaxed = state.relax(&tools, &input.budget);
        let mut answer = ModelAnswer {
            contacts: state.body.contacts(input.tools, &tools, &relaxed.felt),
            report: relaxed.report,
            ..ModelAnswer::default()
        };
        if !state.is_sound() {
            state.forget();
            answer.contacts = state.body.contacts(input.tools, &[], &[]);
            answer.events.push(ModelEvent::Reset);
        }
        let unlike = state.body.report_poisson(&mut self.reported_poisson);
        answer.events.extend(unlike);
        answer.events.extend(state.slipped());
        answer.edit = state.write_back(input.voxels);
        state.note_rearranged(&relaxed.felt, answer.report.residual);
        answer.at_rest = Some(state.at_rest());
        answer.report.moved_voxels = state.moved_voxels();
        answer.report.plastic_voxels = state.plastic_voxels();
        answer.displacement = state.displacement(input.voxels);
        answer
    }

    fn parts(&self) -> ModelParts {
        let state = self.state.as_ref();
        state.map(|state| state.body.parts()).unwrap_or_default()
    }

    fn reset(&mut self) {
        if let Some(state) = &mut self.state {
            state.forget();
            state.settle_plastic();
        }
    }
}
