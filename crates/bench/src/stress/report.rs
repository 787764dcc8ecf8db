//! What came of runs, and how to come to a violation again.

use palpate_volume::bits::Bits;
use palpate_volume::grid::Grid;

use super::guarantee::Violation;
use super::plan::Plan;

/// Bone to take parts of.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// Where it stands.
    pub grid: &'a Grid,
    /// Its voxels.
    pub bits: &'a Bits,
}

/// What came of some runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Moves that were made and checked.
    pub moves: u64,
    /// Of these, in contact.
    pub contacts: u64,
    /// Edits.
    pub edits: u64,
    /// Steps of objects on their ways.
    pub poses: u64,
    /// Forces that fell at once since they would have pulled (`force_check.rs`).
    pub cuts: u64,
    /// The violation in the run of the lowest number.
    pub violation: Option<Found>,
}

/// A violation and how to come to it again.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Number of the run.
    pub run: u64,
    /// Moves before it.
    pub at_move: u64,
    /// What is done in the run.
    pub plan: Plan,
    /// What was broken.
    pub violation: Violation,
}

impl Report {
    /// Two reports as one; the violation of the lower run counts.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let [a, b] = [self.violation, other.violation];
        Self {
            moves: self.moves + other.moves,
            contacts: self.contacts + other.contacts,
            edits: self.edits + other.edits,
            poses: self.poses + other.poses,
            cuts: self.cuts + other.cuts,
            violation: [a, b].into_iter().flatten().min_by_key(|found| found.run),
        }
    }
}
