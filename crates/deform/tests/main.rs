//! Tests of `palpate-deform`, in one binary.

mod cuboid_compression;
mod examples;
mod global_effort;
mod global_particles;
mod lattice_box;
mod lattice_depth;
mod lattice_effort;
mod lattice_elastic;
mod lattice_incompressible;
mod lattice_inelastic;
mod lattice_layers;
mod lattice_model;
mod lattice_relax;
mod lattice_stiffening;
mod lattice_voxels;
mod lattice_whole;
mod lattice_yield;
#[path = "../../../tests/support/length.rs"]
mod length;
mod liver;
mod material;
mod model_support;
mod needle_tissue;
mod particle_boxes;
mod particle_lattices;
mod particle_lists;
mod particle_models;
mod particle_motion;
mod particle_rearranged;
mod particle_settings;
mod particle_tools;
mod potential;
mod pressed_block;
mod support;
