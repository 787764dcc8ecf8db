//! How large a box the model of deformation works on: a smaller one where the computer can't keep up.
//!
//! What the model needs is processor time, and other programs may leave it little. An answer from a small
//! box takes a quarter of the work of one from a usual box, and its force is within 6 % as long as the tool
//! presses no deeper than its radius (`crates/deform/tests/lattice_box.rs`).

use std::time::Duration;

/// Nodes along each edge of the small box.
const SMALL: u32 = 13;
/// Time for an answer from which on the box is small: 15 in a second [s].
const SLOW: f64 = 1.0 / 15.0;
/// Time for an answer of the small box up to which the usual one is tried again [s]: that takes some four
/// times as long.
const QUICK: f64 = 0.25 * SLOW;
/// Weight of the last answer in the mean over answers.
const NEWEST: f64 = 0.25;
/// Answers with fewer iterations had little to do, and where they were quick tell nothing of how long one
/// takes.
const WORKED: u32 = 10;

/// How fast answers come, and how large the box is for that.
#[derive(Clone, Copy, Debug, Default)]
pub struct BoxPace {
    /// Mean time of an answer [s].
    mean: f64,
    is_small: bool,
}

impl BoxPace {
    /// Nodes along each edge at most; none for the model's own.
    #[must_use]
    pub fn edge(&self) -> Option<u32> {
        self.is_small.then_some(SMALL)
    }

    /// Takes note of how long an answer took, and how many iterations it needed. The box may get smaller while
    /// a tool presses, and larger only when none does, so that nobody feels the change twice.
    pub fn note(&mut self, took: Duration, iterations: u32, is_pressed: bool) {
        let took = took.as_secs_f64();
        if iterations >= WORKED || took > SLOW {
            self.mean += NEWEST * (took - self.mean);
            if self.mean > SLOW {
                *self = Self {
                    mean: 0.0,
                    is_small: true,
                };
            }
        } else if !is_pressed && self.is_small && self.mean > 0.0 && self.mean < QUICK {
            *self = Self::default();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pressed(pace: &mut BoxPace, millis: u64, answers: u32) {
        for _ in 0..answers {
            pace.note(Duration::from_millis(millis), 60, true);
        }
    }

    #[test]
    fn a_computer_that_keeps_up_has_the_usual_box_and_one_late_answer_changes_nothing() {
        let mut pace = BoxPace::default();
        pressed(&mut pace, 25, 100);
        pressed(&mut pace, 150, 1);
        pressed(&mut pace, 25, 100);
        assert_eq!(pace.edge(), None);
    }

    #[test]
    fn a_busy_one_has_a_small_box_within_a_few_answers_until_it_is_quick_and_the_tool_has_left() {
        let mut pace = BoxPace::default();
        pressed(&mut pace, 120, 4);
        assert_eq!(pace.edge(), Some(SMALL));
        // still too busy for four times as much
        pressed(&mut pace, 40, 50);
        pace.note(Duration::from_millis(1), 1, false);
        assert_eq!(pace.edge(), Some(SMALL));
        pressed(&mut pace, 8, 50);
        assert_eq!(pace.edge(), Some(SMALL), "while it presses");
        pace.note(Duration::from_millis(1), 1, false);
        assert_eq!(pace.edge(), None);
    }

    #[test]
    fn quick_answers_of_tissue_at_rest_tell_nothing_but_slow_ones_do() {
        let mut pace = BoxPace::default();
        pressed(&mut pace, 60, 100);
        for _ in 0..100 {
            pace.note(Duration::from_millis(1), 1, true);
        }
        // as slow as before
        pressed(&mut pace, 90, 2);
        assert_eq!(pace.edge(), Some(SMALL));
        let mut pace = BoxPace::default();
        for _ in 0..4 {
            pace.note(Duration::from_millis(200), 1, false);
        }
        assert_eq!(pace.edge(), Some(SMALL));
    }
}
