//! What is measured of touch and deformation: times, quality, passivity, and guarantees under
//! random work, for `palpate bench`.
//!
//! Above the engine: it runs the engine's own loops and looks at them from outside. It will not
//! depend on Python or on the page, and nothing but the binding depends on it.
//!
//! Frames: scene, LPS mm, unless a name says otherwise; forces N, times s.

pub mod deformation;
pub mod haptics;
pub mod passivity;
pub mod quality;
mod random;
pub mod stress;
mod timing;
