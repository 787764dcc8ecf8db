//! Sends changes of what can be touched to the servo and knows which of them it follows.
//!
//! A small edit goes brick by brick, a large one and every bulk change as a new root. Each
//! change has a number; the servo tells which numbers it has taken and which it holds back.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use glam::DAffine3;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::edit::SegmentId;

use crate::replay::TapeRecorder;
use crate::scene::{Scene, TouchChange};
use crate::servo::{ServoCommand, ServoStatus, SimulationChannels};
use crate::touch::{
    BrickChange, CurrentPoses, FractionSwap, Garbage, MAX_BRICKS, MAX_FRACTIONS, NeedleStatus,
    Part, Touchable,
};

/// A change that touch does not follow yet.
#[derive(Debug)]
struct Outstanding {
    sequence: u64,
    segments: Vec<SegmentId>,
}

/// The simulation's end of the way to the servo.
#[derive(Debug)]
pub struct TouchSender {
    inbox: rtrb::Producer<ServoCommand>,
    garbage: rtrb::Consumer<Garbage>,
    replies: triple_buffer::Output<ServoStatus>,
    poses: triple_buffer::Output<CurrentPoses>,
    needle: triple_buffer::Output<NeedleStatus>,
    tape: Arc<Mutex<TapeRecorder>>,
    /// Of the probe, as it is wanted [mm].
    radius: f64,
    backlog: VecDeque<ServoCommand>,
    /// Commands so far, those in the backlog too.
    commands: u64,
    sequence: u64,
    outstanding: Vec<Outstanding>,
    status: ServoStatus,
    skipped: u64,
}

impl TouchSender {
    /// A way on which nothing was sent yet, for a probe of a radius [mm].
    #[must_use]
    pub fn new(channels: SimulationChannels, radius: f64) -> Self {
        let SimulationChannels {
            inbox,
            garbage,
            status,
            poses,
            needle,
            snapshots,
        } = channels;
        Self {
            inbox,
            garbage,
            replies: status,
            poses,
            needle,
            tape: Arc::new(Mutex::new(TapeRecorder::new(snapshots))),
            radius,
            backlog: VecDeque::new(),
            commands: 0,
            sequence: 0,
            outstanding: Vec::new(),
            status: ServoStatus::default(),
            skipped: 0,
        }
    }

    /// What the servo last said.
    #[must_use]
    pub fn status(&self) -> &ServoStatus {
        &self.status
    }

    /// Commands sent so far.
    #[must_use]
    pub fn commands(&self) -> u64 {
        self.commands
    }

    /// Where moved segments stand by now, as the servo last said.
    #[must_use]
    pub fn poses(&self) -> &CurrentPoses {
        self.poses.output_buffer()
    }

    /// The needle by now, as the servo last said.
    #[must_use]
    pub fn needle(&self) -> &NeedleStatus {
        self.needle.output_buffer()
    }

    /// Number of changes that touch does not follow yet, moves that the probe stops among them.
    #[must_use]
    pub fn pending(&self) -> usize {
        self.outstanding.len() + self.status.stopped.len()
    }

    /// Whether the servo holds a change back, since the probe is in its way.
    #[must_use]
    pub fn is_held(&self) -> bool {
        self.outstanding.iter().any(|change| self.holds(change))
    }

    /// Whether a change of this segment is among the pending ones.
    #[must_use]
    pub fn is_pending(&self, id: SegmentId) -> bool {
        let is_stopped = self.status.stopped.contains(id);
        let mut outstanding = self.outstanding.iter();
        is_stopped || outstanding.any(|change| change.segments.contains(&id))
    }

    /// Whether the probe keeps a moved segment from where it is to go.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        !self.status.stopped.is_empty()
    }

    /// What is told to the servo, where it is recorded.
    #[must_use]
    pub fn tape(&self) -> &Arc<Mutex<TapeRecorder>> {
        &self.tape
    }

    /// Begins to record what is told to the servo, as soon as it follows all that it was told.
    pub fn begin_tape(&mut self, scene: &Scene) {
        self.lock_tape().want();
        self.exchange(scene);
    }

    /// Whether the recording is full.
    #[must_use]
    pub fn is_tape_full(&self) -> bool {
        self.lock_tape().is_full()
    }

    /// The radius that the probe is to have [mm].
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Tells the radius that the probe is to have [mm], which must have been checked; roots are
    /// made for it. The servo comes there by itself.
    pub fn set_radius(&mut self, radius: f64) {
        self.radius = radius;
    }

    /// Sends a change of the scene, with the fractions that changed by it.
    pub fn send_change(
        &mut self,
        scene: &Scene,
        change: &TouchChange,
        fractions: Vec<FractionSwap>,
    ) {
        match change {
            TouchChange::Nothing => {}
            TouchChange::Bricks(bricks, segments)
                if bricks.len() <= MAX_BRICKS && fractions.len() <= MAX_BRICKS =>
            {
                self.send_bricks(scene, bricks, segments.clone(), fractions);
            }
            TouchChange::Bricks(_, segments) => self.send_root(scene, segments.clone()),
            TouchChange::All(segments) => self.send_root(scene, segments.clone()),
            TouchChange::Pose(id, pose) => self.send(ServoCommand::Pose(*id, *pose)),
            TouchChange::FirstPose(id, pose) => {
                self.send_split(scene, *id);
                self.send(ServoCommand::Pose(*id, *pose));
            }
        }
    }

    /// Sends a command that changes no occupancy.
    pub fn send(&mut self, mut command: ServoCommand) {
        self.commands += 1;
        self.lock_tape().note(&command);
        if let ServoCommand::Root { touchable, .. } = &mut command {
            touchable.forget_fractions_of_parts();
        }
        self.backlog.push_back(command);
        self.flush();
    }

    /// Frees what the servo gave back, sends what waits and reads what it follows by now.
    pub fn exchange(&mut self, scene: &Scene) {
        while let Ok(garbage) = self.garbage.pop() {
            drop(garbage);
        }
        self.flush();
        self.status = *self.replies.read();
        self.poses.update();
        self.needle.update();
        let status = self.status;
        if status.skipped > self.skipped {
            self.skipped = status.skipped;
            let segments = scene.segments().map(|(id, _, _)| id).collect();
            self.send_root(scene, segments);
        }
        self.outstanding
            .retain(|change| change.sequence > status.received || is_held(&status, change));
        self.exchange_tape(scene);
    }

    /// Takes the state that a recording begins with, and asks for it where nothing is pending.
    fn exchange_tape(&mut self, scene: &Scene) {
        let mut tape = self.lock_tape();
        tape.collect();
        if !tape.is_wanted() || !self.outstanding.is_empty() {
            return;
        }
        // the tape must wait for the mark before the servo can answer it
        let scan = (*scene.voxels().grid(), scene.values().clone());
        let parts = scene.touchable_parts();
        tape.begin(self.commands + 1, scan, parts);
        drop(tape);
        self.commands += 1;
        self.backlog.push_back(ServoCommand::Mark);
        self.flush();
    }

    fn lock_tape(&self) -> MutexGuard<'_, TapeRecorder> {
        // a tape is whole even where a thread failed while it held the lock
        self.tape.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn send_bricks(
        &mut self,
        scene: &Scene,
        bricks: &[u32],
        segments: Vec<SegmentId>,
        fractions: Vec<FractionSwap>,
    ) {
        let changed = || scene.obstacles().filter(|(id, _, _)| segments.contains(id));
        let moved = changed().any(|(_, _, properties)| properties.pose.is_some());
        if moved || bricks.len() * changed().count().max(1) > MAX_BRICKS {
            return self.send_root(scene, segments);
        }
        let swaps = changed().flat_map(|(id, segment, _)| {
            let entries = scene.touched(id, segment).bricks();
            bricks.iter().map(move |&index| {
                let brick = entries.get(index).cloned();
                (id, BrickSwap { index, brick })
            })
        });
        let swaps = swaps.collect();
        let change = BrickChange::new(self.sequence + 1, &scene.standing(), swaps, fractions);
        if change.fractions.len() > MAX_FRACTIONS {
            return self.send_root(scene, segments);
        }
        self.begin(segments);
        self.send(ServoCommand::Bricks(change));
    }

    /// Whether the servo touches what the simulation has: then fractions can be told that were
    /// worked out from it.
    #[must_use]
    pub fn follows_all(&self) -> bool {
        self.outstanding.is_empty()
    }

    /// Sends fractions that were worked out, which change no bit: those of bodies of their own come
    /// with a new root.
    pub fn send_fractions(&mut self, scene: &Scene, fractions: &[FractionSwap]) {
        if fractions.iter().any(|(id, _)| !scene.stands(*id)) {
            return self.send_root(scene, Vec::new());
        }
        for fractions in fractions.chunks(MAX_BRICKS) {
            // no change that anybody waits for
            let sequence = self.sequence;
            let change =
                BrickChange::new(sequence, &scene.standing(), Vec::new(), fractions.to_vec());
            self.send(ServoCommand::Bricks(change));
        }
    }

    fn send_root(&mut self, scene: &Scene, segments: Vec<SegmentId>) {
        self.send_parts(scene, scene.touchable_parts(), segments);
    }

    /// Sends a segment as a body of its own that still stands where the scan has it, so that it
    /// is moved from there.
    fn send_split(&mut self, scene: &Scene, id: SegmentId) {
        let mut parts = scene.touchable_parts();
        let split = parts.iter_mut().find(|part| part.id == id);
        if let Some(moved) = split.and_then(|part| part.moved.as_mut()) {
            moved.pose = DAffine3::IDENTITY;
        }
        self.send_parts(scene, parts, vec![id]);
    }

    fn send_parts(&mut self, scene: &Scene, parts: Vec<Part>, segments: Vec<SegmentId>) {
        let touchable = Box::new(touchable_of_parts(scene, parts, self.radius));
        let sequence = self.begin(segments);
        self.send(ServoCommand::Root {
            sequence,
            touchable,
        });
    }

    fn begin(&mut self, segments: Vec<SegmentId>) -> u64 {
        self.sequence += 1;
        self.outstanding.push(Outstanding {
            sequence: self.sequence,
            segments,
        });
        self.sequence
    }

    fn flush(&mut self) {
        while let Some(command) = self.backlog.pop_front() {
            if let Err(rtrb::PushError::Full(command)) = self.inbox.push(command) {
                self.backlog.push_front(command);
                return;
            }
        }
    }

    fn holds(&self, change: &Outstanding) -> bool {
        is_held(&self.status, change)
    }
}

/// All that can be touched, with a probe of a radius [mm] that was checked.
#[must_use]
pub fn touchable_of(scene: &Scene, radius: f64) -> Touchable {
    touchable_of_parts(scene, scene.touchable_parts(), radius)
}

fn touchable_of_parts(scene: &Scene, parts: Vec<Part>, radius: f64) -> Touchable {
    Touchable::new(scene.voxels().grid(), parts, radius)
        .expect("a ball is as small as the grids of all segments need")
}

fn is_held(status: &ServoStatus, change: &Outstanding) -> bool {
    let (first, last) = status.held_root;
    let in_root = first > 0 && (first..=last).contains(&change.sequence);
    in_root || status.held_edits.contains(&change.sequence)
}
