//! The picture of a scan: ray casting over the engine's own voxels, on all cores, without a graphics card.
//!
//! A [`scene::Scene`] is a scan at one edit, whose values are shared with the session; a [`prepared::Prepared`] is an
//! [`appearance::Appearance`] made ready for it; [`draw::draw`] gives a [`picture::Picture`] of both from a
//! [`camera::Camera`]; a [`renderer::Renderer`] keeps all of this ready from picture to picture. What is drawn is specified in `docs/understand/optics.md`; the page's shaders draw the same.
//! Frames: cameras and planes in the patient, LPS mm; rays in the grid, lengths along them in mm.

pub mod appearance;
mod bricks;
pub mod camera;
pub mod checks;
pub mod displaced;
pub mod draw;
mod field;
mod labels;
mod lanes;
pub mod light_volume;
mod lighting;
mod march;
pub mod part;
pub mod picture;
pub mod prepared;
pub mod renderer;
pub mod scene;
mod segments;
mod shading;
pub mod stop;
pub mod surfaces;
mod transfer;
