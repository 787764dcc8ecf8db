//! What the simulation does to segments, and the journal that keeps it.

mod journal;
mod objects;
mod own_grid;
mod paint;
mod tools;
mod undo;
