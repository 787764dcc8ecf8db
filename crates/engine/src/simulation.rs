//! The owner of the true voxels: takes changes, keeps the journal, tells the servo.
//!
//! Points in scene mm (LPS), boxes in voxels of the grid.

use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex};

use glam::{DAffine3, DMat3, DVec3, IVec3};
use palpate_device::DeviceLimits;
use palpate_haptics::ball::{BallError, BallShape};
use palpate_haptics::scene::{MAX_OBJECTS, ObjectPose};
use palpate_tools::journal_entry::Action;
use palpate_tools::journal_file::JournalFile;
use palpate_tools::undo::UndoJournal;
use palpate_volume::edit::{Edit, SegmentId};
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::{Voxels, VoxelsError};

use crate::deformation::Deformation;
use crate::error::SessionError;
use crate::feel::Feel;
use crate::frame::Notice;
use crate::grip::Grip;
use crate::handover::{ServoCommand, SimulationChannels};
use crate::kept_surface::{SegmentVoxels, SurfaceMaking};
use crate::moved_poses::CurrentPoses;
use crate::needle::NeedleWatch;
use crate::placement::{REACH, free_point};
use crate::scene::{Properties, Scene, Step, ThresholdRange};
use crate::scene_news::SceneNews;
use crate::settings::Settings;
use crate::tape::{MAX_TAPE_BYTES, TapeRecorder};
use crate::tool_stroke::{ToolNow, ToolStroke};
use crate::touch_sender::{TouchSender, touchable_of};

mod deformation;
mod objects;
pub mod recovery;
mod tools;

/// What the picture shows of the simulation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SimulationStatus {
    /// Number of the newest edit.
    pub edit: u64,
    /// The segment that the probe touches; 0 where there is none.
    pub touched: u8,
    /// Radius that the probe has [mm]: less than the settings', where there is no room for it.
    pub probe_radius: f64,
    /// Where moved segments stand by now.
    pub poses: CurrentPoses,
    /// The segment that follows the probe; 0 where none does.
    pub grabbed: u8,
    /// Whether the device moves without the probe.
    pub clutched: bool,
    /// The middle of the device's workspace in the scene [mm].
    pub device_origin: DVec3,
    /// Changes that touch does not follow yet.
    pub pending: usize,
    /// Whether there is a change to take back.
    pub can_undo: bool,
    /// Whether there is an undone change to do again.
    pub can_redo: bool,
    /// Rises with each change of a segment's voxels or of the list of segments.
    pub segments_version: u64,
    /// Rises with each change of voxels that the picture is not told box by box.
    pub voxels_version: u64,
    /// The tool in the hand.
    pub tool: ToolNow,
    /// Bytes that undo and redo hold on to.
    pub undo_bytes: usize,
    /// How many they may.
    pub undo_budget: usize,
}

/// A segment as the session holds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SegmentState {
    /// Its number, 1 to 255.
    pub id: SegmentId,
    /// Solid voxels.
    pub voxels: u64,
    /// A box that just holds them; none where there are none.
    pub bounds: Option<VoxelBox>,
    /// Whether it is an obstacle.
    pub touchable: bool,
    /// Whether touch does not follow its newest voxels yet.
    pub pending: bool,
    /// The threshold that it is; none where its voxels come from elsewhere.
    pub range: Option<ThresholdRange>,
    /// The threshold that made it, whatever edits did since.
    pub made_by: Option<ThresholdRange>,
    /// How its surface feels.
    pub feel: Feel,
    /// Where it was moved [mm, from the scan to the scene]; none where the scan has it.
    pub pose: Option<DAffine3>,
}

/// Where the simulation tells what is shown: its status, sentences, and changes of voxels.
pub type PictureEnds = (
    triple_buffer::Input<SimulationStatus>,
    Sender<Notice>,
    Sender<SceneNews>,
);

/// The state of the simulation thread.
#[derive(Debug)]
pub struct Simulation {
    scene: Scene,
    journal: UndoJournal<Step>,
    stroke: ToolStroke,
    needle: NeedleWatch,
    grip: Option<Grip>,
    clutched: bool,
    deformation: Deformation,
    file: Option<JournalFile>,
    touch: TouchSender,
    status: triple_buffer::Input<SimulationStatus>,
    notices: Sender<Notice>,
    news: Sender<SceneNews>,
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
        (scene, deformation): (Scene, Deformation),
        settings: Settings,
        limits: DeviceLimits,
        channels: SimulationChannels,
        (status, notices, news): PictureEnds,
    ) -> Self {
        Self {
            scene,
            journal: UndoJournal::default(),
            stroke: ToolStroke::default(),
            needle: NeedleWatch::default(),
            grip: None,
            clutched: false,
            deformation,
            file: None,
            touch: TouchSender::new(channels, settings.probe_radius),
            status,
            notices,
            news,
            labelled: Vec::new(),
            settings: settings.within(&limits),
            limits,
            segments_version: 0,
            voxels_version: 0,
            refused_places: 0,
            was_held: false,
            was_stopped: false,
            was_full: false,
        }
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

    /// All segments, by rising number.
    #[must_use]
    pub fn segments(&self) -> Vec<SegmentState> {
        self.scene
            .segments()
            .map(|(id, segment, properties)| SegmentState {
                id,
                voxels: segment.count(),
                bounds: segment.bounding_box(),
                touchable: properties.touchable,
                pending: self.touch.is_pending(id),
                range: properties.range,
                made_by: properties.made_by,
                feel: properties.feel,
                pose: properties.pose,
            })
            .collect()
    }

    /// One pass: exchanges with the servo and publishes what is shown.
    pub fn step(&mut self) {
        self.touch.exchange(&self.scene);
        self.advance_grip();
        self.advance_tool();
        self.advance_needle();
        self.advance_deformation();
        self.tell_of_held_changes();
        self.tell_of_refused_places();
        self.tell_of_full_tape();
        self.tell_of_journal();
        self.publish();
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
            self.tell(Notice::info(
                "A change waits for the probe to move out: the recording can be replayed from \
                 then on only.",
            ));
        }
    }

    /// Adds a segment; an undoable one is taken away again by undo.
    ///
    /// # Errors
    /// Where it belongs to another grid, or there are 255, or it has a pose that
    /// [`Self::move_segment`] would refuse.
    pub fn add_segment(
        &mut self,
        segment: Segment,
        properties: Properties,
        undoable: bool,
    ) -> Result<SegmentId, SessionError> {
        self.close_step();
        if let Some(pose) = properties.pose {
            self.check_pose(pose)?;
            self.check_room_for_moved()?;
        }
        let id = self.free_id()?;
        let step = Step::Insert {
            id,
            segment,
            properties,
        };
        let action = if undoable { Action::Do } else { Action::Start };
        let inverse = self.perform(step, action)?;
        if undoable {
            self.done(inverse);
        }
        self.publish();
        Ok(id)
    }

    /// Gives a segment other voxels.
    ///
    /// # Errors
    /// Where there is no such segment, or the voxels belong to another grid.
    pub fn replace_segment(
        &mut self,
        id: SegmentId,
        segment: Segment,
        range: Option<ThresholdRange>,
    ) -> Result<(), SessionError> {
        self.change(Step::Replace {
            id,
            segment,
            range,
            made_by: range,
        })
    }

    /// Removes a segment.
    ///
    /// # Errors
    /// Where there is no such segment.
    pub fn remove_segment(&mut self, id: SegmentId) -> Result<(), SessionError> {
        self.let_go();
        self.change(Step::Remove { id })
    }

    /// Makes a segment an obstacle, or no obstacle. This changes no voxel and is not undone.
    ///
    /// # Errors
    /// Where there is no such segment.
    pub fn set_touchable(&mut self, id: SegmentId, touchable: bool) -> Result<(), SessionError> {
        if self.scene.set_touchable(id, touchable)? {
            let change = crate::scene::TouchChange::All(vec![id]);
            self.touch.send_change(&self.scene, &change);
            self.publish();
        }
        Ok(())
    }

    /// Changes how the surface of a segment feels. This changes no voxel and is not undone.
    ///
    /// # Errors
    /// Where a value is out of range, or there is no such segment.
    pub fn set_feel(&mut self, id: SegmentId, feel: Feel) -> Result<(), SessionError> {
        feel.check()?;
        self.scene.set_feel(id, feel)?;
        self.segments_version += 1;
        self.touch.send(ServoCommand::Feel(id, feel));
        self.publish();
        Ok(())
    }

    /// Shows a segment as a surface, or as none; this changes no voxel and is not undone.
    ///
    /// # Errors
    /// Where the settings make no surface, or there is no such segment.
    pub fn show_surface(
        &mut self,
        id: SegmentId,
        making: Option<SurfaceMaking>,
    ) -> Result<(), SessionError> {
        if let Some(making) = &making {
            making.settings.check()?;
        }
        let voxels = self.voxels_of(id)?;
        let shown = making.map(|making| (making, voxels));
        self.tell_picture(SceneNews::Show(id, shown));
        Ok(())
    }

    /// The voxels of a segment with the threshold that made them.
    ///
    /// # Errors
    /// Where there is no such segment.
    pub fn voxels_of(&self, id: SegmentId) -> Result<SegmentVoxels, SessionError> {
        let voxels = self.scene.voxels_of(id);
        voxels.ok_or(VoxelsError::UnknownSegment(id.0).into())
    }

    /// Names the segments that the picture shows by their labels: edits tell of these.
    pub fn set_labelled(&mut self, labelled: Vec<SegmentId>) {
        self.labelled = labelled;
    }

    /// Moves a segment; touch goes there smoothly. Moves of one segment after the other count
    /// as one for undo.
    ///
    /// # Errors
    /// Where the pose is no rigid motion, there is no such segment, or too many are moved.
    pub fn move_segment(&mut self, id: SegmentId, pose: DAffine3) -> Result<(), SessionError> {
        self.check_pose(pose)?;
        self.let_go();
        let before = self.scene.properties_of(id).pose;
        if before.is_none_or(|before| before == DAffine3::IDENTITY) {
            self.check_room_for_moved()?;
        }
        self.close_step();
        let goes_on = self.journal.newest().and_then(Step::moves) == Some(id);
        let inverse = self.perform(Step::Move { id, pose }, Action::Do)?;
        if !goes_on || self.journal.can_redo() {
            self.done(inverse);
        }
        self.publish();
        Ok(())
    }

    /// Makes all voxels of a box solid or free in one segment, and in that one only.
    ///
    /// # Errors
    /// Where there is no such segment.
    pub fn fill_box(
        &mut self,
        id: SegmentId,
        region: &VoxelBox,
        solid: bool,
    ) -> Result<(), SessionError> {
        let edit = self.voxels().label_edit(id, region, |_, _| solid)?;
        self.apply(edit)
    }

    /// Applies a label edit that was built from the present voxels.
    ///
    /// # Errors
    /// Where it does not fit.
    pub fn apply(&mut self, edit: Edit) -> Result<(), SessionError> {
        // what is as wanted already leaves nothing to take back
        if edit.is_empty() {
            return Ok(());
        }
        self.change(Step::of_edit(edit))
    }

    /// Takes the newest change back; false where there is none.
    ///
    /// # Errors
    /// Never, unless the journal is wrong.
    pub fn undo(&mut self) -> Result<bool, SessionError> {
        self.let_go();
        self.close_step();
        self.deformation.forget();
        let Some(step) = self.journal.pop_undo() else {
            return Ok(false);
        };
        let inverse = self.perform(step, Action::Undo)?;
        let bytes = inverse.bytes();
        self.journal.undone(inverse, bytes);
        self.publish();
        Ok(true)
    }

    /// Does the last undone change again; false where there is none.
    ///
    /// # Errors
    /// Never, unless the journal is wrong.
    pub fn redo(&mut self) -> Result<bool, SessionError> {
        self.let_go();
        self.close_step();
        self.deformation.forget();
        let Some(step) = self.journal.pop_redo() else {
            return Ok(false);
        };
        let inverse = self.perform(step, Action::Redo)?;
        let bytes = inverse.bytes();
        self.journal.redone(inverse, bytes);
        self.publish();
        Ok(true)
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
        // a jump is no stroke
        self.stroke.lift();
        self.pull_needle();
        let grid = *self.voxels().grid();
        let touchable = touchable_of(&self.scene, self.settings.probe_radius);
        let free = free_point(&touchable.scene(&grid), point).ok_or(SessionError::NoFreeVoxel {
            point,
            reach: REACH,
        })?;
        let moved = free.distance(point);
        // a voxel's length is what clicking on a surface misses by
        if moved > grid.spacing().length() {
            self.tell(Notice::info(format!(
                "The point is inside a touchable segment: the probe was placed in the nearest \
                 free voxel, {moved:.1} mm away."
            )));
        }
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
        check_radius(settings.probe_radius, self.voxels().grid())?;
        self.settings = settings.within(&self.limits);
        if let Some(notice) = self.settings.notice_of_limits(&settings) {
            self.tell(notice);
        }
        self.touch.set_radius(self.settings.probe_radius);
        self.touch.send(ServoCommand::Settings(self.settings));
        Ok(self.settings)
    }

    fn change(&mut self, step: Step) -> Result<(), SessionError> {
        self.close_step();
        let inverse = self.perform(step, Action::Do)?;
        self.done(inverse);
        self.publish();
        Ok(())
    }

    fn perform(&mut self, step: Step, action: Action) -> Result<Step, SessionError> {
        let (inverse, change) = self.scene.perform(step)?;
        self.touch.send_change(&self.scene, &change);
        self.segments_version += 1;
        for news in SceneNews::of(&inverse, &self.scene, &self.labelled) {
            self.voxels_version += u64::from(news.needs_labels());
            self.tell_picture(news);
        }
        self.write_down(action, &inverse);
        Ok(inverse)
    }

    fn check_pose(&self, pose: DAffine3) -> Result<(), SessionError> {
        let grid = self.voxels().grid();
        ObjectPose::new(grid, grid, pose)?;
        Ok(())
    }

    /// Refuses one moved segment more than can be touched. Undo and redo need no such question:
    /// where they lead there were no more.
    fn check_room_for_moved(&self) -> Result<(), SessionError> {
        if self.scene.moved_count() >= MAX_OBJECTS {
            return Err(SessionError::TooManyMoved);
        }
        Ok(())
    }

    /// Notes the inverse of a whole step.
    fn done(&mut self, inverse: Step) {
        let bytes = inverse.bytes();
        self.journal.done(inverse, bytes);
        if let Some(file) = &mut self.file {
            file.end_step();
        }
    }

    /// The lowest number that no segment has and no undo or redo would bring back.
    fn free_id(&self) -> Result<SegmentId, VoxelsError> {
        let returns = |id: SegmentId| self.journal.steps().any(|step| step.needs(id));
        let is_new = |id: &SegmentId| self.voxels().segment(*id).is_none();
        let ids = || (1..=u8::MAX).map(SegmentId).filter(is_new);
        ids()
            .find(|id| !returns(*id))
            .ok_or(VoxelsError::TooManySegments)
    }

    fn tell_of_held_changes(&mut self) {
        let held = self.touch.is_held();
        if held && !self.was_held {
            self.tell(Notice::warning(
                "A change waits: what it makes solid surrounds the probe. Move the probe out, or \
                 undo the change.",
            ));
        }
        self.was_held = held;

        let stopped = self.touch.is_stopped();
        if stopped && !self.was_stopped {
            self.tell(Notice::warning(
                "A segment stops on its way: it would pinch the probe. It goes on once the probe \
                 is out.",
            ));
        }
        self.was_stopped = stopped;
    }

    fn tell_of_refused_places(&mut self) {
        let refused = self.touch.status().refused_places;
        if refused > self.refused_places {
            self.tell(Notice::warning(
                "The probe stays where it is: there is no free voxel near the point.",
            ));
        }
        self.refused_places = refused;
    }

    fn tell_of_full_tape(&mut self) {
        let full = self.touch.is_tape_full();
        if full && !self.was_full {
            self.tell(Notice::warning(format!(
                "The recording has no room for more changes (limit: {} MB): what comes after \
                 this one cannot be replayed.",
                MAX_TAPE_BYTES >> 20
            )));
        }
        self.was_full = full;
    }

    fn publish(&mut self) {
        let status = SimulationStatus {
            edit: self.voxels().edit_number(),
            touched: self.touch.status().touched,
            probe_radius: self.touch.status().radius,
            poses: self.current_poses(),
            grabbed: self.grip.as_ref().map_or(0, |grip| grip.id().0),
            clutched: self.clutched,
            device_origin: self.touch.status().origin,
            pending: self.touch.pending(),
            can_undo: self.journal.can_undo() || self.stroke.has_changed(),
            can_redo: self.journal.can_redo(),
            segments_version: self.segments_version,
            voxels_version: self.voxels_version,
            tool: self.stroke.now(),
            undo_bytes: self.journal.bytes(),
            undo_budget: self.journal.budget(),
        };
        self.status.write(status);
    }

    fn tell_picture(&self, news: SceneNews) {
        // without a picture nobody draws any more
        let _ = self.news.send(news);
    }

    fn tell(&self, notice: Notice) {
        // without a picture nobody reads notices any more
        let _ = self.notices.send(notice);
    }
}

/// Refuses a ball that is too large for the voxels of a grid.
///
/// # Errors
/// [`BallError`] says what fits.
pub fn check_radius(radius: f64, grid: &Grid) -> Result<(), BallError> {
    if radius > 0.0 {
        BallShape::new(radius, grid.spacing())?;
    }
    Ok(())
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
