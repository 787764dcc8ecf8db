//! The live session: a scan that is touched with a device, its threads and what they share.
//!
//! Four threads (device, servo, simulation, picture) hand over latest values and queues without
//! ever waiting for one another; the same loops can be stepped offline, deterministically. This
//! is the only crate that knows all others below it; it will not depend on Python or on the page.
//!
//! Each folder shows its names by itself, and uses folders further down this list only
//! (`scripts/check_arrows.py`):
//!
//! - `scenario`: tools that are driven without a device;
//! - `session`: a scan that is touched, from start to stop: configuration, threads, requests;
//! - `simulation`: the owner of the true voxels: edits, objects, tools, undo, the journal on disk;
//! - `picture`: frames and surfaces; `error`: what can go wrong;
//! - `deformable`: soft tissue; `replay`: recordings, and computing them again;
//! - `scene`: segments with their properties; `servo`: a tick of force, the device, the channels;
//! - `touch`: what is touched, how it feels, what is admitted; `threads`: clock, pace, priority;
//! - `notice`: sentences for the person.
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
