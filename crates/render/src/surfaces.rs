//! Surfaces of segments: triangles, drawn into each pixel as fragments that a ray meets on its way through the scan.
//!
//! A [`SegmentSurface`] shares its triangles with whoever made them. For one picture their corners are taken from where
//! their tissue stands (`stood.rs`) to the screen (`on_screen.rs`); each band of rows then draws those in it (`band.rs`):
//! of what is opaque the nearest fragment of each pixel, of what can be seen through all of them, by depth. Rays go on
//! from there (`march/layers.rs`).
//! Frames: triangles in the patient, LPS mm; fragments by their depth along the direction of view [mm].

mod band;
mod drawn;
mod kept;
mod on_screen;
mod other_patches;
mod stood;

use std::fmt::Debug;
use std::sync::Arc;

use glam::{DAffine3, DVec3};

pub(crate) use band::{BandFragments, Fragment, NO_FRAGMENT};
pub(crate) use drawn::{DrawnSurface, Own};
pub(crate) use on_screen::OnScreen;
pub(crate) use other_patches::{OnePatch, other_patches};
pub(crate) use stood::Moving;

/// Triangles with shared corners.
pub trait Triangles: Debug + Send + Sync {
    /// Of each corner [mm, from the origin of its surface].
    fn positions(&self) -> &[[f32; 3]];
    /// Of each corner: unit vectors out of the segment.
    fn normals(&self) -> &[[f32; 3]];
    /// Numbers of the three corners of each triangle.
    fn corners(&self) -> &[[u32; 3]];
}

/// The surface of a segment, where it stands.
#[derive(Clone, Debug)]
pub struct SegmentSurface {
    /// The segment's number.
    pub id: u8,
    /// From where its positions are counted, where the scan has the segment [patient, LPS mm].
    pub origin: DVec3,
    /// From where the scan has it to where it stands [mm].
    pub pose: DAffine3,
    /// Its triangles.
    pub patches: Vec<Arc<dyn Triangles>>,
}

impl SegmentSurface {
    /// Whether it stands where the scan has its segment.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.pose == DAffine3::IDENTITY
    }
}
