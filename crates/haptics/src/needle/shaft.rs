//! The needle along its own line: tip and shaft in balance with the hand.
//!
//! The coupling k holds the device at depth d to a tip at depth a: k (d − a) = T(a) + R(a).
//! T is the force at the tip: the tissue ahead is deflected by a − c, where c is where it stood
//! before, and gives way where that force comes to a threshold: the puncture force before the
//! tip is in, the cutting force afterwards. R is the friction of the shaft, a bristle that
//! bends by up to [`BEND`] in either direction before it slips: so it holds at rest, and goes
//! through zero without a jump where the hand turns back. Both rise with a, so that there is one
//! balance; it is bisected.
//!
//! Depths in mm from the entry along the line, N, N/mm. Sources: Okamura, Simone, O'Leary (2004)
//! for the parts; Canudas de Wit et al., "A new model for control of systems with friction",
//! IEEE Trans. Autom. Control 40 (1995) for the bristle, here without its inertia.

use palpate_volume::tissue::Tissue;
use serde::{Deserialize, Serialize};

/// Largest deflection of the friction bristle before it slips [mm].
pub const BEND: f64 = 0.2;
/// Bisections: 2⁻⁵² of some millimetres.
const BISECTIONS: u32 = 52;
/// Moves of the tip below this are none [mm]: rounding must not move a needle at rest.
const STILL: f64 = 1e-9;

/// Where tip and shaft are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Shaft {
    /// The tip [mm].
    pub tip: f64,
    /// Where the tissue ahead of the tip would be without it [mm].
    pub anchor: f64,
    /// Where the bristle would be straight [mm].
    pub bristle: f64,
}

/// What the tip and the shaft meet in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resistance {
    /// The tissue ahead of the tip; none where nothing is.
    pub tissue: Option<Tissue>,
    /// The most that it holds [N].
    pub threshold: f64,
    /// Friction of the shaft [N].
    pub friction: f64,
    /// Largest depth that the tip can reach [mm]; a wall ends it.
    pub end: f64,
}

impl Shaft {
    /// Force at a tip that comes to a depth [N].
    #[must_use]
    pub fn tip_force(&self, tip: f64, meets: &Resistance) -> f64 {
        let force = |tissue: Tissue| tissue.force(tip - self.anchor);
        meets.tissue.map_or(0.0, force).min(meets.threshold)
    }

    /// Friction of the shaft with the tip at a depth [N]; against the way in where positive.
    #[must_use]
    pub fn friction(&self, tip: f64, meets: &Resistance) -> f64 {
        let bend = ((tip - self.bristle) / BEND).clamp(-1.0, 1.0);
        meets.friction * bend
    }

    /// Brings the tip to where it is in balance with a device at a depth [mm] that a coupling of
    /// stiffness k > 0 [N/mm] holds.
    pub fn press(&mut self, device: f64, k: f64, meets: &Resistance) {
        let surplus =
            |tip: f64| k * (device - tip) - self.tip_force(tip, meets) - self.friction(tip, meets);
        let mut low = device - (meets.threshold.max(0.0) + meets.friction) / k;
        let mut high = device + meets.friction / k;
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if surplus(middle) > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        let tip = high.min(meets.end);
        // false where it is NaN
        if (tip - self.tip).abs() > STILL {
            self.tip = tip;
            self.bristle = self.bristle.clamp(tip - BEND, tip + BEND);
        }
    }
}
