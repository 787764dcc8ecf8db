//! What a session begins with, and what of it is allowed.

use glam::DVec3;
use palpate_device::HapticDevice;
use palpate_haptics::force::SafetySettings;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;

use crate::error::SessionError;
use crate::scene::Properties;
use crate::touch::{Settings, check_radius};

/// Farthest point that a session takes [mm].
const POINT_LIMIT: f64 = 1e6;
/// How the device moves the probe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reference {
    /// The device begins at the start point and moves along the axes of the view.
    View,
    /// The device's frame is the scene: for paths written in scene mm.
    Scene,
}

/// What a session begins with.
pub struct SessionConfig {
    /// Where the scan stands.
    pub grid: Grid,
    /// Its values.
    pub intensities: Intensities,
    /// Segments that are there from the start.
    pub segments: Vec<(Segment, Properties)>,
    /// The device.
    pub device: Box<dyn HapticDevice>,
    /// How it moves the probe.
    pub reference: Reference,
    /// Where the probe begins; none is in front of the scan.
    pub start: Option<DVec3>,
    /// Stiffness, damping and largest force.
    pub settings: Settings,
    /// Rate of the servo [Hz].
    pub rate_hz: u32,
    /// Rate of the device [Hz]; none is the servo's.
    pub device_rate_hz: Option<u32>,
    /// How forces begin and how long large ones last. None is as for any device that moves
    /// where threads run in real time, and forces at once where they do not.
    pub safety: Option<SafetySettings>,
    /// Whether threads run in real time; else the owner steps the session.
    pub real_time: bool,
    /// Whether masks are felt by occupancy fractions that are worked out from their bits, so that
    /// flat slopes have no terraces.
    pub mask_fractions: bool,
}

impl SessionConfig {
    /// A session of a scan with a device, with everything else as it is by default.
    #[must_use]
    pub fn new(grid: Grid, intensities: Intensities, device: Box<dyn HapticDevice>) -> Self {
        Self {
            grid,
            intensities,
            segments: Vec::new(),
            device,
            reference: Reference::View,
            start: None,
            settings: Settings::default(),
            rate_hz: 1000,
            device_rate_hz: None,
            safety: None,
            real_time: true,
            mask_fractions: true,
        }
    }
}

impl SessionConfig {
    /// Rate of the device [Hz].
    #[must_use]
    pub fn device_rate_hz(&self) -> u32 {
        self.device_rate_hz.unwrap_or(self.rate_hz)
    }

    /// How forces begin and how long large ones last.
    #[must_use]
    pub fn safety(&self) -> SafetySettings {
        let by_pace = if self.real_time {
            SafetySettings::default()
        } else {
            SafetySettings::AT_ONCE
        };
        self.safety.unwrap_or(by_pace)
    }
}

/// Refuses a configuration that is not allowed.
pub(crate) fn check(config: &SessionConfig) -> Result<(), SessionError> {
    for rate_hz in [config.rate_hz, config.device_rate_hz()] {
        if !(500..=10_000).contains(&rate_hz) {
            return Err(SessionError::Rate(rate_hz));
        }
    }
    config.settings.check()?;
    let own_grids = config
        .segments
        .iter()
        .filter_map(|(segment, _)| segment.own_grid());
    for grid in own_grids.chain([&config.grid]) {
        check_radius(config.settings.probe_radius, grid)?;
    }
    if let Some(start) = config.start {
        check_point("start", start)?;
    }
    Ok(())
}

/// Refuses a point that is not finite or absurdly far away.
pub fn check_point(name: &'static str, given: DVec3) -> Result<(), SessionError> {
    // written so that NaN is refused
    if given.abs().cmple(DVec3::splat(POINT_LIMIT)).all() {
        return Ok(());
    }
    Err(SessionError::Point {
        name,
        given,
        limit: POINT_LIMIT,
    })
}
