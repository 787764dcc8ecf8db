//! A potential faded to nothing between two distances, smooth to the second derivative.
//!
//! A bare cut at 2.1 a makes an energy step of 0.023 D for each pair that crosses it (thesis
//! 5.6 cuts so); faded over 1.9 a to 2.1 a energy is conserved.

use super::{Characteristics, PairLaw, Potential, PotentialError, within};

/// S(r) Π(r), with S one up to `from` and zero from `to` on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Switched<P> {
    inner: P,
    from: f64,
    to: f64,
}

impl<P: Potential> Switched<P> {
    /// Fades `inner` between two distances.
    ///
    /// # Errors
    /// Where not b ≤ `from` < `to` ≤ 1000 a: nearer, the well itself would change.
    pub fn new(inner: P, from: f64, to: f64) -> Result<Self, PotentialError> {
        let known = inner.characteristics();
        let from = within(
            "start of fading",
            from,
            known.critical,
            999.0 * known.equilibrium,
        )?;
        let least = from + 1e-6 * known.equilibrium;
        let to = within("cut-off", to, least, 1000.0 * known.equilibrium)?;
        Ok(Self { inner, from, to })
    }

    /// S and S′ at a distance; the quintic step in r², which needs no square root.
    fn fade(&self, distance: f64) -> (f64, f64) {
        let span = self.to.powi(2) - self.from.powi(2);
        let t = ((distance.powi(2) - self.from.powi(2)) / span).clamp(0.0, 1.0);
        let share = 1.0 - t.powi(3) * (10.0 + t * (6.0 * t - 15.0));
        let slope = if t > 0.0 && t < 1.0 {
            -30.0 * (t * (1.0 - t)).powi(2) * 2.0 * distance / span
        } else {
            0.0
        };
        (share, slope)
    }
}

impl<P: Potential> PairLaw for Switched<P> {
    fn energy(&self, distance: f64) -> f64 {
        let distance = if distance.is_nan() {
            f64::INFINITY
        } else {
            distance.max(0.0)
        };
        self.fade(distance).0 * self.inner.energy(distance)
    }

    fn force(&self, distance: f64) -> f64 {
        let distance = if distance.is_nan() {
            f64::INFINITY
        } else {
            distance.max(0.0)
        };
        let (share, slope) = self.fade(distance);
        share * self.inner.force(distance) - slope * self.inner.energy(distance)
    }
}

impl<P: Potential> Potential for Switched<P> {
    fn characteristics(&self) -> Characteristics {
        self.inner.characteristics()
    }
}
