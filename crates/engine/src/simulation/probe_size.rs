//! How large the probe is: as it was set, or in soft tissue at least as large as a small fingertip.
//!
//! A ball that is small beside the distance of a model's nodes gets between them: tissue that was
//! pressed slips around it and pushes back no more. Of 1 spacing it does so at a depth of 4 to 5
//! spacings, of 1.5 at 7; of 2 not at 10 (`crates/deform/tests/lattice_depth.rs` keeps the last).
//!
//! In voxels below 0.6 mm the ball is smaller than a fingertip, as large as a model's box has room
//! for. A segment with a finer grid of its own allows as much as touch can follow there.

use palpate_haptics::ball::BallShape;

use super::Simulation;
use crate::deformable::has_soft_segments;
use crate::servo::ServoCommand;
use crate::touch::{MAX_RADIUS, Settings};

/// Radius of the ball that presses soft tissue, at least [mm].
const FINGERTIP: f64 = 3.0;
/// The same in spacings of the model: what is smaller slips between its nodes, and what is larger
/// does not fit well into its box.
const SPACINGS: [f64; 2] = [2.0, 5.0];

impl Simulation {
    /// The settings as the servo has them: those that were set, with the probe's present radius.
    pub(super) fn touch_settings(&self) -> Settings {
        Settings {
            probe_radius: self.probe_radius(),
            ..self.settings
        }
    }

    /// The radius that the probe is to have [mm].
    pub(super) fn probe_radius(&self) -> f64 {
        let wanted = self.settings.probe_radius;
        if !self.presses_soft_tissue() {
            return wanted;
        }
        let spacing = self.voxels().grid().smallest_spacing();
        let [least, most] = SPACINGS.map(|count| count * spacing);
        let soft = FINGERTIP.clamp(least, most);
        let grids = self
            .scene
            .segments()
            .filter_map(|(_, segment, _)| segment.own_grid());
        let largest = grids.map(|grid| BallShape::largest_radius(grid.spacing()));
        wanted.max(largest.fold(soft.min(MAX_RADIUS), f64::min))
    }

    /// Whether a model is on that the probe may press, and no tool works with a size of its own.
    fn presses_soft_tissue(&self) -> bool {
        self.deformation.now().model.is_some()
            && !self.stroke.sets_the_size()
            && !self.touch.needle().on
            && has_soft_segments(&self.scene)
    }

    /// Has touch follow where the probe is to have another radius.
    pub(super) fn follow_probe_radius(&mut self) {
        if self.probe_radius() != self.touch.radius() {
            self.send_settings();
        }
    }

    /// Sends the settings, with the probe's present radius.
    pub(super) fn send_settings(&mut self) {
        let settings = self.touch_settings();
        self.touch.set_radius(settings.probe_radius);
        self.touch.send(ServoCommand::Settings(settings));
    }
}
