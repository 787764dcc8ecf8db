//! All tests of the benchmarks, in one binary.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests may fail a test, as the tests themselves"
)]

mod brute_force;
#[path = "../../engine/tests/common/mod.rs"]
mod common;
mod deformation;
mod entry_points;
mod haptics;
#[path = "../../../tests/support/length.rs"]
mod length;
mod passivity;
mod quality;
mod stress;
