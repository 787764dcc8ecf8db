//! Tests of `palpate-surface`, in one binary.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests may fail a test, as the tests themselves"
)]

mod closed;
mod follows;
mod spheres;
mod support;
mod thin_parts;
mod voxel_faces;
mod voxelise;
