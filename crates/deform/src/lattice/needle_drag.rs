//! A needle that leads the nodes of tissue around it: those ahead of its tip and those along its shaft.
//!
//! The needle's own law knows how far it presses tissue in and how far friction carries it; a force on
//! a point would move nodes without a bound, so displacements are given. Around the tip they fall off
//! as those of a blunt point force do, with 1/r far away: the blunter, the deeper it presses, so that
//! tissue is nowhere folded. Farther from the needle the lattice alone tells.

use glam::DVec3;

use super::driven::DrivenNode;
use super::nodes::Lattice;

/// Tissue is shown pressed in by no more than this [mm]: what the box around the tip has room for.
pub const DEEPEST: f64 = 5.0;
/// Tissue is carried along the shaft by no more than this [mm].
pub const CARRIED: f64 = 0.5;
/// Radius of the blunt tip, least [spacings], and over how far it presses.
const BLUNT: [f64; 2] = [1.5, 0.8];
/// Nodes are led so far from the tip [radii of the blunt tip].
const TIP_REACH: f64 = 1.25;
/// Nodes are led so far from the shaft [spacings].
const SHAFT_REACH: f64 = 1.5;
/// A tip that presses less than this leads less stiffly [mm], so that nothing jumps where it comes off.
const LIGHT: f64 = 0.2;
/// Stiffness of a spring over that of the node's bonds.
const STIFFNESS: f64 = 60.0;
/// Length of a direction that is none, and places that are none [mm].
const SAME_LENGTH: f64 = 1e-3;
const FARTHEST: f64 = 1e9;

/// What a needle does to the tissue around it. Frame: patient [mm].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NeedleDrag {
    /// Where it goes in, as tissue rests.
    pub entry: DVec3,
    /// Inward, of length 1.
    pub direction: DVec3,
    /// Length of the shaft in tissue [mm]; so deep rests what is at the tip.
    pub depth: f64,
    /// How far the tip presses in what is ahead of it [mm].
    pub pressed: f64,
    /// How far friction carries tissue along the shaft [mm]; outward below zero.
    pub carried: f64,
}

impl NeedleDrag {
    /// As it can be followed; none where any of it is no number, or the direction has no length.
    #[must_use]
    pub fn checked(self) -> Option<Self> {
        let is_place = self.entry.abs().cmple(DVec3::splat(FARTHEST)).all();
        // comparisons with NaN are false
        let is_direction = (self.direction.length() - 1.0).abs() < SAME_LENGTH;
        let numbers = [self.depth, self.pressed, self.carried];
        let is_known = is_place && is_direction && numbers.iter().all(|n| n.is_finite());
        is_known.then(|| Self {
            depth: self.depth.clamp(0.0, FARTHEST),
            pressed: self.pressed.clamp(0.0, DEEPEST),
            carried: self.carried.clamp(-CARRIED, CARRIED),
            ..self
        })
    }

    /// Where what is at the tip rests [mm].
    #[must_use]
    pub fn tip(&self) -> DVec3 {
        self.entry + self.direction * self.depth
    }

    /// The farthest that it moves any tissue [mm].
    #[must_use]
    pub fn farthest(&self) -> f64 {
        self.pressed.max(self.carried.abs())
    }

    /// The nodes that it leads, in the frame of their lattice.
    pub(super) fn driven(&self, lattice: &Lattice) -> Vec<DrivenNode> {
        let mobile = lattice
            .matter_nodes()
            .filter(|node| lattice.is_mobile(*node));
        mobile
            .filter_map(|node| self.driven_node(lattice, node))
            .collect()
    }

    fn driven_node(&self, lattice: &Lattice, node: usize) -> Option<DrivenNode> {
        let (place, spacing) = (lattice.rest_place(node), lattice.spacing());
        let blunt = (BLUNT[0] * spacing).max(BLUNT[1] * self.pressed);
        let from_tip = place.distance(self.tip()) / blunt;
        let by_tip = fading(from_tip / TIP_REACH) * (self.pressed / LIGHT).min(1.0);
        // what the tip presses in slides along the shaft
        let slides = (1.0 - by_tip).powi(3);
        let by_shaft = fading(self.distance_to_shaft(place) / (SHAFT_REACH * spacing)) * slides;
        let weight = by_tip + by_shaft;
        let pressed = self.pressed * (1.0 + from_tip.powi(4)).powf(-0.25);
        (weight > 0.0).then(|| DrivenNode {
            node,
            stiffness: STIFFNESS * lattice.node_stiffness[node] * weight,
            led: self.direction * ((by_tip * pressed + by_shaft * self.carried) / weight),
        })
    }

    /// Distance from the shaft in tissue [mm]; none is near one that is not in.
    fn distance_to_shaft(&self, place: DVec3) -> f64 {
        if self.depth == 0.0 {
            return f64::INFINITY;
        }
        let along = (place - self.entry).dot(self.direction);
        let nearest = along.clamp(0.0, self.depth);
        place.distance(self.entry + self.direction * nearest)
    }
}

/// 1 at 0, and smoothly 0 from 1 on.
fn fading(share: f64) -> f64 {
    (1.0 - share * share).max(0.0).powi(2)
}
