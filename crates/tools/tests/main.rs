//! Tests of `palpate-tools`, in one binary.

mod adder;
mod drill;
mod eraser;
mod journal;
mod journal_damage;
mod journal_disk;
mod painter;
mod stroke;
mod support;
mod undo;
