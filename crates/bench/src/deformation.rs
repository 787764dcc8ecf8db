//! Soft tissue, measured: for `palpate bench deform`, `palpate bench session` and
//! `palpate bench stress --deform`.

pub mod lattice;
mod monitor;
mod rig;
pub mod session;
pub mod stress;
mod world;
