//! The last stage before a device: whatever is wanted, what is sent is safe.
//!
//! In this order: a force that is not finite becomes zero; nothing is sent until the force
//! that is wanted is small; the magnitude is cut, the direction kept; after the start the
//! force is faded in; what motors bear for a while only falls to what they bear for long;
//! growth and change of direction are slew-limited. A fall toward zero is never limited, and
//! what is sent never points against what is wanted.
//!
//! Units: N, N/s, s. Each intervention is counted in ticks, and why no force is sent is told.

use glam::DVec3;

/// The average force, in parts of the continuous one, from where on large forces are cut.
const WARM: f64 = 0.8;

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
    /// The largest force is not above zero: no force could be sent.
    #[error("force limit is {0} N; allowed: finite, > 0")]
    MaxForce(f64),
    /// The largest growth is not above zero: no force could grow.
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

/// How forces begin, and how long large ones last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SafetySettings {
    /// Forces are faded in over this time [s], from the first small one on.
    pub ramp_secs: f64,
    /// Forces begin when the wanted one is smaller than this [N]: a hand that stands in an
    /// obstacle already is not thrown out.
    pub start_below: f64,
    /// What the device bears for any length of time [N].
    pub continuous_force: f64,
    /// Time constant of the average that is held against it [s].
    pub continuous_secs: f64,
    /// Whether energy from nowhere is taken back, see `passivity.rs`.
    pub take_back: bool,
}

impl Default for SafetySettings {
    /// For any device that moves; the device's own continuous force is put in its place.
    fn default() -> Self {
        Self {
            // as the rules for drivers ask
            ramp_secs: 2.0,
            start_below: 0.2,
            continuous_force: f64::INFINITY,
            // far below the thermal time constants of such motors, which are minutes
            continuous_secs: 5.0,
            take_back: true,
        }
    }
}

impl SafetySettings {
    /// Forces at once and for ever: for devices that are paths on paper, and for tests.
    pub const AT_ONCE: Self = Self {
        ramp_secs: 0.0,
        start_below: f64::INFINITY,
        continuous_force: f64::INFINITY,
        continuous_secs: 5.0,
        take_back: true,
    };
}

/// Why no force is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum ForceOff {
    /// No force was computed yet.
    NotStarted = 1,
    /// The force that is wanted was never small since the start: the hand stands in an
    /// obstacle and must come out first.
    Waiting = 2,
    /// The newest force is too old: the servo is late or gone.
    ServoLate = 3,
    /// The session has ended.
    Stopped = 4,
    /// The force that is wanted is not finite.
    NotFinite = 5,
}

impl ForceOff {
    /// All reasons.
    pub const ALL: [Self; 5] = [
        Self::NotStarted,
        Self::Waiting,
        Self::ServoLate,
        Self::Stopped,
        Self::NotFinite,
    ];

    /// Its name, for messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::NotStarted => "not-started",
            Self::Waiting => "waiting",
            Self::ServoLate => "servo-late",
            Self::Stopped => "stopped",
            Self::NotFinite => "not-finite",
        }
    }

    /// The cause of a number that was made by `as u8`; 0 is none.
    #[must_use]
    pub fn of_number(number: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|cause| *cause as u8 == number)
    }
}

/// In how many ticks the stage had to act.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SafetyCounters {
    /// Forces cut to the largest magnitude.
    pub clamped: u64,
    /// Forces held back in growth or turn.
    pub slewed: u64,
    /// Forces that were not finite.
    pub not_finite: u64,
    /// Forces faded in after the start.
    pub ramped: u64,
    /// Forces not sent, since none was small yet.
    pub waited: u64,
    /// Forces cut toward what the device bears for long.
    pub eased: u64,
}

/// The stage: settings, the last force sent, and the counters.
#[derive(Clone, Debug)]
pub struct Safety {
    limits: ForceLimits,
    settings: SafetySettings,
    /// Time since the first small force [s]; none before it.
    begun: Option<f64>,
    /// The force sent, averaged over the last seconds [N].
    average: f64,
    eases: bool,
    off: Option<ForceOff>,
    sent: DVec3,
    counters: SafetyCounters,
}

impl Default for Safety {
    fn default() -> Self {
        Self::new(ForceLimits::default())
    }
}

impl Safety {
    /// A stage that sends forces at once. Limits that are no numbers let nothing through.
    #[must_use]
    pub fn new(limits: ForceLimits) -> Self {
        Self::starting(limits, SafetySettings::AT_ONCE)
    }

    /// A stage whose forces begin as the settings say.
    #[must_use]
    pub fn starting(limits: ForceLimits, settings: SafetySettings) -> Self {
        Self {
            limits,
            settings,
            begun: None,
            average: 0.0,
            eases: false,
            off: Some(ForceOff::NotStarted),
            sent: DVec3::ZERO,
            counters: SafetyCounters::default(),
        }
    }

    /// Changes the limits; a force above a new one falls at the next tick.
    pub fn set_limits(&mut self, limits: ForceLimits) {
        self.limits = limits;
    }

    /// In how many ticks the stage acted since the start.
    #[must_use]
    pub fn counters(&self) -> SafetyCounters {
        self.counters
    }

    /// Why no force is sent; none while forces are on.
    #[must_use]
    pub fn off(&self) -> Option<ForceOff> {
        self.off
    }

    /// Fraction of the wanted force that is sent while forces ramp up after the start, 0 to 1.
    #[must_use]
    pub fn share(&self) -> f64 {
        let Some(begun) = self.begun else {
            return 0.0;
        };
        if begun >= self.settings.ramp_secs {
            return 1.0;
        }
        (begun / self.settings.ramp_secs).max(0.0)
    }

    /// The largest force that is sent now [N].
    #[must_use]
    pub fn largest(&self) -> f64 {
        let max_force = self.limits.max_force.max(0.0);
        // a limit that is no number is 0
        let continuous = self.settings.continuous_force.max(0.0);
        let warm = WARM * continuous;
        if self.average < warm || continuous >= max_force {
            return max_force;
        }
        // from the largest force where the average begins to matter, to what can be held
        let rest = ((continuous - self.average) / (continuous - warm)).max(0.0);
        continuous + (max_force - continuous) * rest
    }

    /// Whether the force sent last was cut toward what the device bears for long.
    #[must_use]
    pub fn eases(&self) -> bool {
        self.eases
    }

    /// The force sent last [N].
    #[must_use]
    pub fn sent(&self) -> DVec3 {
        self.sent
    }

    /// The force to send [N] for a wanted one [N], `dt` [s] after the last.
    pub fn limit(&mut self, wanted: DVec3, dt: f64) -> DVec3 {
        self.off = None;
        let finite = self.finite(wanted);
        let begun = self.begun(finite);
        let clamped = self.clamped(begun);
        let faded = self.faded(clamped, dt);
        let bearable = self.bearable(faded);
        self.sent = self.slewed(bearable, dt);
        self.average(dt);
        self.sent
    }

    /// Forces nothing: at a stop, a fault or a late servo. What was borne is not forgotten.
    pub fn release(&mut self, cause: ForceOff, dt: f64) -> DVec3 {
        self.off = Some(cause);
        self.sent = DVec3::ZERO;
        self.average(dt);
        self.sent
    }

    /// Nothing until the first force that is small.
    fn begun(&mut self, wanted: DVec3) -> DVec3 {
        if self.begun.is_some() || self.off.is_some() {
            return wanted;
        }
        let start_below = self.settings.start_below;
        if start_below == f64::INFINITY || wanted.length() < start_below {
            self.begun = Some(0.0);
            return wanted;
        }
        self.off = Some(ForceOff::Waiting);
        self.counters.waited += 1;
        DVec3::ZERO
    }

    /// Faded in from the first small force on.
    fn faded(&mut self, wanted: DVec3, dt: f64) -> DVec3 {
        let share = self.share();
        if share == 1.0 {
            return wanted;
        }
        // time that is none does not pass
        self.begun = self.begun.map(|begun| begun + dt.max(0.0));
        if wanted != DVec3::ZERO {
            self.counters.ramped += 1;
        }
        wanted * share
    }

    /// Below what motors bear for a while; the more of it they have borne, the less is left.
    fn bearable(&mut self, wanted: DVec3) -> DVec3 {
        let allowed = self.largest();
        let length = wanted.length();
        // what is cut already is only rounded here
        self.eases = allowed < self.limits.max_force && length > allowed;
        if !self.eases {
            return wanted;
        }
        self.counters.eased += 1;
        wanted * (allowed / length)
    }

    /// Follows what is sent, with the time constant of the settings.
    fn average(&mut self, dt: f64) {
        let dt = dt.max(0.0);
        let share = dt / (self.settings.continuous_secs.max(0.0) + dt);
        if share > 0.0 {
            self.average += (self.sent.length() - self.average) * share;
        }
    }

    fn finite(&mut self, wanted: DVec3) -> DVec3 {
        if wanted.is_finite() {
            return wanted;
        }
        self.off = Some(ForceOff::NotFinite);
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
