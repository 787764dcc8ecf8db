//! Recordings of a session's servo: its inputs and commands, as files hold them and computed again.
//!
//! Frames: `_in_device` is the device's own, all else is the scene; mm, N, s.

mod mask_runs;
mod recording;
mod run;
mod tape;
mod tape_columns;

pub use recording::{MAX_TICKS, Recording};
pub use run::{Difference, ReplayEnd, ReplayError, Replayed, replay};
pub use tape::{MAX_TAPE_BYTES, Tape, TapeCommand, TapeEntry, TapeRecorder};
pub use tape_columns::{
    BUILD, BrickColumns, FractionColumns, TapeColumns, TapeError, ValueColumns,
};
