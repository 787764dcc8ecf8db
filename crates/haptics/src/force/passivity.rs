//! The last resort against energy from nowhere: an observer of what the device was given, and
//! a controller that takes it back.
//!
//! Sampling, delay and changes of what is touched make a spring give back more than it took.
//! The observer adds up the work of the motors on the device and what the spring has stored
//! since; together they may never exceed what the device's own friction has eaten. What does
//! exceed is taken back on the way out: the force is smaller by the excess over a short way.
//! A wall within the limit of Colgate & Schenkel, b > K (T/2 + t_d), has no excess, and nothing
//! is done to it. Energy that a contact has eaten is credit; no more of it is kept than the
//! spring holds now, so that a long rub pays for no later kick, and forces whose spring is not
//! exactly what they were made of (smoothed, on rough bodies) are not held against the hand.
//!
//! Nothing changes at rest: the controller acts only where the device moves outward.
//!
//! Units: N, mm, N·mm. Frame: the device's.
//! Source: Hannaford & Ryu, "Time-domain passivity control of haptic interfaces", IEEE Trans.
//! Robotics and Automation 18 (2002), with the energy of the spring as reference, as in Ryu,
//! Preusche, Hannaford, Hirzinger, "Time domain passivity control with reference energy
//! following", IEEE Trans. Control Systems Technology 13 (2005).

use glam::DVec3;

/// Credit that is kept without a spring [N·mm]: what rounding and encoders shuffle to and fro.
const LEAST_CREDIT: f64 = 0.05;
/// Way over which an excess is taken back [mm].
const TAKE_BACK_WAY: f64 = 0.2;
/// Damping by which it is taken back, at most [N·s/mm]: below half of m/T for an arm of 45 g at
/// 1 kHz, so that the controller itself does not shake the device.
const MOST_DAMPING: f64 = 0.02;

/// Observer and controller.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Passivity {
    /// Energy that came from nowhere [N·mm]; below zero it is credit.
    excess: f64,
    /// Energy stored in the spring after the last tick [N·mm].
    stored: f64,
    /// What the controller has taken out of forces so far, in ticks.
    acted: u64,
}

impl Passivity {
    /// Observes one tick: the motors' force [N] while the device moved by `moved` [mm], what
    /// its own friction ate meanwhile, and what the spring holds now [N·mm]. What friction eats
    /// where no force acts was paid by the hand, and counts for no contact.
    pub fn observe(&mut self, acting: DVec3, moved: DVec3, eaten: f64, stored: f64) {
        let eaten = if acting == DVec3::ZERO { 0.0 } else { eaten };
        let given = acting.dot(moved) + (stored - self.stored) - eaten;
        self.stored = stored;
        // a reading that is no number is none
        if given.is_finite() {
            self.excess = (self.excess + given).max(-LEAST_CREDIT - stored);
        } else {
            *self = Self {
                acted: self.acted,
                ..Self::default()
            };
        }
    }

    /// The force to send for a wanted one [N], after a move by `moved` [mm] in `dt` [s]: smaller
    /// on the way out, where there is an excess.
    pub fn control(&mut self, wanted: DVec3, moved: DVec3, dt: f64) -> DVec3 {
        let length = wanted.length();
        if self.excess <= 0.0 || length == 0.0 || moved.dot(wanted) <= 0.0 {
            return wanted;
        }
        self.acted += 1;
        let outward = moved.dot(wanted) / length;
        let less = (self.excess / TAKE_BACK_WAY).min(MOST_DAMPING * outward / dt);
        let left = (length - less).max(0.0);
        wanted * (left / length)
    }

    /// Energy that came from nowhere and was not taken back [N·mm].
    #[must_use]
    pub fn excess(&self) -> f64 {
        self.excess.max(0.0)
    }

    /// Ticks in which a force was made smaller.
    #[must_use]
    pub fn acted(&self) -> u64 {
        self.acted
    }

    /// Begins anew, where another session of forces does.
    pub fn forget(&mut self) {
        *self = Self {
            acted: self.acted,
            ..Self::default()
        };
    }
}
