//! A device in a few lines: it tells over UDP where it is, and is told the force there.
//!
//! Its own frame is x right, y up, z away from the person, in metres; a datagram is "x y z".
//! `docs/extend/adding-a-device.md` shows this file.

use std::net::UdpSocket;

use glam::DVec3;
use palpate_device::velocity_estimate::VelocityEstimate;
use palpate_device::{DeviceLimits, DeviceState, HapticDevice, saturated};

/// The device, and what was read last.
pub struct UdpDevice {
    /// Connected, and told not to block.
    pub(crate) socket: UdpSocket,
    pub(crate) limits: DeviceLimits,
    pub(crate) velocity: VelocityEstimate,
    pub(crate) state: DeviceState,
}

impl HapticDevice for UdpDevice {
    fn name(&self) -> &'static str {
        "udp"
    }

    fn limits(&self) -> DeviceLimits {
        self.limits
    }

    fn read(&mut self, dt: f64) -> DeviceState {
        // the newest datagram counts; a flood of them must not hold up the tick
        let (mut text, mut reads) = ([0; 96], 0..16);
        while let Some(Ok(length)) = reads.next().map(|_: u8| self.socket.recv(&mut text)) {
            self.state.position = point(&text[..length]).unwrap_or(self.state.position);
        }
        self.state.velocity = self.velocity.update(self.state.position, dt);
        self.state.time += dt;
        self.state
    }

    fn write(&mut self, force: DVec3, _torque: DVec3) {
        self.state.force = saturated(force, self.limits.max_force);
        let DVec3 { x, y, z } = self.state.force;
        let _ = self.socket.send(format!("{x} {y} {}", -z).as_bytes());
    }
}

/// A point of the device frame [mm], if the text is one.
fn point(text: &[u8]) -> Option<DVec3> {
    let mut words = str::from_utf8(text).ok()?.split_whitespace();
    let mut number = || words.next()?.parse::<f64>().ok();
    // metres to mm, their axes to ours
    let point = 1000.0 * DVec3::new(number()?, number()?, -number()?);
    point.is_finite().then_some(point)
}

/// Nothing runs by itself; the test moves it.
pub fn main() {}
