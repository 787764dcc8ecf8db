//! All tests of the engine in one binary, in folders as the sources are, but for those that need a
//! process of their own: `closed_tick.rs`, `small_edit.rs` and `live.rs`.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests may fail a test, as the tests themselves"
)]

mod common;
mod deformable;
#[path = "../../../tests/support/length.rs"]
mod length;
mod picture;
#[path = "../../tools/tests/support/place.rs"]
mod place;
mod replay;
mod scenario;
mod scene;
mod servo;
mod session;
mod simulation;
mod touch;
