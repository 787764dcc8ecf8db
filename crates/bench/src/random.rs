//! Seeded numbers, so that every run times the same work.
//!
//! Source: Steele, Lea, Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014
//! (SplitMix64).

use glam::DVec3;

/// A stream of numbers.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// One of many streams of a seed, which have nothing to do with one another.
    pub fn of_stream(seed: u64, number: u64) -> Self {
        Self(Self(seed).bits() ^ Self(!number).bits())
    }

    /// Evenly over 0..1.
    pub fn share(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ mixed >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ mixed >> 31
    }

    /// Evenly over the box from `low` to `high`.
    pub fn in_box(&mut self, low: DVec3, high: DVec3) -> DVec3 {
        let share = DVec3::new(self.share(), self.share(), self.share());
        low + (high - low) * share
    }

    /// Evenly over all directions.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let point = self.in_box(DVec3::NEG_ONE, DVec3::ONE);
            let length = point.length();
            // the ball without its middle, where the direction would be rounding
            if (0.01..=1.0).contains(&length) {
                return point / length;
            }
        }
    }
}
