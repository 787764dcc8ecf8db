//! Tests of `palpate-surface`, in one binary.

mod closed;
mod follows;
mod spheres;
mod support;
mod voxel_faces;
mod voxelise;
