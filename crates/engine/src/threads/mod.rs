//! What every thread of a session needs: its clock, pace, priority and how it is woken. Times s.

pub mod change_signal;
pub mod clock;
pub mod pacing;
pub mod priority;
pub mod rate;
