//! From contact to force: coupling spring, friction, what surfaces feel like, and what keeps a
//! force safe.
//!
//! Units: mm, s, N, N/mm. Closed: no allocation, lock, log or panic.

mod coupling;
mod friction;
mod local_force;
mod passivity;
mod safety;
mod surface;

pub use coupling::{Coupling, CouplingError, MAX_DAMPING, MAX_STIFFNESS};
pub use friction::{Friction, FrictionError, FrictionState, MAX_FRICTION};
pub use local_force::LocalForce;
pub use passivity::Passivity;
pub use safety::{ForceLimits, ForceOff, LimitsError, Safety, SafetyCounters, SafetySettings};
pub use surface::{
    Feel, Holders, MAX_HOLDERS, Surface, SurfaceBlend, SurfaceError, Surfaces, Uniform,
};
