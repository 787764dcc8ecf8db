//! Random fast moves with every guarantee checked at each of them, for `palpate bench stress`.
//!
//! A run has a world of its own (thin walls, noise, bone), a probe, and a hand that moves by up
//! to 50 voxels per tick, all made from the seed and the number of the run: so a violation is
//! told by these two numbers and found again by running that run alone. The checker
//! (`checker.rs`) shares no code with what it checks: it has the voxels as bytes of its own and
//! answers every question the slow way.
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
//! Goal: none in 10⁸ moves.

mod checker;
mod dense;
mod hand;
mod plan;
mod run;
mod thing;
mod touched;
mod world;

pub use checker::{Guarantee, Violation};
pub use plan::{Plan, Terrain};
pub use run::{Found, Report, Source, run, runs};
