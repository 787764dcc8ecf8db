//! How far a needle presses tissue in that it is not in yet, for whoever shows it: no state of touch.

use super::track::Line;

/// A needle that presses tissue in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Press {
    /// Where it touches the tissue as it rests, and the way that it is pushed.
    pub push: Line,
    /// How far the tissue is pressed in along that [mm].
    pub depth: f64,
}
