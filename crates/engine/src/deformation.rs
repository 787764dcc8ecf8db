//! Matter that gives way, as the simulation sees it: which model, which materials, the job that
//! is out and what came back.
//!
//! Frame: scene, which is the patient's; segments that were moved do not give way.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, Sender};
use std::time::Duration;

use glam::{DMat3, DQuat, DVec3};
use palpate_deform::material::{MaterialLaw, Materials, Part, SegmentMatter, Treatment};
use palpate_deform::model::{
    DeformationModel, ModelAnswer, ModelEvent, ModelReport, ToolShape, ToolState,
};
use palpate_volume::edit::{Edit, SegmentId};
use palpate_volume::material::LocalContact;

use crate::deformation_loop::{DeformationJob, DeformationLoop, ModelVoxels};
use crate::handover::{GivingWay, ServoStatus};
use crate::scene::Scene;

/// How long the model may take for an answer, so that 30 come in a second.
const PATIENCE: Duration = Duration::from_millis(25);
/// Matter farther from the tool than this is not asked [mm].
const REACH: f64 = 30.0;

/// The deformation as the picture shows it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DeformationNow {
    /// Name of the model; none where nothing gives way.
    pub model: Option<&'static str>,
    /// Force on the tool [N].
    pub force: DVec3,
    /// Answers so far.
    pub answers: u64,
    /// Of these, answers in which particles slipped: there the force may jump.
    pub slips: u64,
    /// How the last one went.
    pub report: ModelReport,
}

/// What came of an answer.
#[derive(Debug, Default)]
pub struct Outcome {
    /// Voxels that moved.
    pub edit: Option<Edit>,
    /// What the servo is to follow.
    pub giving_way: Option<GivingWay>,
    /// What happened at once.
    pub events: Vec<ModelEvent>,
}

/// The model's other end.
#[derive(Debug)]
pub struct Deformation {
    jobs: Sender<DeformationJob>,
    answers: Receiver<ModelAnswer>,
    /// None where every answer is to take the same work.
    patience: Option<Duration>,
    model: Option<&'static str>,
    /// To be sent with the next job.
    new_model: Option<Box<dyn DeformationModel>>,
    laws: BTreeMap<SegmentId, MaterialLaw>,
    /// The edit number that the model knows of; none where it knows nothing.
    known: Option<u64>,
    reset: bool,
    asked: Option<Asked>,
    last_time: f64,
    now: DeformationNow,
    gave_way: bool,
}

/// The job that is out.
#[derive(Clone, Copy, Debug)]
struct Asked {
    segments: [u64; 4],
    tool: DVec3,
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
            laws: BTreeMap::new(),
            known: None,
            reset: false,
            asked: None,
            last_time: 0.0,
            now: DeformationNow::default(),
            gave_way: false,
        };
        (deformation, DeformationLoop::new(job_inbox, answers))
    }

    /// Puts a model in the place of the one before, or none: then all matter is hard.
    pub fn set_model(&mut self, model: Option<(&'static str, Box<dyn DeformationModel>)>) {
        (self.model, self.new_model) = model.unzip();
        self.known = None;
    }

    /// What a segment is made of; none where it is hard.
    pub fn set_law(&mut self, id: SegmentId, law: Option<MaterialLaw>) {
        match law {
            Some(law) => {
                self.laws.insert(id, law);
            }
            None => {
                self.laws.remove(&id);
            }
        }
        self.reset = true;
    }

    /// What a segment is made of; none where it is hard.
    #[must_use]
    pub fn law(&self, id: SegmentId) -> Option<MaterialLaw> {
        self.laws.get(&id).copied()
    }

    /// Displacements are forgotten: the voxels are those of another time.
    pub fn forget(&mut self) {
        self.reset = true;
        self.known = None;
    }

    /// What the picture shows of it.
    #[must_use]
    pub fn now(&self) -> DeformationNow {
        DeformationNow {
            model: self.model,
            ..self.now
        }
    }

    /// Takes an answer, if one has come, and asks again where matter gives way near the tool.
    pub fn exchange(&mut self, scene: &Scene, status: &ServoStatus) -> Outcome {
        let mut outcome = self.take_answer(scene);
        if self.asked.is_none() && outcome.edit.is_none() {
            self.ask(scene, status);
        }
        let nothing_gives =
            self.model.is_none() || (self.asked.is_none() && outcome.edit.is_none());
        if nothing_gives && self.gave_way {
            self.gave_way = false;
            self.now.force = DVec3::ZERO;
            outcome.giving_way = Some(GivingWay::default());
        }
        outcome
    }

    /// Tells that the edit of the last answer was applied.
    pub fn followed(&mut self, edit_number: u64) {
        self.known = Some(edit_number);
    }

    fn take_answer(&mut self, scene: &Scene) -> Outcome {
        let Ok(answer) = self.answers.try_recv() else {
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
        self.gave_way = true;
        // built from voxels that are others by now: the model looks again
        let is_current = scene.voxels().edit_number() == asked.edit;
        let edit = answer.edit.filter(|edit| is_current && !edit.is_empty());
        if edit.is_none() && !is_current {
            self.known = None;
        }
        Outcome {
            edit,
            giving_way: Some(GivingWay {
                segments: asked.segments,
                contact: Some(contact.unwrap_or_else(|| nothing_at(asked.tool))),
            }),
            events: answer.events,
        }
    }

    fn ask(&mut self, scene: &Scene, status: &ServoStatus) {
        let tool = status.tool;
        let segments = self.soft_segments(scene, tool);
        // before its first tick the servo has told of no place
        let is_known = status.time > 0.0 && tool.is_finite();
        if self.model.is_none() || segments == [0; 4] || !is_known {
            return;
        }
        let edit = scene.voxels().edit_number();
        let voxels = if self.known == Some(edit) {
            ModelVoxels::Followed
        } else {
            ModelVoxels::Anew(Box::new(scene.voxels().clone()))
        };
        let smallest = scene.voxels().grid().smallest_spacing();
        let job = DeformationJob {
            model: self.new_model.take(),
            reset: std::mem::take(&mut self.reset),
            voxels,
            materials: Arc::new(self.materials(scene)),
            tool: ToolState {
                id: 0,
                // what is smaller than the voxels would slip between them
                shape: ToolShape::Ball(status.radius.max(smallest)),
                position: tool,
                orientation: DQuat::IDENTITY,
            },
            dt: (status.time - self.last_time).max(0.0),
            patience: self.patience,
        };
        self.last_time = status.time;
        if self.jobs.send(job).is_ok() {
            self.known = Some(edit);
            self.asked = Some(Asked {
                segments,
                tool,
                edit,
            });
        }
    }

    /// Segments that give way near a place, one bit for each number.
    fn soft_segments(&self, scene: &Scene, tool: DVec3) -> [u64; 4] {
        let grid = scene.voxels().grid();
        let mut bits = [0; 4];
        for id in self.laws.keys() {
            let is_there = scene.is_obstacle(*id) && scene.properties_of(*id).pose.is_none();
            let bounds = scene.voxels().segment(*id).and_then(|s| s.bounding_box());
            let near = bounds.is_some_and(|bounds| {
                let point = grid.grid_from_patient().transform_point3(tool);
                let nearest = point.clamp(bounds.min.as_dvec3(), bounds.max.as_dvec3());
                ((nearest - point) * grid.spacing()).length() <= REACH
            });
            if is_there && near {
                bits[usize::from(id.0 / 64)] |= 1 << (id.0 % 64);
            }
        }
        bits
    }

    /// What all obstacles are made of: those without a material hold what is bonded to them.
    fn materials(&self, scene: &Scene) -> Materials {
        let unmoved = scene
            .obstacles()
            .filter(|(_, _, properties)| properties.pose.is_none());
        let mut segments: Vec<SegmentMatter> = unmoved
            .map(|(segment, _, _)| match self.laws.get(&segment) {
                Some(law) => SegmentMatter {
                    segment,
                    law: *law,
                    treatments: Vec::new(),
                },
                None => SegmentMatter {
                    segment,
                    law: hard(),
                    treatments: vec![(Part::Whole, Treatment::Rigid)],
                },
            })
            .collect();
        // where a voxel belongs to several the last counts: what is hard stays hard
        segments.sort_by_key(|matter| (!matter.treatments.is_empty(), matter.segment));
        Materials { segments }
    }
}

/// Of matter that does not give way, of which only that it is stiff counts.
fn hard() -> MaterialLaw {
    let bone = palpate_deform::material::preset("cortical-bone").and_then(|preset| preset.law());
    bone.expect("a preset of the list")
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
