//! The owner of the true voxels: takes changes, keeps the journal, tells the servo. What it does to
//! segments, objects and tools, its steps and what it tells stand in files of their own.
//!
//! Points in scene mm (LPS), boxes in voxels of the grid.

use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex};

use glam::{DAffine3, DMat3, DVec3, IVec3};
use palpate_deform::material::MaterialLaw;
use palpate_device::DeviceLimits;
use palpate_haptics::ball::BallError;
use palpate_tools::journal::JournalFile;
use palpate_tools::undo::UndoJournal;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::{Voxels, VoxelsError};

use crate::deformable::{Deformation, SharedRegionChanges, Unpressed};
use crate::error::SessionError;
use crate::notice::Notice;
use crate::picture::{PictureEnds, SceneUpdate, ShownDisplacements, SimulationStatus};
use crate::replay::TapeRecorder;
use crate::scene::{MaskFractions, Scene, SegmentVoxels, Step, TouchChange};
use crate::servo::{ServoCommand, SimulationChannels};
use crate::simulation::grip::Grip;
use crate::simulation::press::PressingHand;
use crate::simulation::tool_stroke::ToolStroke;
use crate::simulation::touch_sender::TouchSender;
use crate::touch::{
    NeedleWatch, PLACEMENT_REACH, Settings, ThresholdRange, TouchFeel, check_radius, free_point,
};

mod clip;
mod deformation;
mod displacements;
mod grip;
mod hand_end;
mod led_hand;
mod objects;
mod press;
mod probe_size;
mod publish;
mod recovery;
mod regions;
mod segments;
mod steps;
mod tool_stroke;
mod tools;
mod touch_rays;
mod touch_sender;

pub use grip::surface_voxels;
pub use hand_end::{Press, SharedHand};
pub use led_hand::{HandMove, HandStep, LedHand, Rays};
pub use recovery::{Kept, Recovered};
pub use touch_sender::touchable_of;

/// A segment as the session holds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SegmentState {
    /// Its number, 1 to 255.
    pub id: SegmentId,
    /// Solid voxels.
    pub voxels: u64,
    /// Their volume [mm³].
    pub volume: f64,
    /// A box of its grid that just holds them; none where there are none.
    pub bounds: Option<VoxelBox>,
    /// The grid of its own, where it does not stand on the scan's.
    pub own_grid: Option<Grid>,
    /// Whether it is an obstacle.
    pub touchable: bool,
    /// Whether touch does not follow its newest voxels yet.
    pub pending: bool,
    /// The threshold that it is; none where its voxels come from elsewhere.
    pub range: Option<ThresholdRange>,
    /// The threshold that made it, whatever edits did since.
    pub made_by: Option<ThresholdRange>,
    /// How its surface feels, as a person has set it; friction that is not set is that of `law`.
    pub feel: TouchFeel,
    /// What it is made of; none where it is hard.
    pub law: Option<MaterialLaw>,
    /// Where it was moved [mm, from the scan to the scene]; none where the scan has it.
    pub pose: Option<DAffine3>,
    /// Whether its voxels stay as they are.
    pub locked: bool,
}

/// What a simulation begins with.
#[derive(Debug)]
pub struct SimulationParts {
    /// Voxels and segments.
    pub scene: Scene,
    /// Soft tissue; its loop is somebody else's.
    pub deformation: Deformation,
    /// The occupancy fractions of masks; their loop is somebody else's.
    pub fractions: MaskFractions,
}

/// The state of the simulation thread.
#[derive(Debug)]
pub struct Simulation {
    scene: Scene,
    journal: UndoJournal<Step>,
    stroke: ToolStroke,
    needle: NeedleWatch,
    grip: Option<Grip>,
    /// The hand of a person, as far as it is led from here.
    pressing: Option<PressingHand>,
    /// The segment on a drag that has not ended.
    dragged: Option<SegmentId>,
    clutched: bool,
    deformation: Deformation,
    /// What of the voxels is no change, but pressed.
    unpressed: Unpressed,
    /// Whether what a stroke did ends as a step with the next answer, which takes cuts to where their
    /// tissue is at rest.
    closes_with_answer: bool,
    /// What was changed of segments that regions are shared with.
    shared_changes: SharedRegionChanges,
    /// As the picture was told it last.
    displacements: ShownDisplacements,
    /// Works out the occupancy fractions of masks.
    fractions: MaskFractions,
    file: Option<JournalFile>,
    touch: TouchSender,
    status: triple_buffer::Input<SimulationStatus>,
    notices: Sender<Notice>,
    updates: Sender<SceneUpdate>,
    /// Segments that the picture shows by their labels.
    labelled: Vec<SegmentId>,
    settings: Settings,
    limits: DeviceLimits,
    segments_version: u64,
    voxels_version: u64,
    refused_places: u64,
    was_held: bool,
    was_stopped: bool,
    was_full: bool,
}

impl Simulation {
    /// A simulation of this scene, whose device bears `limits`.
    #[must_use]
    pub fn new(
        parts: SimulationParts,
        settings: Settings,
        limits: DeviceLimits,
        channels: SimulationChannels,
        picture: PictureEnds,
    ) -> Self {
        let SimulationParts {
            scene,
            deformation,
            fractions,
        } = parts;
        let PictureEnds {
            status,
            notices,
            updates,
        } = picture;
        let mut simulation = Self {
            scene,
            journal: UndoJournal::default(),
            stroke: ToolStroke::default(),
            needle: NeedleWatch::default(),
            grip: None,
            pressing: None,
            dragged: None,
            clutched: false,
            deformation,
            unpressed: Unpressed::default(),
            closes_with_answer: false,
            shared_changes: SharedRegionChanges::default(),
            displacements: Vec::new(),
            fractions,
            file: None,
            touch: TouchSender::new(channels, settings.probe_radius),
            status,
            notices,
            updates,
            labelled: Vec::new(),
            settings: settings.within(&limits),
            limits,
            segments_version: 0,
            voxels_version: 0,
            refused_places: 0,
            was_held: false,
            was_stopped: false,
            was_full: false,
        };
        // nobody was told of any yet
        let masks = simulation.scene.obstacles().map(|(id, _, _)| id);
        let all = TouchChange::All(masks.collect());
        let _ = simulation.fractions.follow(&mut simulation.scene, &all);
        simulation
    }

    /// The true voxels.
    #[must_use]
    pub fn voxels(&self) -> &Voxels {
        self.scene.voxels()
    }

    /// The settings that hold.
    #[must_use]
    pub fn settings(&self) -> Settings {
        self.settings
    }

    /// The voxels without what tools press of soft tissue: those that are saved, and changed by people.
    #[must_use]
    pub fn voxels_at_rest(&self) -> &Voxels {
        self.unpressed.voxels(self.scene.voxels())
    }

    /// A box around all voxels that are pressed; empty where none is.
    #[must_use]
    pub fn moved(&self) -> VoxelBox {
        self.unpressed.moved()
    }

    /// The voxels of a segment with the threshold that made them.
    ///
    /// # Errors
    /// Where there is no such segment.
    pub fn voxels_of(&self, id: SegmentId) -> Result<SegmentVoxels, SessionError> {
        let voxels = self.scene.voxels_of(id);
        voxels.ok_or(VoxelsError::UnknownSegment(id.0).into())
    }

    /// All segments, by rising number.
    #[must_use]
    pub fn segments(&self) -> Vec<SegmentState> {
        self.scene
            .segments()
            .map(|(id, segment, properties)| SegmentState {
                id,
                voxels: segment.count(),
                volume: segment.count() as f64 * segment.grid(self.voxels().grid()).voxel_volume(),
                bounds: segment.bounding_box(),
                own_grid: segment.own_grid().copied(),
                touchable: properties.touchable,
                pending: self.touch.is_pending(id),
                range: properties.range,
                made_by: properties.made_by,
                feel: properties.feel,
                law: self.material(id),
                pose: properties.pose,
                locked: properties.locked,
            })
            .collect()
    }

    /// One pass: exchanges with the servo and publishes what is shown.
    pub fn step(&mut self) {
        self.touch.exchange(&self.scene);
        self.follow_probe_radius();
        self.advance_press();
        self.advance_grip();
        self.advance_tool();
        self.advance_needle();
        self.advance_deformation();
        self.advance_fractions();
        self.report_held_changes();
        self.report_refused_places();
        self.report_full_tape();
        self.report_journal();
        self.publish();
    }

    /// Takes fractions that were worked out, once touch follows what they were worked out from.
    fn advance_fractions(&mut self) {
        if self.touch.follows_all() {
            let fractions = self.fractions.advance(&mut self.scene);
            if !fractions.is_empty() {
                self.touch.send_fractions(&self.scene, &fractions);
            }
        }
    }

    /// Has touch follow a change of the scene.
    fn send_change(&mut self, change: &TouchChange) {
        // what is sent is made for the radius that fits the scene as it is now
        self.follow_probe_radius();
        if let Some(moved) = self.scene.follow_clip(change) {
            let cut = TouchChange::All(vec![moved]);
            self.touch.send_change(&self.scene, &cut, Vec::new());
        }
        let fractions = self.fractions.follow(&mut self.scene, change);
        self.touch.send_change(&self.scene, change, fractions);
    }

    /// Has occupancy fractions of masks worked out from now on, or not.
    pub fn switch_mask_fractions(&mut self, on: bool) {
        self.fractions.switch(on);
    }

    /// Regions of masks whose occupancy fractions are still to be worked out; 0 where all are
    /// known.
    #[must_use]
    pub fn unknown_fractions(&self) -> usize {
        self.fractions.left()
    }

    /// What is told to the servo, where it is recorded.
    #[must_use]
    pub fn tape(&self) -> Arc<Mutex<TapeRecorder>> {
        Arc::clone(self.touch.tape())
    }

    /// Begins to record what is told to the servo. Where a change waits for the probe, the
    /// recording can be replayed only from when it is followed.
    pub fn begin_tape(&mut self) {
        self.touch.begin_tape(&self.scene);
        if self.touch.is_held() {
            self.report(Notice::info(
                "A change waits for the probe to move out: the recording can be replayed from \
                 then on only.",
            ));
        }
    }

    /// Brings the probe to a point, or to the free voxel nearest to it, and the device with it
    /// where `device_too`; hand targets up to number `hand` are forgotten. Gives the point.
    ///
    /// # Errors
    /// Where no voxel near the point is free.
    pub fn place(
        &mut self,
        point: DVec3,
        hand: u64,
        device_too: bool,
    ) -> Result<DVec3, SessionError> {
        let free = self.place_free(point, hand, device_too)?;
        let moved = free.distance(point);
        // a voxel's length is what clicking on a surface misses by
        if moved > self.voxels().grid().spacing().length() {
            self.report(Notice::info(format!(
                "The point is inside a touchable segment: the probe was placed in the nearest \
                 free voxel, {moved:.1} mm away."
            )));
        }
        Ok(free)
    }

    /// The same, without a word about how far the point is.
    fn place_free(
        &mut self,
        point: DVec3,
        hand: u64,
        device_too: bool,
    ) -> Result<DVec3, SessionError> {
        // a jump is no stroke
        self.stroke.lift();
        self.pull_needle();
        let grid = *self.voxels().grid();
        let touchable = touchable_of(&self.scene, self.probe_radius());
        let free = free_point(&touchable.scene(&grid), point).ok_or(SessionError::NoFreeVoxel {
            point,
            reach: PLACEMENT_REACH,
        })?;
        self.touch.send(ServoCommand::Place {
            point: free,
            hand,
            device_too,
        });
        self.needle.jump(self.touch.commands());
        Ok(free)
    }

    /// Turns the axes in which the device moves the probe.
    pub fn turn(&mut self, rotation: DMat3) {
        self.touch.send(ServoCommand::Turn(rotation));
    }

    /// Has the device move without the probe, or with it again from where both are then.
    pub fn clutch(&mut self, on: bool) {
        if self.clutched != on {
            self.clutched = on;
            self.touch.send(ServoCommand::Clutch(on));
            self.publish();
        }
    }

    /// Takes new settings, as far as the device bears them; gives those that hold.
    ///
    /// # Errors
    /// Where one of them is out of range.
    pub fn set_settings(&mut self, settings: Settings) -> Result<Settings, SessionError> {
        settings.check()?;
        self.check_radius_everywhere(settings.probe_radius)?;
        self.settings = settings.within(&self.limits);
        if let Some(notice) = self.settings.notice_of_limits(&settings) {
            self.report(notice);
        }
        self.send_settings();
        Ok(self.settings)
    }

    /// Refuses a ball that is too large for the voxels of a segment, also of one that undo or redo
    /// would bring back.
    fn check_radius_everywhere(&self, radius: f64) -> Result<(), BallError> {
        check_radius(radius, self.voxels().grid())?;
        let there = self.voxels().segments().map(|(_, segment)| segment);
        let gone = self.journal.steps().flat_map(Step::segments);
        there
            .chain(gone)
            .filter_map(Segment::own_grid)
            .try_for_each(|grid| check_radius(radius, grid))
    }
}

/// The voxels of a grid from `low` up to, but without, `high`.
///
/// # Errors
/// Where there are none.
pub fn checked_box(low: IVec3, high: IVec3, grid: &Grid) -> Result<VoxelBox, SessionError> {
    let region = VoxelBox::new(low, high).intersect(&grid.bounds());
    if region.is_empty() {
        return Err(SessionError::Box {
            low,
            high,
            dimensions: grid.dimensions(),
        });
    }
    Ok(region)
}
