//! Matter that gives way, measured: for `palpate bench deform`, `palpate bench session` and
//! `palpate bench stress --deform`.

pub mod air;
pub mod lattice;
pub(crate) mod rig;
pub mod session;
pub mod stress;
mod watch;
pub(crate) mod world;
