//! Tests of `palpate-volume`, in one binary.
//!
//! Its allocator refuses only threads that are within `assert_no_alloc`, so all tests share it.

mod bit_brick;
mod bits;
mod block;
mod bodies;
mod brick_grid;
mod clip;
mod first_solid;
mod grid;
mod intensities;
mod intensity_brick;
mod material;
mod matter;
mod occupancy;
mod overlay;
mod phantom;
mod relax;
mod segment;
mod statistics;
mod support;
mod threshold;
mod tissue;
mod voxel_box;
mod voxels;
mod walk;

use assert_no_alloc::AllocDisabler;

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;
