//! Soft tissue under the probe.

mod at_rest;
mod floor;
mod friction;
mod late;
mod lattice;
mod needle;
mod probe_size;
mod regions;
pub mod soft_block;
