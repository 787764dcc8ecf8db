//! Particles that act on one another at a distance: the thesis' potential fields.
//!
//! Layout: one array per quantity ([`state`]); each particle has a list of all others within
//! reach and a margin ([`neighbours`]), so each pair is met twice, once from either side, and
//! no two threads ever write to one particle. Units are the caller's (the models use mm, N).
//! Source: thesis 5.3–5.26.

pub mod bench;
mod body;
pub mod calibration;
mod cells;
mod contact_laws;
pub mod elasticity;
mod global_field;
pub mod global_model;
mod global_sites;
pub mod integrator;
mod lanes;
#[cfg(target_arch = "x86_64")]
mod lanes_x86;
pub mod lattices;
pub mod limits;
pub mod local_model;
mod local_state;
pub mod neighbours;
pub mod pair_force;
pub mod pair_laws;
mod rearranged;
mod slips;
pub mod space;
pub mod state;
pub mod system;
pub mod tool_push;
mod voxel_following;
mod walls;
mod write_back;

pub use global_model::{GlobalModel, GlobalSettings};
pub use local_model::{LocalModel, LocalSettings, Motion};
pub use neighbours::NeighbourList;
pub use pair_force::{PairOptions, PairSums, Workers, pair_forces};
pub use pair_laws::{CuboidLaw, CutLaw, FadedLaw};
pub use space::Space;
pub use state::{Particles, Site};
pub use system::ParticleSystem;
