//! Scans and moves that the benchmarks share: seeded, so that every run times the same work.

pub mod moves;
pub mod scans;
