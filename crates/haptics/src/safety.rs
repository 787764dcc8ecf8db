//! The last stage before a device: whatever is wanted, what is sent is safe.
//!
//! In this order: a force that is not finite becomes zero; the magnitude is cut, the
//! direction kept; growth and change of direction are slew-limited. A fall toward zero is
//! never limited, and what is sent never points against what is wanted.
//!
//! Units: N, N/s, s. Each intervention is counted.

use glam::DVec3;

/// How much force, and how fast it may grow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceLimits {
    /// Largest magnitude [N].
    pub max_force: f64,
    /// Largest rate of growth and of change of direction [N/s].
    pub max_growth: f64,
}

impl Default for ForceLimits {
    fn default() -> Self {
        Self {
            // three times what a desktop device holds for long; a device's own limit is
            // put in its place
            max_force: 10.0,
            // a tap of 1 m/s on the default wall of 1 N/mm passes untouched: a limit that
            // acts in normal contacts would take force on the way in only, and so give
            // the hand energy
            max_growth: 1000.0,
        }
    }
}

/// Why limits cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LimitsError {
    /// No force can be sent under it.
    #[error("force limit is {0} N; allowed: finite, > 0")]
    MaxForce(f64),
    /// No force can grow under it.
    #[error("slew limit is {0} N/s; allowed: finite, > 0")]
    MaxGrowth(f64),
}

impl ForceLimits {
    /// Checks both figures, for values that a person gave.
    pub fn check(&self) -> Result<(), LimitsError> {
        if !(self.max_force > 0.0 && self.max_force.is_finite()) {
            return Err(LimitsError::MaxForce(self.max_force));
        }
        if !(self.max_growth > 0.0 && self.max_growth.is_finite()) {
            return Err(LimitsError::MaxGrowth(self.max_growth));
        }
        Ok(())
    }
}

/// How often the stage had to act.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SafetyCounters {
    /// Forces cut to the largest magnitude.
    pub clamped: u64,
    /// Forces held back in growth or turn.
    pub slewed: u64,
    /// Forces that were not finite.
    pub not_finite: u64,
}

/// The stage: the limits, the last force sent and the counters.
#[derive(Clone, Debug, Default)]
pub struct Safety {
    limits: ForceLimits,
    sent: DVec3,
    counters: SafetyCounters,
}

impl Safety {
    /// A stage that has sent nothing yet. Limits that are no numbers let nothing through.
    pub fn new(limits: ForceLimits) -> Self {
        Self {
            limits,
            ..Self::default()
        }
    }

    /// Changes the limits; a force above a new one falls at the next tick.
    pub fn set_limits(&mut self, limits: ForceLimits) {
        self.limits = limits;
    }

    /// How often the stage acted since the start.
    pub fn counters(&self) -> SafetyCounters {
        self.counters
    }

    /// The force sent last [N].
    pub fn sent(&self) -> DVec3 {
        self.sent
    }

    /// The force to send [N] for a wanted one [N], `dt` [s] after the last.
    pub fn limit(&mut self, wanted: DVec3, dt: f64) -> DVec3 {
        let finite = self.finite(wanted);
        let clamped = self.clamped(finite);
        self.sent = self.slewed(clamped, dt);
        self.sent
    }

    /// Forces nothing: at a stop, a fault or a late servo.
    pub fn release(&mut self) -> DVec3 {
        self.sent = DVec3::ZERO;
        self.sent
    }

    fn finite(&mut self, wanted: DVec3) -> DVec3 {
        if wanted.is_finite() {
            return wanted;
        }
        self.counters.not_finite += 1;
        DVec3::ZERO
    }

    fn clamped(&mut self, wanted: DVec3) -> DVec3 {
        // scaled by the largest component first, so that no square overflows
        let largest = wanted.abs().max_element();
        if largest == 0.0 {
            return DVec3::ZERO;
        }
        let scaled = wanted / largest;
        let length = scaled.length();
        if length * largest <= self.limits.max_force {
            return wanted;
        }
        self.counters.clamped += 1;
        // rounding must not lift it above the limit; a limit that is no number is 0
        let allowed = (self.limits.max_force * (1.0 - 1e-15)).max(0.0);
        scaled * (allowed / length)
    }

    fn slewed(&mut self, wanted: DVec3, dt: f64) -> DVec3 {
        // what falls, falls at once: the part of the last force that points against the
        // wanted one, and all that is longer than it
        let start = not_against(self.sent, wanted).clamp_length_max(wanted.length());

        // the rest of the way, growth and turn, at a limited rate
        let way = wanted - start;
        let distance = way.length();
        let allowed = (self.limits.max_growth * dt).max(0.0);
        if distance <= allowed {
            return wanted;
        }
        self.counters.slewed += 1;
        start + way * (allowed / distance)
    }
}

/// `force` without its part against `wanted`.
fn not_against(force: DVec3, wanted: DVec3) -> DVec3 {
    let along = force.dot(wanted);
    let square = wanted.length_squared();
    if along >= 0.0 {
        return force;
    }
    // a wanted force too small to square, or none: nothing is kept
    if square == 0.0 {
        return DVec3::ZERO;
    }
    force - wanted * (along / square)
}
