//! The forces of the thesis' models as printed: a coupling spring and a friction force.
//!
//! F = F_c + F_fr, F_c = k (p₂ − d₂). The spring acts also where the proxy is only late, since
//! w_max was used up: the listings do not ask for a contact. What the friction gets wrong, by
//! the errata of the thesis:
//! - 4.6 (4.3): −(p₁ − p₂) is the direction of motion, so the "friction" drives the hand;
//! - 4.6 (4.3): N_bv/w is a number over a length and not bounded by 1;
//! - both: the part of F_c across the motion is taken as |F_c| − |F_c·v|, where it is
//!   √(|F_c|² − (F_c·v)²): at 5° 4 % of the true part, at 45° 41 %, right only at 90°;
//! - both: without motion there is no friction, so that nothing sticks; and with the proxy of
//!   4.8, which walks to and fro at rest, a hand at rest feels full friction anywhere.
//!
//! Bounded here: a quotient 0/0 is no friction, N_bv/w is at most 2 (a slide goes half a voxel
//! at least, unless w_max cuts it), and a force that is not finite is none. The way is the
//! number of slides, each of which ends in a border voxel; straight moves count for w only.
//!
//! Frame: the grid's axes in mm; directions are taken in mm, quotients of lengths in voxels, as
//! the models measure. Source: R. Vlasov, thesis (2016), 4.6 (4.1 to 4.4) and 4.9 (4.5).

use crate::contact::{ForceInput, SlidePath};
use glam::DVec3;

/// Largest N_bv/w.
const MOST_VOXELS_PER_LENGTH: f64 = 2.0;

/// The force of 4.6 [N].
pub(crate) fn force_original(input: &ForceInput<'_>) -> DVec3 {
    let path = input.contact.path.unwrap_or_default();
    let share = quotient(f64::from(path.border_voxels), path.length).min(MOST_VOXELS_PER_LENGTH);
    // −(p₁ − p₂), as printed: along the motion
    let direction = direction_in_mm(input, path.moved);
    force(input, direction, direction, share)
}

/// The force of 4.9 [N].
pub(crate) fn force_improved(input: &ForceInput<'_>) -> DVec3 {
    let path: SlidePath = input.contact.path.unwrap_or_default();
    let share = quotient(path.border_length, path.length).min(1.0);
    let along = direction_in_mm(input, path.border_sum);
    force(input, along, -along, share)
}

/// The spring, and friction in a direction by the spring's part across `along`.
fn force(input: &ForceInput<'_>, along: DVec3, direction: DVec3, share: f64) -> DVec3 {
    let spacing = input.grid.spacing();
    let spring = (input.proxy_in_grid - input.device_in_grid) * spacing * input.stiffness;
    // as printed; Pythagoras would be right
    let across = (spring.length() - spring.dot(along).abs()).max(0.0);
    let friction = direction * (across * input.friction * share);
    let force = spring + friction;
    if force.is_finite() {
        force
    } else {
        DVec3::ZERO
    }
}

fn direction_in_mm(input: &ForceInput<'_>, way: DVec3) -> DVec3 {
    (way * input.grid.spacing())
        .try_normalize()
        .unwrap_or(DVec3::ZERO)
}

/// A quotient of two lengths; 0 for 0/0.
fn quotient(above: f64, below: f64) -> f64 {
    if below > 0.0 { above / below } else { 0.0 }
}
