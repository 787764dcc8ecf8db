//! Soft tissue: which segments give way, by which model, and the loop that computes it.
//!
//! Frames: scene mm (LPS), the grid of the scan; N, s.

pub mod deformable_segments;
pub mod deformable_view;
pub mod deformation;
pub mod deformation_loop;
pub mod displacements;
pub mod rigid_regions;
