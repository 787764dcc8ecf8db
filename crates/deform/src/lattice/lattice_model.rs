//! The bonded lattice as a model: a box of nodes that follows the first tool.

use std::cell::Cell;

use glam::{DVec3, IVec3};
use palpate_volume::voxel_box::VoxelBox;

use super::damage::Damage;
use super::measured_stiffness::{measured, told_before};
use super::moduli::POISSON_RANGE;
use super::moving_box::MovingBox;
use super::nodes::Lattice;
use super::relax::{RelaxSettings, Relaxer};
use super::resample::RestVoxels;
use super::settings::LatticeSettings;
use super::told_force::told_force;
use super::tool_contact::LatticeTool;
use super::tool_way::on_the_way;
use super::whole_body::{WholeBody, Work};
use super::write_back::WriteBack;
use crate::model::{
    DeformationModel, ModelAnswer, ModelEvent, ModelInput, ModelParts, ModelReport, ToolContact,
    ToolState,
};
use crate::observed_voxels::ObservedVoxels;
use crate::voxel_ledger::{Ledger, Wanted};
use crate::work_time::WorkTime;

/// Unbalanced force from which on nodes count as at rest, in parts of the tolerance.
pub(super) const AT_REST: f64 = 10.0;
/// Unbalanced force from which on a tool's tissue yields, as a share of the tools' force: a little too
/// far is mended by what yields next.
const NEARLY_AT_REST: f64 = 0.2;
/// Relaxations in one call at most, where bonds break.
const ROUNDS: u32 = 4;
/// Unbalanced force from which on a tool goes on along its way, and evaluations for each step of it at most; all
/// steps have no more than this share of all evaluations.
const FOLLOWS: f64 = 0.2;
const STEP_WORK: u32 = 12;
const WAY_SHARE: u32 = 2;
/// Displacement that is seen [spacings].
const VISIBLE: f64 = 0.01;
/// One in so many iterations is spent on the stiffness of the contact.
const STIFFNESS_SHARE: u32 = 4;
/// Shares of the time after which nodes are as far at rest as they come, with the tools and, where tissue
/// yielded, without, and the contact as stiff as it is found; what is left is for the voxels.
const RELAXED: f64 = 0.65;
const EASED: f64 = 0.75;
const STIFFNESS_FOUND: f64 = 0.88;
/// Evaluations of the whole segment's forces in one answer: least and most, less those of the box.
const WHOLE_WORK: [u32; 2] = [8, 40];

/// The bonded lattice as a model.
#[derive(Debug, Default)]
pub struct LatticeModel {
    pub(super) settings: LatticeSettings,
    pub(super) matter: Option<MovingBox>,
    /// The segment behind the box; none where nothing goes on behind it, or where it is not asked for.
    whole: Option<WholeBody>,
    pub(super) relaxer: Relaxer,
    /// Direction in which the first tool presses, along the axes of the grid; none where it feels nothing.
    pub(super) pressed: Option<DVec3>,
    /// Finds where tissue stays that has yielded.
    pub(super) unloaded: Relaxer,
    pub(super) damage: Damage,
    pub(super) ledger: Ledger,
    /// What voxels are to be that the box has left, until they are.
    pub(super) left_behind: Wanted,
    observed: Option<ObservedVoxels>,
    bonds_broken: u64,
    work_broken: f64,
    /// Whether tissue was still yielding or breaking at the end of the last relaxation.
    pub(super) yields: bool,
    reported_poisson: bool,
    /// Whether what yielded was seen without a tool, and nothing was pressed or cut since.
    pub(super) settled: bool,
    /// Where the tools have come, and their contacts as told in the last answer and when tissue was last at rest.
    tools: Vec<ToolState>,
    reported: Vec<ToolContact>,
    rested: Vec<ToolContact>,
}

impl LatticeModel {
    /// With settings of its own.
    ///
    /// # Panics
    /// Where the box has no middle node or an absurd size, or the spacing is no length.
    #[must_use]
    pub fn new(settings: LatticeSettings) -> Self {
        let nodes = settings.nodes;
        assert!(
            nodes % 2 == 1 && (5..=101).contains(&nodes),
            "a box of {nodes} nodes"
        );
        let spacing = settings.spacing.unwrap_or(1.0);
        assert!(spacing > 0.0 && spacing.is_finite(), "spacing {spacing} mm");
        Self {
            settings,
            ..Self::default()
        }
    }

    /// The box as it stands; none before the first tool.
    #[must_use]
    pub fn lattice(&self) -> Option<&Lattice> {
        self.matter.as_ref().map(|matter| &matter.lattice)
    }

    /// Has the border of the box give as the whole segment does.
    fn follow_whole(&mut self, input: &ModelInput<'_>, time: &WorkTime, answer: &ModelReport) {
        let known = self.whole.take();
        if !self.settings.whole {
            return;
        }
        let Some(mut matter) = self.matter.take() else {
            return;
        };
        let rest = self.rest_voxels(input, 0);
        let tool = input.tools.iter().find(|tool| tool.is_usable());
        let place = tool.and_then(|tool| matter.tissue_near(&matter.tool(tool)));
        let place = place.filter(|_| matter.lattice.goes_on());
        let mut whole = match place {
            Some(place) => WholeBody::of(known, &rest, &matter, place),
            None => known,
        };
        if place.is_none() {
            whole.iter_mut().for_each(WholeBody::let_go);
        }
        if let Some((whole, place)) = whole.as_mut().zip(place) {
            let felt = self.relaxer.felt().iter().map(|felt| felt.force);
            let [least, most] = WHOLE_WORK;
            let work = Work {
                iterations: most.saturating_sub(answer.iterations).max(least),
                is_late: &|| time.is_over(EASED),
            };
            whole.follow(&rest, &mut matter, (place, -felt.sum::<DVec3>()), &work);
        }
        self.whole = whole;
        self.matter = Some(matter);
    }

    /// Nodes of the whole segment behind the box: where they rest and where they stand now, and how far
    /// they are from one another.
    #[must_use]
    pub fn whole_parts(&self) -> ModelParts {
        let (Some(whole), Some(matter)) = (&self.whole, &self.matter) else {
            return ModelParts::default();
        };
        let patient = |place: DVec3| matter.patient_place(place - matter.corner());
        let places = whole
            .nodes()
            .map(|[rest, moved]| [patient(rest), patient(rest + moved)]);
        ModelParts {
            places: places.collect(),
            apart: whole.spacing(),
        }
    }

    pub(super) fn rest_voxels<'a>(&'a self, input: &ModelInput<'a>, asked: u64) -> RestVoxels<'a> {
        RestVoxels {
            voxels: input.voxels,
            materials: input.materials,
            ledger: &self.ledger,
            asked: Cell::new(asked),
        }
    }

    pub(super) fn rule<'a>(
        &'a self,
        input: &'a ModelInput<'_>,
        tools: &'a [&ToolState],
    ) -> WriteBack<'a> {
        let intensities = input.voxels.intensities();
        let air = (self.settings.air - intensities.intercept()) / intensities.slope();
        WriteBack {
            input,
            ledger: &self.ledger,
            tools,
            air: air.round() as i16,
        }
    }

    /// Follows what others have changed of the voxels. Tissue that moved and was cut where it
    /// stands is gone where it is at rest too.
    pub(super) fn follow_edits(&mut self, input: &ModelInput<'_>) -> u64 {
        let voxels = input.voxels;
        let observed = self.observed.replace(ObservedVoxels::now(voxels));
        if observed.is_some_and(|observed| observed.explains(voxels)) {
            return 0;
        }
        self.settled = false;
        if let Some(whole) = &mut self.whole {
            whole.stale = true;
        }
        match observed {
            Some(_) => self.ledger.follow_cuts(voxels),
            // after a reset voxels are those of another time, and nobody cut what they showed
            None => drop(self.ledger.take_overruled(voxels)),
        }
        let rest = RestVoxels {
            voxels,
            materials: input.materials,
            ledger: &self.ledger,
            asked: Cell::new(0),
        };
        if let Some(matter) = self.matter.as_mut().filter(|matter| matter.fits(&rest)) {
            matter.follow_edits(&rest);
        }
        rest.asked.get()
    }

    /// The edit by which voxels follow the nodes, and what they do not show of it.
    fn write_back(
        &mut self,
        input: &ModelInput<'_>,
        tools: &[&ToolState],
        answer: &mut ModelAnswer,
    ) {
        let voxels = input.voxels;
        let region = self.matter.as_ref();
        let region = region.map_or(VoxelBox::EMPTY, |matter| matter.region_from(matter.origin));
        self.left_behind.retain(|key, (matter, _)| {
            let voxel = IVec3::from_array(*key);
            !region.contains(voxel) && voxels.state(voxel) != Some(*matter)
        });
        let field = self.matter.as_ref().map(MovingBox::displacement);
        // where nothing was pressed since, what lasts is as it was to the voxel
        let followed = field.as_ref().filter(|_| !self.settled);
        let (mut wanted, looked_at) = self.rule(input, tools).wanted(followed);
        wanted.extend(&self.left_behind);
        answer.report.effort.looked_at = looked_at;
        answer.edit = self.ledger.write(voxels, &wanted);
        if self.is_unloaded(&answer.report) {
            self.ledger.note_plastic(&region);
            self.settled = true;
        }
        if let Some(observed) = &mut self.observed {
            observed.note(&self.ledger);
        }
        if let Some(field) = field {
            let least = VISIBLE * field.spacing;
            answer.displacement = field.residual(voxels, &self.ledger, least);
            let whole = self.whole.as_ref().zip(self.matter.as_ref());
            answer.behind = whole.and_then(|(whole, matter)| whole.seen(matter, least));
        }
        answer.at_rest = Some(self.ledger.at_rest());
        answer.report.moved_voxels = self.ledger.len() as u32;
        answer.report.plastic_voxels = self.ledger.plastic_len() as u32;
    }

    /// Has nodes follow the tools along their way since the last answer, as far as they come; gives where the
    /// tools are then. Tools that press on go a step at least, and wait for nodes that do not keep up.
    fn go_along(
        &mut self,
        input: &ModelInput<'_>,
        time: &WorkTime,
        tools: &[&ToolState],
        answer: &mut ModelAnswer,
    ) -> Vec<ToolState> {
        let way = on_the_way(&self.tools, tools);
        let there = tools.iter().map(|tool| **tool).collect();
        let Some(matter) = &mut self.matter else {
            return there;
        };
        let from_patient = matter.grid.direction().transpose();
        let mut ways = self.tools.iter().zip(tools).zip(self.relaxer.felt());
        let leaves = ways.any(|((from, to), felt)| {
            (from_patient * (to.position - from.position)).dot(felt.force) > 0.0
        });
        let most = input.budget.iterations / WAY_SHARE;
        for step in way {
            let tools: Vec<_> = step.iter().map(|tool| matter.tool(tool)).collect();
            let settings = RelaxSettings {
                tolerance: FOLLOWS,
                iterations: STEP_WORK.min(most.saturating_sub(answer.report.iterations)),
                reference: matter.small_force(),
            };
            let is_late = || time.is_over(RELAXED);
            let report = self
                .relaxer
                .relax(&mut matter.lattice, &tools, &settings, &is_late);
            answer.report.iterations += report.iterations;
            if report.residual > FOLLOWS && !leaves {
                return step;
            }
        }
        there
    }

    /// Relaxes, breaks, and relaxes again, within the budget.
    fn relax(
        &mut self,
        input: &ModelInput<'_>,
        time: &WorkTime,
        tools: &[LatticeTool],
        answer: &mut ModelAnswer,
    ) {
        let Some(matter) = &mut self.matter else {
            return;
        };
        matter.inelastic.fade(&mut matter.lattice, input.dt);
        let reference = matter.small_force();
        for _ in 0..ROUNDS {
            // the rest of them is for the stiffness
            let most = input.budget.iterations - input.budget.iterations / STIFFNESS_SHARE;
            let left = most.saturating_sub(answer.report.iterations);
            if left == 0 {
                return;
            }
            let settings = RelaxSettings {
                tolerance: self.settings.tolerance,
                iterations: left,
                reference,
            };
            let is_late = || time.is_over(RELAXED);
            let report = self
                .relaxer
                .relax(&mut matter.lattice, tools, &settings, &is_late);
            answer.report.iterations += report.iterations;
            answer.report.residual = report.residual;
            // what is not at rest yet may swing too far, and must not break for that
            let at_rest = report.residual <= AT_REST * self.settings.tolerance;
            let is_pressed = self.relaxer.felt().iter().any(|felt| felt.nodes > 0);
            self.settled &= !is_pressed;
            let yields = is_pressed && report.residual <= NEARLY_AT_REST;
            let breaking = matter.break_and_yield(at_rest, yields);
            self.yields = breaking.is_felt(matter.lattice.spacing());
            if !self.yields {
                return;
            }
            if breaking.count == 0 {
                continue;
            }
            self.bonds_broken += u64::from(breaking.count);
            self.work_broken += breaking.work;
            answer.events.push(ModelEvent::BondsBroken {
                count: breaking.count,
                work: breaking.work,
                place: matter.patient_place(breaking.place),
            });
        }
    }

    /// What each tool feels, one contact for each, usable or not.
    fn report_contacts(
        &mut self,
        input: &ModelInput<'_>,
        time: &WorkTime,
        usable: &[&ToolState],
        answer: &mut ModelAnswer,
    ) {
        let none = |tool: &ToolState| ToolContact {
            tool: tool.id,
            contact: None,
        };
        answer.contacts = input.tools.iter().map(none).collect();
        let Some(matter) = self.matter.as_mut() else {
            return;
        };
        if self.relaxer.felt().len() != usable.len() {
            return;
        }
        let tools: Vec<_> = usable.iter().map(|tool| matter.tool(tool)).collect();
        for (which, tool) in usable.iter().enumerate() {
            let felt = self.relaxer.felt()[which];
            if felt.nodes == 0 || !felt.force.is_finite() {
                continue;
            }
            let most = (input.budget.iterations / STIFFNESS_SHARE).max(4);
            let is_late = || time.is_over(STIFFNESS_FOUND);
            let stiffness =
                self.relaxer
                    .stiffness(&mut matter.lattice, &tools, which, most, &is_late);
            let force = matter.grid.direction() * felt.force;
            let spacing = matter.lattice.spacing();
            let told = |contacts: &[ToolContact]| {
                let own = contacts.iter().find(|own| own.tool == tool.id);
                own.and_then(|own| own.contact)
            };
            let last = told(&self.reported);
            let settling = answer.report.settling;
            let since = told(&self.rested).filter(|_| !settling).or(last);
            // far from rest none may be found at all
            let stiffness = match stiffness > 0.0 {
                true => measured(since, tool, force, spacing).of(stiffness, !settling),
                false => told_before(last),
            };
            let force = told_force(last, tool, force, answer.report.residual);
            let own = answer.contacts.iter_mut().find(|own| own.tool == tool.id);
            if let Some(own) = own {
                own.contact = matter.contact(tool, force, stiffness);
            }
        }
        if !answer.report.settling {
            self.rested.clone_from(&answer.contacts);
        }
        self.reported.clone_from(&answer.contacts);
    }

    /// Says once where Poisson's ratio is not the one that was asked for.
    fn report_poisson(&mut self, answer: &mut ModelAnswer) {
        let Some(matter) = self.matter.as_ref().filter(|_| !self.reported_poisson) else {
            return;
        };
        let [low, high] = POISSON_RANGE;
        let lattice = &matter.lattice;
        let asked = lattice
            .matter_nodes()
            .filter_map(|node| lattice.matter(node).solid());
        let outside = asked
            .map(|solid| solid.poisson)
            .find(|poisson| !(low..=high).contains(poisson));
        if let Some(asked) = outside {
            let used = asked.clamp(low, high);
            answer
                .events
                .push(ModelEvent::PoissonClamped { asked, used });
            self.reported_poisson = true;
        }
    }
}

impl DeformationModel for LatticeModel {
    fn advance(&mut self, input: &ModelInput<'_>) -> ModelAnswer {
        let time = WorkTime::begin(&input.budget);
        let mut answer = ModelAnswer::default();
        let usable: Vec<&ToolState> = input.tools.iter().filter(|t| t.is_usable()).collect();
        answer.report.effort.sampled = self.follow(input, &usable);
        // a box that went on needs all its time to come to rest
        let time = time.anew();
        self.report_poisson(&mut answer);
        let reached = self.go_along(input, &time, &usable, &mut answer);
        let is_behind = usable.iter().zip(&reached).any(|(tool, own)| *tool != own);
        self.tools.clone_from(&reached);
        let usable: Vec<_> = reached.iter().collect();
        if let Some(matter) = &self.matter {
            let tools: Vec<_> = usable.iter().map(|tool| matter.tool(tool)).collect();
            self.relax(input, &time, &tools, &mut answer);
            self.note_pressed(&answer.report);
        }
        self.follow_whole(input, &time, &answer.report);
        let is_late = || time.is_over(EASED);
        self.follow_plastic(input, &is_late, &answer.report);
        if self
            .matter
            .as_ref()
            .is_some_and(|matter| !matter.is_finite())
        {
            self.matter = None;
            answer.events.push(ModelEvent::Reset);
        }
        answer.report.settling =
            self.yields || is_behind || answer.report.residual > AT_REST * self.settings.tolerance;
        let edge = self.matter.as_ref().map(MovingBox::edge);
        answer.report.small_box = edge.is_some_and(|edge| edge < self.settings.nodes);
        answer.report.bonds_broken = self.bonds_broken;
        answer.report.work_broken = self.work_broken;
        self.report_contacts(input, &time, &usable, &mut answer);
        let effort = &mut answer.report.effort;
        effort.evaluations = std::mem::take(&mut self.relaxer.evaluations)
            + std::mem::take(&mut self.unloaded.evaluations);
        if let Some(matter) = &mut self.matter {
            answer.report.nodes = matter.lattice.matter_nodes().count() as u32;
            let built = std::mem::take(&mut matter.lattice.effort);
            effort.built = built.built;
            effort.evaluations += built.evaluations;
        }
        self.write_back(input, &usable, &mut answer);
        answer
    }

    fn parts(&self) -> ModelParts {
        self.matter
            .as_ref()
            .map(MovingBox::parts)
            .unwrap_or_default()
    }

    fn reset(&mut self) {
        self.matter = None;
        self.whole = None;
        self.pressed = None;
        self.damage = Damage::default();
        self.left_behind.clear();
        self.ledger.settle_plastic();
        self.observed = None;
        self.tools.clear();
        self.reported.clear();
        self.rested.clear();
    }
}
