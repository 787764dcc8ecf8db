//! What a hand does: where it pulls the device to, as a fixed plan in time.
//!
//! Frame: device [mm], whose origin is 10 mm above the wall.

use std::f64::consts::TAU;

use glam::DVec3;

use super::HEIGHT;

/// How a hand moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// Slowly in, held, and out again, less and more deeply.
    Press,
    /// In and out four times a second, at up to 0.4 m/s.
    Tap,
    /// Pressed on the wall and led in circles, lifted now and then.
    Slide,
}

impl Motion {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Press, Self::Tap, Self::Slide];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Press => "press",
            Self::Tap => "tap",
            Self::Slide => "slide",
        }
    }

    /// Where the hand is at a time [s] of a run of so many seconds; from then on it is out.
    #[must_use]
    pub fn hand_at(self, time: f64, seconds: f64, outward: DVec3) -> DVec3 {
        if time >= seconds {
            return outward * HEIGHT * 0.5;
        }
        let side = outward.any_orthonormal_vector();
        let (depth, around) = match self {
            Self::Press => press(time),
            Self::Tap => tap(time),
            Self::Slide => slide(time),
        };
        let (sin, cos) = (TAU * around).sin_cos();
        let circle = side * (cos - 1.0) + outward.cross(side) * sin;
        let radius = if self == Self::Slide { 6.0 } else { 0.0 };
        outward * -(HEIGHT + depth) + circle * radius
    }
}

/// Depth [mm] below the wall, and turns around.
type Place = (f64, f64);

/// Every 2.5 s: half a second in, one and a half held, half a second out.
fn press(time: f64) -> Place {
    let round = (time / 2.5).floor();
    let within = time - 2.5 * round;
    // 3 to 18 mm behind the wall
    let deepest = 3.0 + 5.0 * (round % 4.0);
    let share = smooth(within / 0.5) - smooth((within - 2.0) / 0.5);
    (-5.0 + (deepest + 5.0) * share, 0.0)
}

/// From 10 mm above the wall to 20 mm behind it; the device comes as far as the wall lets it.
fn tap(time: f64) -> Place {
    (5.0 - 15.0 * (TAU * 4.0 * time).cos(), 0.0)
}

/// Every 5 s down, four circles, and up.
fn slide(time: f64) -> Place {
    let within = time % 5.0;
    let share = smooth(within / 0.4) - smooth((within - 4.5) / 0.4);
    (-5.0 + 13.0 * share, time)
}

/// From 0 to 1 while the argument does, with no corner.
fn smooth(share: f64) -> f64 {
    let share = share.clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}
