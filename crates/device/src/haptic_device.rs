//! What every haptic device can do, and what it tells about itself.
//!
//! Frame: device (x right, y up, z toward the person); mm, mm/s, N, N·mm, s.

use glam::{DQuat, DVec3};

/// What a device can bear; forces sent to it stay below these figures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceLimits {
    /// Largest force for a moment [N].
    pub max_force: f64,
    /// Largest force for any length of time [N]; motors grow warm above it.
    pub max_continuous_force: f64,
    /// Its own viscous friction [N·s/mm], which eats at least that much; 0 where unknown.
    pub damping: f64,
    /// Largest stiffness of a virtual wall that it renders without ringing [N/mm].
    pub max_stiffness: f64,
    /// Radius of the ball that its end point can reach, about the frame's origin [mm].
    pub workspace_radius: f64,
}

/// What a device says at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceState {
    /// End point [mm], as the encoders give it.
    pub position: DVec3,
    /// Velocity of the end point [mm/s], as the driver estimates it.
    pub velocity: DVec3,
    /// Attitude of the handle: `device_from_handle`.
    pub orientation: DQuat,
    /// Pressed buttons, one bit each.
    pub buttons: u32,
    /// Force that the motors apply now [N].
    pub force: DVec3,
    /// Time since the device was opened [s].
    pub time: f64,
}

impl Default for DeviceState {
    /// At rest in the middle of the workspace.
    fn default() -> Self {
        Self {
            position: DVec3::ZERO,
            velocity: DVec3::ZERO,
            orientation: DQuat::IDENTITY,
            buttons: 0,
            force: DVec3::ZERO,
            time: 0.0,
        }
    }
}

/// A device that reads a hand and pushes it. One thread owns it and calls it at its rate.
pub trait HapticDevice: Send {
    /// Name as shown to the person.
    fn name(&self) -> &str;

    /// What the device can bear.
    fn limits(&self) -> DeviceLimits;

    /// Newest state. A device that is computed advances by `dt` [s] first; a real one
    /// ignores `dt`.
    fn read(&mut self, dt: f64) -> DeviceState;

    /// Sends a force [N] and a torque [N·mm], held until the next call. A component that
    /// is not finite sends zero; the magnitude is cut to `max_force`, the direction kept.
    fn write(&mut self, force: DVec3, torque: DVec3);

    /// Where a simulated hand pulls to [mm], or none where it lets go. Real hands decide
    /// for themselves, so that real devices ignore this.
    fn set_hand(&mut self, _hand: Option<DVec3>) {}

    /// Stiffness of the spring by which a simulated hand pulls [N/mm]; none of a real hand, or
    /// where nothing pulls.
    fn hand_stiffness(&self) -> Option<f64> {
        None
    }
}

/// A force cut to `max_force`, with its direction kept; zero where it is not finite.
pub fn saturated(force: DVec3, max_force: f64) -> DVec3 {
    if !force.is_finite() {
        return DVec3::ZERO;
    }
    // scaled by the largest component first, so that no square overflows
    let largest = force.abs().max_element();
    if largest == 0.0 {
        return DVec3::ZERO;
    }
    let scaled = force / largest;
    let length = scaled.length();
    if length * largest <= max_force {
        return force;
    }
    scaled * (max_force / length)
}
