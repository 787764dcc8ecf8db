//! The live session: a scan that is touched with a device, its threads and what they share.
//!
//! Four threads (device, servo, simulation, picture) hand over latest values and queues without
//! ever waiting for one another; the same loops can be stepped offline, deterministically. This
//! is the only crate that knows all others; it will not depend on Python or on the page.
//!
//! Frames: points in the scene, LPS mm, unless a name says otherwise; forces N, times s.

pub mod deformable;
pub mod error;
pub mod notice;
pub mod picture;
pub mod replay;
pub mod scenario;
pub mod scene;
pub mod servo;
pub mod session;
pub mod simulation;
pub mod threads;
pub mod touch;
