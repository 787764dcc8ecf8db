//! Sends changes of what can be touched to the servo and knows which of them it follows.
//!
//! A small edit goes brick by brick, a large one and every bulk change as a new root. Each
//! change has a number; the servo tells which numbers it has taken and which it holds back.

use std::collections::VecDeque;

use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::edit::SegmentId;

use crate::handover::{BrickChange, MAX_BRICKS, ServoCommand, ServoStatus, SimulationChannels};
use crate::scene::{Scene, TouchChange};
use crate::touch::{union_brick, union_of};

/// A change that touch does not follow yet.
#[derive(Debug)]
struct Outstanding {
    sequence: u64,
    segments: Vec<SegmentId>,
}

/// The simulation's end of the way to the servo.
#[derive(Debug)]
pub struct TouchSender {
    channels: SimulationChannels,
    backlog: VecDeque<ServoCommand>,
    sequence: u64,
    outstanding: Vec<Outstanding>,
    status: ServoStatus,
    skipped: u64,
}

impl TouchSender {
    /// A way on which nothing was sent yet.
    #[must_use]
    pub fn new(channels: SimulationChannels) -> Self {
        Self {
            channels,
            backlog: VecDeque::new(),
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

    /// Number of changes that touch does not follow yet.
    #[must_use]
    pub fn pending(&self) -> usize {
        self.outstanding.len()
    }

    /// Whether the servo holds a change back, since the probe is in its way.
    #[must_use]
    pub fn is_held(&self) -> bool {
        self.outstanding.iter().any(|change| self.holds(change))
    }

    /// Whether a change of this segment is among the pending ones.
    #[must_use]
    pub fn is_pending(&self, id: SegmentId) -> bool {
        self.outstanding
            .iter()
            .any(|change| change.segments.contains(&id))
    }

    /// Sends a change of the scene.
    pub fn send_change(&mut self, scene: &Scene, change: &TouchChange) {
        match change {
            TouchChange::Nothing => {}
            TouchChange::Bricks(bricks, segments) if bricks.len() <= MAX_BRICKS => {
                self.send_bricks(scene, bricks, segments.clone());
            }
            TouchChange::Bricks(_, segments) => self.send_root(scene, segments.clone()),
            TouchChange::All(id) => self.send_root(scene, vec![*id]),
        }
    }

    /// Sends a command that changes no occupancy.
    pub fn send(&mut self, command: ServoCommand) {
        self.backlog.push_back(command);
        self.flush();
    }

    /// Frees what the servo gave back, sends what waits and reads what it follows by now.
    pub fn exchange(&mut self, scene: &Scene) {
        while let Ok(garbage) = self.channels.garbage.pop() {
            drop(garbage);
        }
        self.flush();
        self.status = *self.channels.status.read();
        let status = self.status;
        if status.skipped > self.skipped {
            self.skipped = status.skipped;
            let segments = scene.segments().map(|(id, _, _)| id).collect();
            self.send_root(scene, segments);
        }
        self.outstanding
            .retain(|change| change.sequence > status.received || is_held(&status, change));
    }

    fn send_bricks(&mut self, scene: &Scene, bricks: &[u32], segments: Vec<SegmentId>) {
        let sequence = self.begin(segments);
        let obstacles = scene.touchable_bits();
        let swaps = bricks.iter().map(|&index| BrickSwap {
            index,
            brick: union_brick(&obstacles, index),
        });
        self.send(ServoCommand::Bricks(BrickChange {
            sequence,
            swaps: swaps.collect(),
        }));
    }

    fn send_root(&mut self, scene: &Scene, segments: Vec<SegmentId>) {
        let dimensions = scene.voxels().grid().dimensions();
        let bits: Bits = union_of(dimensions, &scene.touchable_bits());
        let sequence = self.begin(segments);
        self.send(ServoCommand::Root { sequence, bits });
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
            if let Err(rtrb::PushError::Full(command)) = self.channels.inbox.push(command) {
                self.backlog.push_front(command);
                return;
            }
        }
    }

    fn holds(&self, change: &Outstanding) -> bool {
        is_held(&self.status, change)
    }
}

fn is_held(status: &ServoStatus, change: &Outstanding) -> bool {
    let (first, last) = status.held_root;
    let in_root = first > 0 && (first..=last).contains(&change.sequence);
    in_root || status.held_edits.contains(&change.sequence)
}
