//! What tests of the checkers have in common: a wall at x = 8 of the grid and a device in it.

use glam::{DMat3, DVec3};
use palpate_haptics::contact::Proxy;
use palpate_haptics::force::{Coupling, ForceLimits};
use palpate_haptics::tick::TickOutput;

use super::constants::Constants;
use super::felt::Felt;

/// Behind the wall.
pub const DEVICE: DVec3 = DVec3::new(9.5, 4.5, 4.5);

/// Cubes of 1 mm, a point and a smooth force without friction.
pub fn constants() -> Constants {
    Constants {
        spacing: DVec3::ONE,
        direction: DMat3::IDENTITY,
        origin: DVec3::ZERO,
        radius: 0.0,
        visit_bound: 100,
        limits: ForceLimits {
            max_force: 5.0,
            max_growth: 1000.0,
        },
        dt: 1e-3,
        stiffness: 2.0,
        damping: 0.0,
        frictionless: true,
        felt: Felt::Bits,
    }
}

/// A probe at this x.
pub fn proxy(x: f64) -> Proxy {
    Proxy::at(DVec3::new(x, 4.5, 4.5)).expect("the tests' places are finite")
}

/// A contact with a force along x [N].
pub fn output(force: f64) -> TickOutput {
    TickOutput {
        proxy_in_scene: DVec3::ZERO,
        contact_point_in_scene: DVec3::ZERO,
        normal: DVec3::ZERO,
        force: DVec3::X * force,
        spring: DVec3::X * force / constants().stiffness,
        coupling: Coupling::default(),
        sticks: false,
        held_by: None,
        contact: true,
        depth: 0.0,
        visits: 100,
        violation: false,
    }
}
