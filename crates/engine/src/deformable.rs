//! Soft tissue: which segments give way, by which model, and the loop that computes it.
//!
//! Frames: scene mm (LPS), the grid of the scan; N, s.

mod box_pace;
mod deformable_segments;
mod deformable_view;
mod deformation;
mod deformation_loop;
mod displacements;
mod rigid_regions;
mod unpressed;

pub use deformable_segments::has_soft_segments;
pub use deformable_view::{DeformableView, ShownParts};
pub use deformation::{Deformation, DeformationStatus, ForceSource};
pub use deformation_loop::{DeformationLoop, WakeUp};
pub use displacements::{Displacements, Following, UNSEEN};
pub use rigid_regions::{Regions, SharedChange, SharedRegionChanges, changed_bricks, rigid_mask};
pub use unpressed::Unpressed;
