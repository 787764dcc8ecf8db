//! Matter that gives way under the probe.

mod floor;
mod friction;
mod lattice;
mod regions;
mod soft_block;
