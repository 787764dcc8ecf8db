//! What can be taken back, newest last: the inverse of each change.
//!
//! There is no limit on the number of steps, only on the bytes that they hold on to: where
//! a new step goes beyond the budget, the oldest are forgotten. The newest step stays in any
//! case, however large. Steps that can be done again count too; they never push others out,
//! since an undo only turns one into the other.

use std::collections::VecDeque;

/// Bytes that all steps together may hold on to, unless said otherwise: 512 MiB.
pub const DEFAULT_BUDGET: usize = 512 << 20;

/// Two stacks of steps, each the inverse of what was done.
#[derive(Debug)]
pub struct UndoJournal<S> {
    undo: VecDeque<(S, usize)>,
    redo: Vec<(S, usize)>,
    bytes: usize,
    budget: usize,
    /// Number of the oldest steps that were dropped.
    forgotten: u64,
    made: u64,
}

impl<S> Default for UndoJournal<S> {
    fn default() -> Self {
        Self::new(DEFAULT_BUDGET)
    }
}

impl<S> UndoJournal<S> {
    /// An empty journal whose steps may hold `budget` bytes.
    #[must_use]
    pub fn new(budget: usize) -> Self {
        Self {
            undo: VecDeque::new(),
            redo: Vec::new(),
            bytes: 0,
            budget,
            forgotten: 0,
            made: 0,
        }
    }

    /// Bytes that steps may hold on to.
    #[must_use]
    pub fn budget(&self) -> usize {
        self.budget
    }

    /// Bytes that they do hold on to, those that can be done again included.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    /// Whether there is a change to take back.
    #[must_use]
    pub fn can_undo(&self) -> bool {
        !self.undo.is_empty()
    }

    /// Whether there is a change to do again.
    #[must_use]
    pub fn can_redo(&self) -> bool {
        !self.redo.is_empty()
    }

    /// Steps that were made, less those that were taken back; those that are forgotten count.
    #[must_use]
    pub fn position(&self) -> u64 {
        self.forgotten + self.undo.len() as u64
    }

    /// Steps that were made, ever: where this rises, what was undone is forgotten.
    #[must_use]
    pub fn made(&self) -> u64 {
        self.made
    }

    /// All steps.
    pub fn steps(&self) -> impl Iterator<Item = &S> {
        self.undo.iter().chain(&self.redo).map(|(step, _)| step)
    }

    /// The newest change that can be taken back.
    #[must_use]
    pub fn newest(&self) -> Option<&S> {
        self.undo.back().map(|(step, _)| step)
    }

    /// The undone change that can be done again next.
    #[must_use]
    pub fn newest_undone(&self) -> Option<&S> {
        self.redo.last().map(|(step, _)| step)
    }

    /// Notes the inverse of a new change, which holds `bytes`; what was undone is forgotten.
    pub fn done(&mut self, inverse: S, bytes: usize) {
        for (_, freed) in self.redo.drain(..) {
            self.bytes -= freed;
        }
        self.made += 1;
        self.redone(inverse, bytes);
    }

    /// The step that takes the newest change back.
    pub fn pop_undo(&mut self) -> Option<S> {
        let (step, bytes) = self.undo.pop_back()?;
        self.bytes -= bytes;
        Some(step)
    }

    /// The step that does the last undone change again.
    pub fn pop_redo(&mut self) -> Option<S> {
        let (step, bytes) = self.redo.pop()?;
        self.bytes -= bytes;
        Some(step)
    }

    /// Notes the inverse of an undo, which holds `bytes`.
    pub fn undone(&mut self, inverse: S, bytes: usize) {
        let bytes = Self::weight(bytes);
        self.redo.push((inverse, bytes));
        self.bytes += bytes;
    }

    /// Notes the inverse of a redo, which holds `bytes`.
    pub fn redone(&mut self, inverse: S, bytes: usize) {
        let bytes = Self::weight(bytes);
        self.undo.push_back((inverse, bytes));
        self.bytes += bytes;
        while self.bytes > self.budget && self.undo.len() > 1 {
            if let Some((_, freed)) = self.undo.pop_front() {
                self.bytes -= freed;
                self.forgotten += 1;
            }
        }
    }

    /// A step counts itself too, so that the smallest ones are bounded as well.
    fn weight(bytes: usize) -> usize {
        bytes + size_of::<(S, usize)>()
    }
}
