//! How a needle comes into a surface that it presses: along the push, or along a direction that was
//! set.
//!
//! A sharp tip does not slide as long as the push is within the cone of its friction. Where a
//! direction is set, the needle goes in by what of the push is along it, if the push lies within
//! that cone around it and the direction leads into what is touched; else it only presses.
//!
//! Frame: scene [mm].

use glam::DVec3;

use super::tissues::{Layered, TissueMap, World};
use super::track::{Line, Track};

/// Friction of a tip that sticks where it touches, unless it is pushed nearly along the surface.
pub const TIP_STICKS: f64 = 2.0;
/// What is touched begins so near the entry, along the needle [smallest spacings]: the smooth
/// surface may stand a voxel's diagonal before it.
const NEAR: f64 = 2.0;

/// A direction of length 1; none where it is none.
#[must_use]
pub fn unit(direction: DVec3) -> Option<DVec3> {
    direction.is_finite().then(|| direction.try_normalize())?
}

/// A needle that presses.
#[derive(Clone, Copy, Debug)]
pub struct Approach {
    /// Where it touches, and the way that it is pushed.
    pub push: Line,
    /// The direction that was set; none where it is that of the push.
    pub set: Option<DVec3>,
}

impl Approach {
    /// The share of the push that is along the needle; 0 where it slides instead of going in.
    #[must_use]
    pub fn share(&self) -> f64 {
        let Some(direction) = self.set else {
            return 1.0;
        };
        let share = direction.dot(self.push.direction);
        let least = 1.0 / (1.0 + TIP_STICKS * TIP_STICKS).sqrt();
        // written so that NaN is none
        if share >= least { share } else { 0.0 }
    }

    /// The line that it goes in on, and the layer that it comes into first, `pressed` where the
    /// needle is along the push; none where the line does not lead into what is pressed.
    #[must_use]
    pub fn way_in(
        &self,
        (place, pressed): (u8, Layered),
        spacing: f64,
        world: &World<'_, impl TissueMap>,
    ) -> Option<(Line, Layered)> {
        let Some(direction) = self.set else {
            return Some((self.push, pressed));
        };
        let line = Line {
            direction,
            ..self.push
        };
        let mut ahead = Track::default();
        ahead.look(&line, NEAR * spacing, world);
        let layer = ahead.entered().filter(|layer| layer.has(place))?;
        Some((line, layer))
    }
}
