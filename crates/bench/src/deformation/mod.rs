//! Matter that gives way, measured: for `palpate bench deform`, `palpate bench session` and
//! `palpate bench stress --deform`.

pub mod lattice;
mod rig;
pub mod session;
pub mod stress;
mod watch;
mod world;
