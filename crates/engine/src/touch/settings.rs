//! What a person can set about touch.

use palpate_device::DeviceLimits;
use palpate_haptics::ball::{BallError, BallShape};
use palpate_haptics::force::{Coupling, ForceLimits};
pub use palpate_haptics::smooth::Smoothing;
use palpate_volume::grid::Grid;
use serde::{Deserialize, Serialize};

use crate::notice::Notice;
use crate::touch::contact_model::Model;

/// Largest force that a mouse presses with [N]: half of what its device bears.
pub const MOST_PRESSURE: f64 = 5.0;

/// How touch feels: the contact model, the spring, the probe and the largest force.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// The contact model.
    pub model: Model,
    /// Of the spring between probe and device [N/mm], > 0, at most 10; segments can have
    /// their own.
    pub stiffness: f64,
    /// Of the damper beside that spring [N·s/mm], 0..=0.1.
    pub damping: f64,
    /// Coulomb coefficient of a probe that sticks, 0..=2; segments can have their own.
    pub friction_static: f64,
    /// Coulomb coefficient of a probe that slides, at most the static one.
    pub friction_kinetic: f64,
    /// Where the force comes from: the stairs of the voxels, their smooth surface, or that of
    /// the scan's values where a threshold made them.
    pub smoothing: Smoothing,
    /// Radius of the probe [mm]; 0 is a point.
    pub probe_radius: f64,
    /// Largest force [N], > 0, at most 40.
    pub force_limit: f64,
    /// Scene mm that the probe goes per mm of the device, 0.1..=10.
    #[serde(default = "no_gain")]
    pub gain: f64,
}

/// Of recordings that are older than the setting.
fn no_gain() -> f64 {
    1.0
}

impl Default for Settings {
    fn default() -> Self {
        let coupling = Coupling::default();
        Self {
            model: Model::default(),
            stiffness: coupling.stiffness,
            damping: coupling.damping,
            friction_static: 0.0,
            friction_kinetic: 0.0,
            smoothing: Smoothing::default(),
            probe_radius: 0.0,
            force_limit: ForceLimits::default().max_force,
            gain: no_gain(),
        }
    }
}

/// Largest radius that is taken [mm]; a scan of small voxels allows less.
pub const MAX_RADIUS: f64 = 20.0;

/// A setting outside its range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{name} is {given}; allowed: {allowed}")]
pub struct SettingsError {
    /// Which setting, with its unit.
    pub name: &'static str,
    /// The value given.
    pub given: f64,
    /// What is allowed.
    pub allowed: &'static str,
}

impl Settings {
    /// The spring and damper that they describe.
    #[must_use]
    pub fn coupling(&self) -> Coupling {
        Coupling {
            stiffness: self.stiffness,
            damping: self.damping,
        }
    }

    /// Checks each value.
    ///
    /// # Errors
    /// [`SettingsError`] names the first value that is not allowed.
    pub fn check(&self) -> Result<(), SettingsError> {
        let rows = [
            (
                "stiffness [N/mm]",
                self.stiffness,
                self.stiffness > 0.0 && self.stiffness <= 10.0,
                "more than 0, at most 10",
            ),
            (
                "damping [N·s/mm]",
                self.damping,
                (0.0..=0.1).contains(&self.damping),
                "0 to 0.1",
            ),
            (
                "static friction",
                self.friction_static,
                (0.0..=2.0).contains(&self.friction_static),
                "0 to 2",
            ),
            (
                "kinetic friction",
                self.friction_kinetic,
                (0.0..=self.friction_static).contains(&self.friction_kinetic),
                "0 to the static friction",
            ),
            (
                "probe radius [mm]",
                self.probe_radius,
                (0.0..=MAX_RADIUS).contains(&self.probe_radius),
                "0 to 20",
            ),
            (
                "force limit [N]",
                self.force_limit,
                self.force_limit > 0.0 && self.force_limit <= 40.0,
                "more than 0, at most 40",
            ),
            (
                "gain",
                self.gain,
                (0.1..=10.0).contains(&self.gain),
                "0.1 to 10",
            ),
        ];
        for (name, given, fits, allowed) in rows {
            if !fits {
                return Err(SettingsError {
                    name,
                    given,
                    allowed,
                });
            }
        }
        Ok(())
    }

    /// What to tell the person where these settings are less than the wanted ones.
    #[must_use]
    pub fn notice_of_limits(&self, wanted: &Self) -> Option<Notice> {
        let Self {
            stiffness,
            force_limit,
            ..
        } = self;
        (self != wanted).then(|| {
            Notice::warning(format!(
                "The device bears less than was asked for: stiffness {stiffness} N/mm, force \
                 {force_limit} N."
            ))
        })
    }

    /// The nearest settings that a device can bear.
    #[must_use]
    pub fn within(self, limits: &DeviceLimits) -> Self {
        Self {
            // a millimetre of the device is `gain` millimetres of the spring
            stiffness: self
                .stiffness
                .min(limits.max_stiffness / self.gain.max(1.0)),
            force_limit: self.force_limit.min(limits.max_force),
            ..self
        }
    }
}

/// Refuses a ball that is too large for the voxels of a grid.
///
/// # Errors
/// [`BallError`] says what fits.
pub fn check_radius(radius: f64, grid: &Grid) -> Result<(), BallError> {
    if radius > 0.0 {
        BallShape::new(radius, grid.spacing())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_out_of_range_are_refused_by_name() {
        let good = Settings::default();
        assert_eq!(good.check(), Ok(()));
        for (bad, name) in [
            (
                Settings {
                    stiffness: 0.0,
                    ..good
                },
                "stiffness [N/mm]",
            ),
            (
                Settings {
                    stiffness: f64::NAN,
                    ..good
                },
                "stiffness [N/mm]",
            ),
            (
                Settings {
                    damping: -0.001,
                    ..good
                },
                "damping [N·s/mm]",
            ),
            (
                Settings {
                    friction_kinetic: 0.1,
                    ..good
                },
                "kinetic friction",
            ),
            (
                Settings {
                    probe_radius: f64::INFINITY,
                    ..good
                },
                "probe radius [mm]",
            ),
            (
                Settings {
                    force_limit: 41.0,
                    ..good
                },
                "force limit [N]",
            ),
            (
                Settings {
                    gain: f64::NAN,
                    ..good
                },
                "gain",
            ),
            (Settings { gain: 10.1, ..good }, "gain"),
        ] {
            assert_eq!(bad.check().unwrap_err().name, name);
        }
    }
}
