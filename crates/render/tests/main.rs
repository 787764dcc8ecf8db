//! All tests of the ray caster in one binary: what a picture shows against what can be reckoned by hand.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests may fail a test, as the tests themselves"
)]

mod checks;
mod common;
mod cuts;
mod displaced;
mod edits;
mod grids;
mod light;
mod modes;
mod parts;
mod same_picture;
mod segments;
mod surfaces;
mod tissue;
mod views;
