//! Where particles are: in open space, or in a box that repeats itself (for bulk values).

use glam::DVec3;

/// The space of a simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Space {
    /// Without an end.
    Open,
    /// A box from the origin with these sides that repeats itself along every axis.
    Periodic(DVec3),
}

impl Space {
    /// Sides of the box; zero where there is none.
    pub fn sides(&self) -> DVec3 {
        match *self {
            Self::Open => DVec3::ZERO,
            Self::Periodic(sides) => sides,
        }
    }

    /// The shortest of all equal offsets.
    pub fn nearest(&self, offset: DVec3) -> DVec3 {
        match *self {
            Self::Open => offset,
            Self::Periodic(sides) => offset - sides * (offset / sides).round(),
        }
    }
}
