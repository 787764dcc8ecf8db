//! The loop of the deformation model, and of the tissue around a needle, at its own pace: one job, one
//! answer.
//!
//! The model works on voxels of its own, which share their bricks with the true ones: they are
//! sent anew only where something else than the model changed the true ones.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

use palpate_deform::lattice::{NeedleDrag, NeedleInput, NeedleTissue};
use palpate_deform::material::Materials;
use palpate_deform::model::{
    Budget, DeformationModel, DisplacementField, ModelAnswer, ModelInput, ToolState,
};
use palpate_volume::edit::Edit;
use palpate_volume::voxels::Voxels;

use crate::deformable::box_pace::BoxPace;
use crate::deformable::deformable_view::{DeformableView, ShownParts};

/// What the model is to look at.
#[derive(Debug)]
pub enum ModelVoxels {
    /// The true voxels as they are now.
    Anew(Box<Voxels>),
    /// As the last answer left them; its edit was applied, if there was one.
    Followed,
}

/// Something to work out.
#[derive(Debug)]
pub struct DeformationJob {
    /// What is solid.
    pub voxels: ModelVoxels,
    /// What it is made of.
    pub materials: Arc<Materials>,
    /// How long the answer may take; without it, it is always the same work.
    pub patience: Option<Duration>,
    /// By what tissue is moved.
    pub by: MovedBy,
}

/// By what tissue is moved.
#[derive(Debug)]
pub enum MovedBy {
    /// A tool, in the model.
    Tool(Press),
    /// A needle, for the eye alone; none where its tissue is to come back.
    Needle(Option<NeedleDrag>),
}

/// What a model is asked.
#[derive(Debug)]
pub struct Press {
    /// A model in the place of the one before.
    pub model: Option<Box<dyn DeformationModel>>,
    /// Whether displacements are forgotten.
    pub reset: bool,
    /// Where the tool is; none where tissue is to come back.
    pub tool: Option<ToolState>,
    /// Since the last job [s].
    pub dt: f64,
}

/// What came of a job.
#[derive(Debug)]
pub enum DeformationAnswer {
    /// What the model says.
    Model(Box<ModelAnswer>),
    /// Where tissue is seen around a needle; none where its voxels are.
    Needle(Option<DisplacementField>),
}

/// Jobs on one side, answers on the other.
#[derive(Debug)]
pub struct DeformationLoop {
    jobs: Receiver<DeformationJob>,
    answers: Sender<DeformationAnswer>,
    needle: NeedleTissue,
    model: Option<Box<dyn DeformationModel>>,
    voxels: Option<Box<Voxels>>,
    /// Of the last answer; the next job tells whether the true voxels took it.
    edit: Option<Edit>,
    /// Where the model's parts are put, where anybody looks.
    view: Arc<DeformableView>,
    /// For one answer, at most.
    iterations: u32,
    pace: BoxPace,
    wake_up: WakeUp,
}

/// Rung after each answer, for whoever waits for it.
pub struct WakeUp(Box<dyn Fn() + Send>);

impl WakeUp {
    /// This is done.
    #[must_use]
    pub fn new(notify: impl Fn() + Send + 'static) -> Self {
        Self(Box::new(notify))
    }
}

impl std::fmt::Debug for WakeUp {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        to.write_str("Bell")
    }
}

/// Iterations for one answer, at most: what a step of a quarter of a node takes to the last
/// hundredth of the force, twice over.
const ITERATIONS: u32 = 80;

impl DeformationLoop {
    /// A loop without a model.
    #[must_use]
    pub fn new(jobs: Receiver<DeformationJob>, answers: Sender<DeformationAnswer>) -> Self {
        Self {
            jobs,
            answers,
            needle: NeedleTissue::default(),
            model: None,
            voxels: None,
            edit: None,
            view: Arc::default(),
            iterations: ITERATIONS,
            pace: BoxPace::default(),
            wake_up: WakeUp::new(|| {}),
        }
    }

    /// Calls this after each answer from now on.
    pub fn set_wake_up(&mut self, wake_up: WakeUp) {
        self.wake_up = wake_up;
    }

    /// Where the parts of the model are shown.
    #[must_use]
    pub fn view(&self) -> Arc<DeformableView> {
        Arc::clone(&self.view)
    }

    /// So many iterations for one answer from now on.
    pub fn set_iterations(&mut self, iterations: u32) {
        self.iterations = iterations;
    }

    /// Does what is asked for, if anything is.
    pub fn step(&mut self) {
        if let Ok(job) = self.jobs.try_recv() {
            self.answer(job);
        }
    }

    /// Waits for a job, at most so long, and does it; false once none will come any more.
    pub fn wait(&mut self, patience: Duration) -> bool {
        match self.jobs.recv_timeout(patience) {
            Ok(job) => self.answer(job),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return false,
        }
        true
    }

    fn answer(&mut self, job: DeformationJob) {
        let began = Instant::now();
        self.follow_voxels(job.voxels);
        let budget = Budget {
            iterations: self.iterations,
            deadline: job.patience.map(|patience| began + patience),
            // who has all the time has the box that was chosen
            edge: job.patience.and(self.pace.edge()),
        };
        let answer = match job.by {
            MovedBy::Tool(press) => self.press(press, &job.materials, budget),
            MovedBy::Needle(drag) => self.voxels.as_deref().map(|voxels| {
                DeformationAnswer::Needle(self.needle.advance(&NeedleInput {
                    voxels,
                    materials: &job.materials,
                    drag,
                    budget,
                }))
            }),
        };
        let Some(answer) = answer else {
            return;
        };
        let is_of_model = matches!(answer, DeformationAnswer::Model(_));
        if let DeformationAnswer::Model(answer) = &answer {
            let is_pressed = answer.contacts.iter().any(|tool| tool.contact.is_some());
            self.pace
                .note(began.elapsed(), answer.report.iterations, is_pressed);
        }
        // whoever asked may have gone
        let _ = self.answers.send(answer);
        (self.wake_up.0)();
        if let Some(model) = self.model.as_ref().filter(|_| is_of_model)
            && self.view.is_wanted()
        {
            self.view.put(ShownParts::of(&model.parts()));
        }
    }

    fn follow_voxels(&mut self, voxels: ModelVoxels) {
        let edit = self.edit.take();
        match voxels {
            ModelVoxels::Anew(voxels) => self.voxels = Some(voxels),
            ModelVoxels::Followed => {
                if let (Some(voxels), Some(edit)) = (&mut self.voxels, edit) {
                    // it was built from these voxels
                    let _ = voxels.apply(edit);
                }
            }
        }
    }

    /// The answer of the model; none where there is none.
    fn press(
        &mut self,
        press: Press,
        materials: &Materials,
        budget: Budget,
    ) -> Option<DeformationAnswer> {
        if let Some(model) = press.model {
            self.model = Some(model);
            self.pace = BoxPace::default();
        }
        let (model, voxels) = (self.model.as_mut()?, self.voxels.as_ref()?);
        if press.reset {
            model.reset();
        }
        let answer = model.advance(&ModelInput {
            voxels,
            materials,
            tools: press.tool.as_slice(),
            dt: press.dt,
            budget,
        });
        self.edit.clone_from(&answer.edit);
        Some(DeformationAnswer::Model(Box::new(answer)))
    }
}
