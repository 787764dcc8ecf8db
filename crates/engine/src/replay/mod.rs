//! Recordings of a session's servo: its inputs and commands, as files hold them and computed again.
//!
//! Frames: `_in_device` is the device's own, all else is the scene; mm, N, s.

pub mod mask_runs;
pub mod recording;
pub mod run;
pub mod tape;
pub mod tape_columns;
