//! A drive that goes straight in at a constant speed until the force comes to a limit or the way
//! ends, rests, and goes out again.
//!
//! Travel is mm along the drive's line from its start.

use glam::DVec3;

use crate::error::SessionError;
use crate::scenario::rig::{LONGEST, RATE_HZ};
use crate::servo::TickRecord;
use crate::session::check_point;
use crate::touch::Settings;

/// Ticks of a drive, at most.
const MOST_TICKS: f64 = 5e6;

/// How a tool is driven.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Where the tool begins [mm], in a free voxel.
    pub start: DVec3,
    /// Where it goes to, unless the force stops it [mm].
    pub target: DVec3,
    /// How fast [mm/s], > 0.
    pub speed: f64,
    /// The force at which it stops [N], > 0.
    pub force_limit: f64,
    /// How long it rests before it goes out again [s].
    pub rest_secs: f64,
    /// Of the spring between drive and tool [N/mm].
    pub stiffness: f64,
}

impl Drive {
    /// From a point to another one, as fast and as hard as a person would.
    #[must_use]
    pub fn between(start: DVec3, target: DVec3) -> Self {
        Self {
            start,
            target,
            speed: 5.0,
            force_limit: 6.0,
            rest_secs: 1.0,
            stiffness: Settings::default().stiffness,
        }
    }

    /// Its way in, of length 1.
    #[must_use]
    pub fn direction(&self) -> DVec3 {
        (self.target - self.start).normalize_or_zero()
    }

    /// The settings of touch that it needs, for a probe of a radius [mm].
    #[must_use]
    pub fn settings(&self, probe_radius: f64) -> Settings {
        Settings {
            stiffness: self.stiffness,
            force_limit: self.force_limit,
            probe_radius,
            ..Settings::default()
        }
    }

    /// Refuses what is no drive.
    ///
    /// # Errors
    /// [`SessionError`] says what is allowed.
    pub fn check(&self) -> Result<(), SessionError> {
        check_point("start", self.start)?;
        check_point("target", self.target)?;
        self.settings(0.0).check()?;
        let way = self.start.distance(self.target);
        let ticks = way / self.speed * f64::from(RATE_HZ);
        let is_way = way > 0.0 && way <= LONGEST;
        let is_speed = self.speed > 0.0 && ticks <= MOST_TICKS;
        if is_way && is_speed && (0.0..=3600.0).contains(&self.rest_secs) {
            Ok(())
        } else {
            Err(SessionError::Drive {
                way,
                speed: self.speed,
                rest: self.rest_secs,
            })
        }
    }

    /// Goes in, rests and goes out; each tick is told what the drive does and how far it is, and
    /// says whether it is to go in further.
    pub(super) fn run(&self, mut tick: impl FnMut(Phase, f64) -> bool) {
        let way = self.start.distance(self.target);
        let step = self.speed / f64::from(RATE_HZ);
        let mut travel = 0.0;
        while tick(Phase::In, travel) && travel < way {
            travel = (travel + step).min(way);
        }
        let rest = (self.rest_secs * f64::from(RATE_HZ)).round() as u64;
        for _ in 0..rest {
            tick(Phase::Rest, travel);
        }
        while travel > 0.0 {
            travel = (travel - step).max(0.0);
            tick(Phase::Out, travel);
        }
    }
}

/// What the drive does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Goes in.
    In,
    /// Rests.
    Rest,
    /// Goes out.
    Out,
}

impl Phase {
    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::In => "in",
            Self::Rest => "rest",
            Self::Out => "out",
        }
    }
}

/// One tick of a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// When [s].
    pub time: f64,
    /// What the drive does.
    pub phase: Phase,
    /// How far the drive is [mm].
    pub travel: f64,
    /// Where the tool is [mm]: behind the drive by what the spring between them gives.
    pub tool: DVec3,
    /// How far the tool is along the drive's line [mm].
    pub tip: f64,
    /// How far the hard probe is along it [mm].
    pub probe: f64,
    /// Force on the drive [N], against its way in where positive.
    pub force: f64,
    /// Size of the force across the way [N].
    pub across: f64,
    /// The segment at the tool; 0 where there is none.
    pub segment: u8,
}

impl Sample {
    /// What a tick felt, with the tool where the contact has it.
    pub(super) fn of(
        drive: &Drive,
        (phase, travel): (Phase, f64),
        record: &TickRecord,
        segment: u8,
    ) -> Self {
        let direction = drive.direction();
        let force = -record.force.dot(direction);
        Self {
            time: record.time,
            phase,
            travel,
            tool: record.contact_point,
            tip: (record.contact_point - drive.start).dot(direction),
            probe: (record.proxy - drive.start).dot(direction),
            force,
            across: (record.force + direction * force).length(),
            segment,
        }
    }

    /// The same with the tool elsewhere [mm].
    pub(super) fn with_tool(self, drive: &Drive, tool: DVec3) -> Self {
        Self {
            tool,
            tip: (tool - drive.start).dot(drive.direction()),
            ..self
        }
    }
}
