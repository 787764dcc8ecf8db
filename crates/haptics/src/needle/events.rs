//! What happens to a needle: kept until whoever listens has taken it.

use serde::{Deserialize, Serialize};

/// Events that are kept.
pub const MAX_EVENTS: usize = 16;

/// What happened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum EventKind {
    /// The tip went into a segment.
    #[default]
    Punctured,
    /// The tip came into a segment that is punctured already, or out of all (0).
    Crossed,
    /// The tip came to a segment that no needle punctures.
    Stopped,
    /// The tip came out of where it went in.
    Withdrawn,
}

impl EventKind {
    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Punctured => "punctured",
            Self::Crossed => "crossed",
            Self::Stopped => "stopped",
            Self::Withdrawn => "withdrawn",
        }
    }
}

/// An event of a needle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NeedleEvent {
    /// What happened.
    pub kind: EventKind,
    /// Number of the segment; 0 for none.
    pub segment: u8,
    /// Time of the tick [s].
    pub time: f64,
    /// Depth of the tip along the needle's line [mm].
    pub depth: f64,
    /// Force at the tip [N].
    pub force: f64,
}

impl NeedleEvent {
    /// The tip came out at a time [s].
    pub(super) fn withdrawn(time: f64) -> Self {
        Self {
            kind: EventKind::Withdrawn,
            time,
            ..Self::default()
        }
    }
}

/// The newest events.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Events {
    newest: [NeedleEvent; MAX_EVENTS],
    count: u64,
}

impl Events {
    /// Number of events since the start, those no longer kept among them.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Events after the first `known` ones, oldest first, as far as they are kept.
    pub fn since(&self, known: u64) -> impl Iterator<Item = NeedleEvent> {
        let first = known.max(self.count.saturating_sub(MAX_EVENTS as u64));
        let newest = self.newest;
        (first..self.count).map(move |number| newest[place_of(number)])
    }

    /// Keeps another one.
    pub fn note(&mut self, event: NeedleEvent) {
        self.newest[place_of(self.count)] = event;
        self.count += 1;
    }
}

fn place_of(number: u64) -> usize {
    (number % MAX_EVENTS as u64) as usize
}
