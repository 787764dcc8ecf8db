//! What every thread of a session needs: its clock, pace, priority and how it is woken. Times s.

mod change_signal;
pub mod clock;
mod pacing;
pub mod priority;
mod rate;

pub use change_signal::ChangeSignal;
pub use pacing::{PICTURE_HZ, Pacer, SIMULATION_HZ, TickStart};
pub use priority::Priority;
pub use rate::{LATENESS_BINS_US, Rate, RateMeter, RateReader};
