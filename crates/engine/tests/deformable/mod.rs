//! Soft tissue under the probe.

mod floor;
mod friction;
mod lattice;
mod regions;
pub mod soft_block;
