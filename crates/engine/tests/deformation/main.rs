//! Matter that gives way under the probe.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests may fail a test, as the tests themselves"
)]

#[path = "../common/mod.rs"]
mod common;
mod floor;
mod friction;
mod lattice;
mod regions;
mod soft_block;
