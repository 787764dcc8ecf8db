//! What keeps apart what is not bonded: the repulsive part of Lennard-Jones (WCA), made linear
//! where it would grow too stiff to relax.
//!
//! Source: Weeks, Chandler & Andersen, J. Chem. Phys. 54 (1971); thesis 5.16, and 5.20 for the
//! limit (thesis errata, section 4: the force stays a function of the distance alone, and so
//! conservative).

/// Share of the range below which the force grows linearly.
const LINEAR_BELOW: f64 = 0.9;

/// Largest stiffness of a contact over that at its range: (13/6) x^14 - (7/6) x^8 at 1/0.9.
pub(super) const LARGEST_STIFFNESS: f64 = 6.761;

/// Force with which two bodies push each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Push {
    /// Force [N]; 0 beyond the range.
    pub force: f64,
    /// Decrease of the force with the distance [N/mm]; 0 beyond the range.
    pub stiffness: f64,
}

/// Push at a distance [mm], of any sign, with the range and the stiffness there [N/mm].
#[inline]
pub(super) fn contact_push(distance: f64, range: f64, stiffness: f64) -> Push {
    if distance >= range {
        return Push {
            force: 0.0,
            stiffness: 0.0,
        };
    }
    let curved = distance.max(LINEAR_BELOW * range);
    let x = range / curved;
    let x2 = x * x;
    let x6 = x2 * x2 * x2;
    let slope = stiffness / 6.0 * (13.0 * x6 * x6 * x2 - 7.0 * x6 * x2);
    Push {
        force: stiffness * range / 6.0 * (x6 * x6 * x - x6 * x) + slope * (curved - distance),
        stiffness: slope,
    }
}
