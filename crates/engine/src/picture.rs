//! What is shown: frames, surfaces that follow the voxels, and what the simulation tells of both.
//!
//! Points in scene mm (LPS), boxes in voxels of the grid.

mod frame;
mod frame_collector;
mod packed_patch;
mod scene_updates;
mod simulation_status;
mod surface_loop;
mod surfaces;

pub use frame::{ForceOff, Frame, Rates, Safety};
pub use frame_collector::{FrameCollector, FrameSources, RateReaders};
pub use packed_patch::PackedPatch;
pub use scene_updates::SceneUpdate;
pub use simulation_status::{PictureEnds, SimulationStatus};
pub use surface_loop::{SurfaceLoop, SurfacePace};
pub use surfaces::{
    MOST_BOXES, PictureChange, ShownDisplacements, ShownSurface, SurfaceChange, Surfaces,
    VoxelChange,
};
