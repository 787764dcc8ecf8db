//! Random fast moves with every guarantee checked at each of them, for `palpate bench stress`.
//!
//! A run has a world of its own (thin walls, noise, bone), a probe, and a hand that moves by up
//! to 50 voxels per tick, all made from the seed and the number of the run: so a violation is
//! told by these two numbers and found again by running that run alone. The checkers
//! (`checker.rs`, `force_check.rs`) share no code with what they check: they have the voxels as
//! bytes of their own and answer every question the slow way.
//!
//! Guarantees by number (design, section 5):
//! 1. the probe's body is in no solid voxel of any body;
//! 2. from tick to tick it goes through free voxels, from face to face, so that it crosses
//!    no wall;
//! 3. bounded work, and no force without contact;
//! 4. at rest, soon nothing changes by a bit;
//! 5. what is sent is finite, within the limit and slewed;
//! 6. the force never pulls into the obstacle.
//!
//! And of the smooth force and of edits (issue "touch, complete"):
//! 7. a change of voxels that is not held back is touched;
//! 8. the force changes in a tick by no more than stiffness times the hand's own move and a tenth
//!    of the smallest spacing.
//!
//! Goal: none in 10⁸ moves.

mod checker;
mod constants;
pub mod dense;
#[cfg(test)]
mod examples;
mod felt;
mod force_check;
mod guarantee;
mod hand;
mod object;
mod paths;
mod plan;
mod report;
mod run;
mod touched;
mod world;

pub(super) use dense::{Dense, Finder};
pub(super) use guarantee::hold;
pub use guarantee::{Guarantee, Violation};
pub use plan::{Plan, Terrain};
pub use report::{Found, Report, Source};
pub use run::{on_threads, run, runs};
