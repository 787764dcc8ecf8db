//! Deformation of soft tissue: it gives, breaks and pushes back.
//!
//! A [`model::DeformationModel`] sees the voxels around the tools and what they are made of,
//! and answers with an edit, a field of displacements and a contact for each tool. Nobody
//! here applies an edit or sends a force: whoever owns the voxels does.
//!
//! Units: lengths mm, forces N, stiffness N/mm, stress and moduli N/mm² (= MPa), energies
//! N·mm (= mJ). Constants of materials come in SI and are converted in [`material`] alone.
//! Points are in the patient frame of the scan (LPS).
//!
//! This crate depends on `palpate-volume` only. It will not depend on touch, devices, tools
//! or the engine's threads.

pub mod at_rest;
mod displacement;
pub mod lattice;
pub mod material;
pub mod model;
mod observed_voxels;
pub mod particles;
pub mod potential;
pub mod pressed_block;
pub mod registry;
mod voxel_ledger;
mod work_time;
