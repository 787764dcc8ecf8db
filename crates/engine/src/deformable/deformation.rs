//! Soft tissue, as the simulation sees it: which model, which materials, the job that
//! is out and what came back.
//!
//! Frame: scene, which is the patient's; segments that were moved are rigid.

mod needle;

use std::sync::mpsc::{self, Receiver, Sender};
use std::time::Duration;

use glam::{DMat3, DQuat, DVec3};
use palpate_deform::at_rest::AtRest;
use palpate_deform::model::{
    DeformationModel, DisplacementField, ModelEvent, ModelReport, ToolShape, ToolState,
};
use palpate_deform::registry::ModelOptions;
use palpate_haptics::soft_contact::STALE_SECS;
use palpate_volume::edit::Edit;
use palpate_volume::material::LocalContact;
use palpate_volume::segment_set::SegmentSet;

use crate::deformable::deformable_segments::{DeformableSegments, soft_segments};
use crate::deformable::deformation_loop::{
    DeformationAnswer, DeformationJob, DeformationLoop, ModelVoxels, MovedBy, Press,
};
use crate::scene::Scene;
use crate::servo::{DeformableContact, ServoStatus};

/// How long the model may take for an answer, so that 30 come in a second.
const PATIENCE: Duration = Duration::from_millis(25);
/// Between two questions where the first is answered between two passes of the simulation [s].
const SOONEST: f64 = 0.008;
/// Tissue farther from the tool than this is not asked [mm].
const REACH: f64 = 30.0;
/// A tool that has moved by no more than this is asked about where it was: else what the model errs by
/// goes around through tool and force, and a hand at rest feels it [smallest spacings].
const STILL: f64 = 0.01;
/// A law is followed over this at least, so that a hand that presses on before the next answer neither
/// comes to hard voxels nor falls into tissue that counts as air [radii of the tool].
const FOLLOWED: f64 = 1.0;

/// A model and the name that it goes by.
pub type NamedModel = (&'static str, Box<dyn DeformationModel>);

/// What a tool feels of soft tissue.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ForceSource {
    /// The model's own contact force.
    #[default]
    Matter,
    /// Its voxels, as hard as any, until the model has moved them away (thesis 5.23).
    Voxels,
}

/// The deformation as the picture shows it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DeformationStatus {
    /// Name of the model; none where nothing is deformable.
    pub model: Option<&'static str>,
    /// What of it is not as usual.
    pub options: ModelOptions,
    /// What the tool feels.
    pub source: ForceSource,
    /// Force of the tissue on the tool [N], felt or not.
    pub force: DVec3,
    /// Answers so far.
    pub answers: u64,
    /// Of these, answers in which particles slipped: there the force may jump.
    pub slips: u64,
    /// How the last one went.
    pub report: ModelReport,
    /// Whether the next one is late: until it comes, a hand that stays feels the last one, and one that
    /// goes elsewhere voxels that are hard.
    pub late: bool,
}

/// What came of an answer.
#[derive(Debug, Default)]
pub struct Outcome {
    /// Voxels that moved.
    pub edit: Option<Edit>,
    /// What all moved voxels are without a tool; none where that is not known, or as before.
    pub at_rest: Option<AtRest>,
    /// What the servo is to follow.
    pub deformable_contact: Option<DeformableContact>,
    /// Where tissue stands beside its voxels.
    pub displacement: Option<DisplacementField>,
    /// And the body behind what is pressed, which no voxel follows.
    pub behind: Option<DisplacementField>,
    /// What happened at once.
    pub events: Vec<ModelEvent>,
}

/// The model's other end.
#[derive(Debug)]
pub struct Deformation {
    jobs: Sender<DeformationJob>,
    answers: Receiver<DeformationAnswer>,
    /// None where every answer is to take the same work.
    patience: Option<Duration>,
    model: Option<&'static str>,
    /// To be sent with the next job.
    new_model: Option<Box<dyn DeformationModel>>,
    /// What takes the model's place once that has given back all that it moved.
    next: Option<Option<NamedModel>>,
    matter: DeformableSegments,
    /// The edit number that the model knows of; none where it knows nothing.
    known: Option<u64>,
    reset: bool,
    asked: Option<Asked>,
    /// Whether a needle's tissue is asked for, and whether it was seen moved last.
    needle_asked: bool,
    needle_seen: bool,
    /// Where the model had the tool last [mm].
    tool: Option<DVec3>,
    last_time: f64,
    now: DeformationStatus,
    was_deformable: bool,
}

/// The job that is out.
#[derive(Clone, Copy, Debug)]
struct Asked {
    segments: SegmentSet,
    tool: DVec3,
    radius: f64,
    edit: u64,
}

impl Deformation {
    /// Without a model, and the loop that answers it. `in_step`: every answer takes the same
    /// work, however long.
    #[must_use]
    pub fn new(in_step: bool) -> (Self, DeformationLoop) {
        let (jobs, job_inbox) = mpsc::channel();
        let (answers, answer_inbox) = mpsc::channel();
        let deformation = Self {
            jobs,
            answers: answer_inbox,
            patience: (!in_step).then_some(PATIENCE),
            model: None,
            new_model: None,
            next: None,
            matter: DeformableSegments::default(),
            known: None,
            reset: false,
            asked: None,
            needle_asked: false,
            needle_seen: false,
            tool: None,
            last_time: 0.0,
            now: DeformationStatus::default(),
            was_deformable: false,
        };
        (deformation, DeformationLoop::new(job_inbox, answers))
    }

    /// Puts a model in the place of the one before, or none: then all is rigid. What the
    /// one before has moved it gives back first.
    pub fn set_model(&mut self, model: Option<NamedModel>) {
        self.next = Some(model);
        self.reset = true;
        self.install_next();
    }

    /// The next model takes its place, once nothing is moved any more.
    fn install_next(&mut self) {
        let is_free = self.asked.is_none() && self.now.report.moved_voxels == 0;
        if !is_free && self.model.is_some() {
            return;
        }
        if let Some(next) = self.next.take() {
            (self.model, self.new_model) = next.unzip();
            self.now.report = ModelReport::default();
            self.known = None;
        }
    }

    /// How regions of segments take part.
    #[must_use]
    pub fn matter(&self) -> &DeformableSegments {
        &self.matter
    }

    /// How regions of segments take part, to be changed: displacements are forgotten.
    pub fn change_segments(&mut self) -> &mut DeformableSegments {
        self.forget_displacements();
        &mut self.matter
    }

    /// Chooses what the tool feels from the next answer on.
    pub fn set_force_source(&mut self, source: ForceSource) {
        self.now.source = source;
    }

    /// Displacements are forgotten: the tissue is another one.
    pub fn forget_displacements(&mut self) {
        self.reset = true;
    }

    /// Displacements are forgotten: the voxels are those of another time.
    pub fn forget(&mut self) {
        self.reset = true;
        self.known = None;
    }

    /// What the picture shows of it.
    #[must_use]
    pub fn now(&self) -> DeformationStatus {
        let next = self.next.as_ref();
        DeformationStatus {
            model: next.map_or(self.model, |next| next.as_ref().map(|(name, _)| *name)),
            ..self.now
        }
    }

    /// Takes an answer, if one has come. Its edit is to be applied, and told of by
    /// [`Self::followed`], before the next question.
    pub fn take(&mut self, scene: &Scene, status: &ServoStatus) -> Outcome {
        let outcome = self.take_answer(scene);
        self.matter.follow(scene);
        self.now.late = self.asked.is_some() && status.time - self.last_time > STALE_SECS;
        outcome
    }

    /// Asks again where soft tissue is near the tool; what the servo is to follow where nothing
    /// gives way any more.
    pub fn go_on(&mut self, scene: &Scene, status: &ServoStatus) -> Option<DeformableContact> {
        self.install_next();
        if self.asked.is_none() {
            self.ask(scene, status);
        }
        let is_rigid = self.model.is_none() || self.asked.is_none();
        if !(is_rigid && self.was_deformable) {
            return None;
        }
        self.was_deformable = false;
        self.now.force = DVec3::ZERO;
        Some(DeformableContact::default())
    }

    /// Whether it is time for the next question where an answer came early: a model that has
    /// nothing to do leaves its core to others.
    #[must_use]
    pub fn may_go_on(&self, status: &ServoStatus) -> bool {
        status.time - self.last_time >= SOONEST
    }

    /// Tells that the edit of the last answer was applied.
    pub fn followed(&mut self, edit_number: u64) {
        self.known = Some(edit_number);
    }

    /// Whether the model knows the voxels as of this edit number.
    #[must_use]
    pub fn knows(&self, edit_number: u64) -> bool {
        self.known == Some(edit_number)
    }

    fn take_answer(&mut self, scene: &Scene) -> Outcome {
        let Ok(DeformationAnswer::Model(answer)) = self.answers.try_recv() else {
            return Outcome::default();
        };
        let Some(asked) = self.asked.take() else {
            return Outcome::default();
        };
        let contact = answer.contacts.first().and_then(|tool| tool.contact);
        self.now.answers += 1;
        self.now.report = answer.report;
        let slipped = |event: &ModelEvent| matches!(event, ModelEvent::Slipped { .. });
        self.now.slips += u64::from(answer.events.iter().any(slipped));
        self.now.force = contact.map_or(DVec3::ZERO, |contact| contact.force);
        self.was_deformable = true;
        // built from voxels that are others by now: the model looks again
        let is_current = scene.voxels().edit_number() == asked.edit;
        let edit = answer.edit.filter(|edit| is_current && !edit.is_empty());
        if edit.is_none() && !is_current {
            self.known = None;
        }
        let deformable_contact = match self.now.source {
            ForceSource::Matter => DeformableContact {
                segments: asked.segments,
                contact: Some(contact.map_or_else(
                    || nothing_at(asked.tool),
                    |law| LocalContact {
                        validity: law.validity.max(FOLLOWED * asked.radius),
                        ..law
                    },
                )),
                stays: true,
            },
            ForceSource::Voxels => DeformableContact::default(),
        };
        Outcome {
            edit,
            at_rest: answer.at_rest.filter(|_| is_current),
            deformable_contact: Some(deformable_contact),
            displacement: answer.displacement,
            behind: answer.behind,
            events: answer.events,
        }
    }

    /// Where tissue meets the tool. What stands on its voxels alone would press nothing: as the
    /// thesis' probe pushes what is near it, it then reaches by a voxel to where the hand presses.
    fn tool(&self, status: &ServoStatus, voxel: f64) -> DVec3 {
        match self.now.source {
            ForceSource::Matter => status.tool,
            ForceSource::Voxels => {
                status.tool + (status.device - status.tool).clamp_length_max(voxel)
            }
        }
    }

    fn ask(&mut self, scene: &Scene, status: &ServoStatus) {
        let smallest = scene.voxels().grid().smallest_spacing();
        let now = self.tool(status, smallest);
        let is_still = |tool: &DVec3| tool.distance(now) <= STILL * smallest;
        let tool = self.tool.filter(is_still).unwrap_or(now);
        // what is smaller than the voxels would slip between them
        let radius = status.radius.max(smallest);
        let leaves = self.next.is_some();
        let segments = match leaves {
            true => SegmentSet::default(),
            false => soft_segments(scene, tool, REACH),
        };
        // what was moved comes back after the tool has left
        let is_needed = !segments.is_empty() || self.now.report.comes_back();
        // before its first tick the servo has told of no place
        let is_known = status.time > 0.0 && tool.is_finite();
        if self.model.is_none() || !is_needed || !is_known {
            return;
        }
        let press = Press {
            model: self.new_model.take(),
            reset: std::mem::take(&mut self.reset),
            tool: (!leaves).then_some(ToolState {
                id: 0,
                shape: ToolShape::Ball(radius),
                position: tool,
                orientation: DQuat::IDENTITY,
            }),
            dt: (status.time - self.last_time).max(0.0),
        };
        if self.send(scene, status, MovedBy::Tool(press)) {
            self.tool = Some(tool);
            self.asked = Some(Asked {
                segments,
                tool,
                radius,
                edit: scene.voxels().edit_number(),
            });
        }
    }

    /// Sends a job with the voxels and materials as they are; whether anybody is there to do it.
    fn send(&mut self, scene: &Scene, status: &ServoStatus, by: MovedBy) -> bool {
        let edit = scene.voxels().edit_number();
        let voxels = if self.known == Some(edit) {
            ModelVoxels::Followed
        } else {
            ModelVoxels::Anew(Box::new(scene.voxels().clone()))
        };
        let job = DeformationJob {
            voxels,
            materials: self.matter.materials(scene),
            patience: self.patience,
            by,
        };
        self.last_time = status.time;
        let is_sent = self.jobs.send(job).is_ok();
        if is_sent {
            self.known = Some(edit);
        }
        is_sent
    }
}

/// Nothing pushes the tool here.
fn nothing_at(tool: DVec3) -> LocalContact {
    LocalContact {
        position: tool,
        force: DVec3::ZERO,
        stiffness: DMat3::ZERO,
        validity: REACH,
    }
}
