//! Recordings, and that they are computed again bit for bit.

mod recording;
mod run;
mod sessions;
mod tape_columns;
