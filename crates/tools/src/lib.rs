//! Tools that change voxels with the probe: eraser, adder, painter, drill; strokes of them, and undo.
//!
//! A tool sees the voxels and where the probe went, and gives an edit. Nobody here applies
//! it: whoever owns the voxels does, keeps the inverse in a [`stroke::Stroke`], and the
//! whole stroke as one step in an [`undo::UndoJournal`]. A [`journal::JournalFile`]
//! writes each change down, so that a crash loses nothing.
//!
//! Lengths mm, forces N, energies N·mm (= mJ), power N·mm/s (= mW). Points are in the
//! patient frame of the scan (LPS), which is the scene's for all that was not moved.
//!
//! This crate depends on `palpate-volume` only. It will not depend on touch, devices or
//! the engine's threads.

pub mod adder;
pub mod drill;
pub mod eraser;
pub mod factory;
pub mod journal;
mod measure;
mod needle;
pub mod painter;
pub mod specific_energy;
pub mod stroke;
mod surface_layer;
mod sweep;
pub mod tool;
pub mod undo;
