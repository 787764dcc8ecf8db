//! How well touch tells a body's shape, for `palpate bench touch-quality`.
//!
//! Bodies whose surface is known exactly are voxelised (a voxel is solid where its middle is
//! inside), a device is led under their surface, and what is felt is held against what should
//! be: a force toward the nearest point of the true surface, as large as the spring makes of
//! the way there. The yardstick knows nothing of how the force is made: it asks a closure.
//!
//! A ball is held against the dilated body: its middle against the surface that middles of such
//! balls cannot cross.
//!
//! Lengths are reported in parts of h, the smallest spacing; angles in degrees.
//! Goals (design, section 8; issue "touch, complete") stand in `palpate.bench.goals`.

mod body;
mod case;
mod felt;
mod figures;
mod path;
mod solid;

pub use body::{Body, Foot, Shape};
pub use case::{Case, cases, cases_where};
pub use felt::{FeltForce, ForceModel, Touch};
pub use figures::{Figures, REST_TICKS, measure, measure_hand};
pub use solid::Solid;
