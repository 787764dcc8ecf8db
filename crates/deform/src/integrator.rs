//! How particles move: velocity Verlet in scaled and in physical time.
pub mod verlet;
pub use verlet::VelocityVerlet;
