//! Tools at work without a device: what a robot with a force limit would feel. `palpate scenario`
//! is made of it.
//!
//! Servo, simulation and model of deformation are stepped in lock-step, with a drive in place of a
//! device; there is no clock. Frame: scene [mm]; N, s.

pub mod contacts;
pub mod drilling;
pub mod drive;
pub mod needle;
pub mod palpation;
pub mod rearranging;
mod rig;
