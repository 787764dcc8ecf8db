//! What can be taken back: the inverse of each change, newest last.

use std::collections::VecDeque;

/// Changes that can be taken back, at most.
const MAX_STEPS: usize = 200;
/// Bytes that the steps may hold on to; the newest stays in any case.
const MAX_BYTES: usize = 512 << 20;

/// Two stacks of steps, each the inverse of what was done.
#[derive(Debug)]
pub struct Journal<S> {
    undo: VecDeque<(S, usize)>,
    redo: Vec<S>,
    bytes: usize,
}

impl<S> Default for Journal<S> {
    fn default() -> Self {
        Self {
            undo: VecDeque::new(),
            redo: Vec::new(),
            bytes: 0,
        }
    }
}

impl<S> Journal<S> {
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

    /// All steps.
    pub fn steps(&self) -> impl Iterator<Item = &S> {
        self.undo.iter().map(|(step, _)| step).chain(&self.redo)
    }

    /// Notes the inverse of a new change, which holds `bytes`; what was undone is forgotten.
    pub fn done(&mut self, inverse: S, bytes: usize) {
        self.redo.clear();
        self.push_undo(inverse, bytes);
    }

    /// The newest change that can be taken back.
    #[must_use]
    pub fn newest(&self) -> Option<&S> {
        self.undo.back().map(|(step, _)| step)
    }

    /// The step that takes the newest change back.
    pub fn pop_undo(&mut self) -> Option<S> {
        let (step, bytes) = self.undo.pop_back()?;
        self.bytes -= bytes;
        Some(step)
    }

    /// The step that does the last undone change again.
    pub fn pop_redo(&mut self) -> Option<S> {
        self.redo.pop()
    }

    /// Notes the inverse of an undo.
    pub fn undone(&mut self, inverse: S) {
        self.redo.push(inverse);
    }

    /// Notes the inverse of a redo, which holds `bytes`.
    pub fn redone(&mut self, inverse: S, bytes: usize) {
        self.push_undo(inverse, bytes);
    }

    fn push_undo(&mut self, step: S, bytes: usize) {
        self.undo.push_back((step, bytes));
        self.bytes += bytes;
        while self.undo.len() > MAX_STEPS || (self.bytes > MAX_BYTES && self.undo.len() > 1) {
            if let Some((_, freed)) = self.undo.pop_front() {
                self.bytes -= freed;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_come_back_newest_first_and_a_new_change_forgets_what_was_undone() {
        let mut journal = Journal::default();
        journal.done('a', 1);
        journal.done('b', 1);
        assert_eq!(journal.pop_undo(), Some('b'));
        journal.undone('B');
        assert!(journal.can_redo());
        journal.done('c', 1);
        assert!(!journal.can_redo());
        assert_eq!(journal.pop_undo(), Some('c'));
        assert_eq!(journal.pop_undo(), Some('a'));
        assert!(!journal.can_undo());
    }

    #[test]
    fn the_oldest_steps_are_forgotten_where_they_hold_too_much() {
        let mut journal = Journal::default();
        journal.done("small", 1);
        journal.done("huge", 2 * MAX_BYTES);
        assert_eq!(journal.pop_undo(), Some("huge"));
        assert!(!journal.can_undo());

        for _ in 0..2 * MAX_STEPS {
            journal.done("step", 1);
        }
        assert_eq!(journal.steps().count(), MAX_STEPS);
    }
}
