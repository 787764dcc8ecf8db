//! Mechanical work done on a simulated device, for tests of passivity.

/// Work since the start [N·mm], by who did it.
///
/// A device and the scene behind it are passive while `to_hand` never rises above the
/// energy that was stored at the start: nothing is gained by touching.
/// Source: Hannaford & Ryu, "Time-domain passivity control of haptic interfaces",
/// IEEE Trans. Robotics and Automation 18 (2002).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    /// Done by the force feedback on the moving mass.
    pub by_feedback: f64,
    /// Lost in the device's own friction; never negative.
    pub lost: f64,
    /// Net energy that the device gave to the hand: positive is a gain.
    pub to_hand: f64,
}
