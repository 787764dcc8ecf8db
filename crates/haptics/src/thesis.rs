//! The contact models of the thesis as printed, to compare with; never a default.
//!
//! Frame: grid. Source: R. Vlasov, thesis (2016), chapter 4.

mod border_voxels;
mod force;
mod improved;
mod original;
mod path;
mod ray_samples;
mod voxelised_scene;

pub use improved::ThesisImproved;
pub use original::ThesisOriginal;
pub use path::ThesisLimits;
