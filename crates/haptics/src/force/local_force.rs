//! The virtual coupling between servo and device: the contact as a law that the device's thread
//! evaluates at its own rate, with its newest position.
//!
//! A servo at 1 kHz that handed over forces would hold each of them for four ticks of a device
//! at 4 kHz; the held force lags behind the hand and gives it energy. So the servo hands over
//! the contact instead: the spring from the device to the contact point as it was when the
//! servo looked, the normal, and what the contact point does when the device goes on. Along
//! the normal it stays, on one side only; along the surface it stays where the probe sticks
//! and goes along where it slides. On a plane that is what a servo at the device's rate would
//! find. Where the device is the slower one, it evaluates the newest law once per tick.
//!
//! A new law acts at once. Spreading its change over the ticks to the next one would be
//! smoother on curved surfaces, but a force that comes late on the way in and at once on the
//! way out, as it must, gives the hand energy.
//!
//! Frame: the device's axes; positions in device mm, the spring in scene mm, N.
//! Source: thesis 2.1.12 and 4.13 (virtual coupling beside a slower loop); Adachi, Kumano,
//! Ogino, "Intermediate representation for stiff virtual objects", VRAIS 1995, for planes
//! that a slow loop hands to a fast one.

use crate::force::coupling::Coupling;
use glam::DVec3;

/// A contact as the device's thread can follow it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalForce {
    /// Where the device was [mm].
    pub device: DVec3,
    /// Vector from the device to the contact point [scene mm]; zero without contact.
    pub spring: DVec3,
    /// Out of the surface, of length 1; zero without contact.
    pub normal: DVec3,
    /// What the spring is made of.
    pub coupling: Coupling,
    /// Whether the contact point stays where it is along the surface.
    pub sticks: bool,
    /// Scene mm per device mm.
    pub scale: f64,
    /// A force that no spring of ours makes and that is held [N]: of models with their own.
    pub held: DVec3,
}

impl LocalForce {
    /// No force.
    pub const NONE: Self = Self {
        device: DVec3::ZERO,
        spring: DVec3::ZERO,
        normal: DVec3::ZERO,
        coupling: Coupling {
            stiffness: 0.0,
            damping: 0.0,
        },
        sticks: false,
        scale: 1.0,
        held: DVec3::ZERO,
    };

    /// A force that is held as it is [N].
    #[must_use]
    pub fn held(force: DVec3) -> Self {
        Self {
            held: force,
            ..Self::NONE
        }
    }

    /// From a device at this place [mm] to the contact point [scene mm]; zero where the device
    /// has left the surface.
    #[must_use]
    pub fn spring_at(&self, device: DVec3) -> DVec3 {
        if self.normal == DVec3::ZERO {
            return DVec3::ZERO;
        }
        let moved = (device - self.device) * self.scale;
        let out = moved.dot(self.normal);
        let spring = if self.sticks {
            self.spring - moved
        } else {
            self.spring - self.normal * out
        };
        // one-sided, and nothing where something is not finite
        if spring.dot(self.normal) > 0.0 && spring.is_finite() {
            spring
        } else {
            DVec3::ZERO
        }
    }

    /// Force on a device at this place [mm] with this velocity [mm/s].
    #[must_use]
    pub fn force_at(&self, device: DVec3, velocity: DVec3) -> DVec3 {
        let spring = self.spring_at(device);
        self.coupling.force(spring, velocity * self.scale) + self.held
    }

    /// Energy in the spring, in terms of device mm [N·mm], where no force above `max_force` [N]
    /// is sent: beyond, the spring yields by a constant force.
    #[must_use]
    pub fn energy_at(&self, device: DVec3, max_force: f64) -> f64 {
        let stiffness = self.coupling.stiffness;
        let stretched = self.spring_at(device).length();
        let force = stiffness * stretched;
        let energy = if force <= max_force {
            0.5 * force * stretched
        } else {
            max_force * (stretched - 0.5 * max_force / stiffness)
        };
        energy / self.scale
    }
}
