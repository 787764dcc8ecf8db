//! What is shown: frames, surfaces that follow the voxels, and what the simulation tells of both.
//!
//! Points in scene mm (LPS), boxes in voxels of the grid.

pub mod frame;
pub mod frame_collector;
pub mod packed_patch;
pub mod scene_updates;
pub mod simulation_status;
pub mod surface_loop;
pub mod surfaces;
