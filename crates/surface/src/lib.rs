//! Surfaces of segments: triangles that follow the voxels, patch by patch.
//!
//! Depends on `palpate-volume` only and knows nothing of pictures, threads or files. Lengths are
//! mm along the patient's axes (LPS); frames are those of `docs/understand/conventions.md`.

mod block;
pub mod cell_table;
mod cell_volume;
mod field;
mod frame;
pub mod kept;
mod march;
pub mod mesh;
pub mod mesh_bodies;
pub mod patch;
mod place;
mod quick_map;
mod samples;
pub mod segment_surface;
pub mod settings;
pub mod thin_parts;
mod thin_volume;
mod thin_voxels;
pub mod voxel_faces;
mod voxel_source;
pub mod voxelise;

pub use block::PatchId;
pub use patch::{Bounds, Patch};
pub use segment_surface::{PatchChange, SegmentSurface};
pub use settings::{Limits, SettingsError, SmoothingMode, SurfaceSettings};
pub use voxel_source::VoxelSource;
