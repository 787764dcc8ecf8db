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
mod ball_brick;
mod ball_cache;
mod ball_closing;
pub mod ball_limits;
mod ball_nearest;
pub mod ball_probe;
pub mod ball_shape;
mod bit_rows;
mod bodies;
mod border_voxels;
pub mod contact;
pub mod coupling;
mod creep;
mod descent;
pub mod exact;
mod flood;
pub mod friction;
pub mod local_force;
mod many_bodies;
pub mod middle_voxels;
pub mod moving;
pub mod needle;
mod node_lattice;
pub mod passivity;
pub mod placement;
pub mod proxy;
mod ray_samples;
pub mod safety;
pub mod scene;
mod slide;
mod slide_many;
mod slide_window;
pub mod smooth;
pub mod soft_contact;
pub mod surface;
mod thesis_force;
pub mod thesis_improved;
pub mod thesis_original;
pub mod thesis_path;
pub mod tick;
mod voxel_distance;
mod wide;
