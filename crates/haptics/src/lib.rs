//! Touch: contact models that work on the voxels themselves, the coupling spring, the
//! safety stage and admission; one tick is one function.
//!
//! Everything that a tick calls is closed: no allocation, lock, log, wait or panic, and a
//! fixed bound on the voxels it reads (`tests/closed_tick.rs` proves the first).
//! Frames: contact models work in `grid` and measure in mm; ticks take and give `scene`.
//!
//! This crate depends on `palpate-volume` only. It will not depend on devices, threads,
//! clocks or tools: whoever calls it owns those.

pub mod admission;
pub mod ball;
pub mod contact;
pub mod force;
pub mod needle;
#[cfg(test)]
mod noise;
pub mod scene;
pub mod smooth;
pub mod soft_contact;
pub mod thesis;
pub mod tick;
