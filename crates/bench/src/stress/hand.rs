//! A wild hand: tiny, small and huge moves, around the probe, along a heading and anywhere.
//!
//! Frame: the world's grid.

use glam::DVec3;

use super::world::SIZE;
use crate::random::Random;

/// Longest move [voxels].
const LONGEST: f64 = 50.0;
/// How far the device stays from the border of the world [voxels].
const MARGIN: f64 = 0.5;

/// How long moves are, until this changes.
#[derive(Clone, Copy, Debug)]
enum Pace {
    Tiny,
    Small,
    Fast,
    Huge,
}

/// The hand.
#[derive(Debug)]
pub struct Hand {
    /// Where the device is.
    pub device: DVec3,
    heading: DVec3,
    pace: Pace,
}

impl Hand {
    /// A hand somewhere in the world.
    pub fn new(random: &mut Random) -> Self {
        Self {
            device: anywhere(random),
            heading: random.direction(),
            pace: Pace::Small,
        }
    }

    /// The next device point, at most [`LONGEST`] away.
    pub fn go(&mut self, probe: DVec3, random: &mut Random) -> DVec3 {
        if random.share() < 0.02 {
            self.change(random);
        }
        let length = self.length(random);
        let choice = random.share();
        let goal = if choice < 0.6 {
            // along, with turns
            self.heading = (self.heading + random.direction() * 0.3).normalize_or(DVec3::X);
            self.device + self.heading * length
        } else if choice < 0.9 {
            // around the probe: pressed against all that is there
            probe + random.direction() * length
        } else {
            self.device + random.direction() * length
        };
        let within = within(goal);
        if within != goal {
            self.heading = random.direction();
        }
        self.device += (within - self.device).clamp_length_max(LONGEST);
        self.device
    }

    fn change(&mut self, random: &mut Random) {
        self.heading = random.direction();
        self.pace = match (4.0 * random.share()) as u32 {
            0 => Pace::Tiny,
            1 => Pace::Small,
            2 => Pace::Fast,
            _ => Pace::Huge,
        };
    }

    fn length(&self, random: &mut Random) -> f64 {
        let share = random.share();
        match self.pace {
            Pace::Tiny => 0.01 + 0.09 * share,
            Pace::Small => 0.1 + 0.9 * share,
            Pace::Fast => 1.0 + 4.0 * share,
            Pace::Huge => 5.0 + (LONGEST - 5.0) * share * share,
        }
    }
}

/// Somewhere that the hand may be.
pub fn anywhere(random: &mut Random) -> DVec3 {
    random.in_box(DVec3::splat(MARGIN), DVec3::splat(f64::from(SIZE) - MARGIN))
}

fn within(point: DVec3) -> DVec3 {
    point.clamp(DVec3::splat(MARGIN), DVec3::splat(f64::from(SIZE) - MARGIN))
}
