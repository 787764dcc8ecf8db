//! Voxels: grids and frames, intensities, segments as sparse bricks of bits, edits and
//! the exact traversal on which every contact model rests.
//!
//! Depends on no other crate of this project and knows nothing of devices, forces,
//! threads or files. Lengths are mm; frames are those of `docs/understand/conventions.md`: voxel
//! (i, j, k) of the grid frame covers [i, i+1) on each axis; x is fastest in memory.

pub mod bit_brick;
pub mod bits;
pub mod block;
pub mod bodies;
pub mod brick_grid;
pub mod clip;
pub mod edit;
mod edit_builder;
pub mod first_solid;
pub mod grid;
pub mod intensities;
pub mod intensity_brick;
pub mod material;
pub mod occupancy;
pub mod occupancy_fractions;
pub mod overlay;
pub mod phantom;
pub mod relax;
pub mod segment;
pub mod segment_set;
pub mod simd_dispatch;
pub mod statistics;
pub mod threshold;
pub mod tissue;
pub mod voxel_box;
pub mod voxel_state;
pub mod voxels;
pub mod walk;
