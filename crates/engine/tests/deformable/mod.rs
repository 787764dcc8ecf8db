//! Soft tissue under the probe.

mod floor;
mod friction;
mod lattice;
mod regions;
mod soft_block;
