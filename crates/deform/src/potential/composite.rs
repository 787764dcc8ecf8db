//! Laws made from other laws: shifted, limited, only the repulsion, stretched, and Krivtsov's
//! spline. Source: thesis 5.7.4, 5.16 and 5.20.

use super::{Characteristics, PairLaw, Potential, PotentialError, bounded, positive, root, within};

/// Cut at a distance and shifted in energy, so that the energy is zero there; the force steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shifted<P> {
    inner: P,
    cut: f64,
    offset: f64,
}

impl<P: Potential> Shifted<P> {
    /// Cuts `inner`.
    ///
    /// # Errors
    /// Where the cut lies nearer than b, or farther than 1000 a.
    pub fn new(inner: P, cut: f64) -> Result<Self, PotentialError> {
        let known = inner.characteristics();
        let cut = within("cut-off", cut, known.critical, 1000.0 * known.equilibrium)?;
        Ok(Self {
            offset: inner.energy(cut),
            inner,
            cut,
        })
    }
}

impl<P: Potential> PairLaw for Shifted<P> {
    fn energy(&self, distance: f64) -> f64 {
        if distance < self.cut {
            self.inner.energy(distance) - self.offset
        } else {
            0.0
        }
    }

    fn force(&self, distance: f64) -> f64 {
        if distance < self.cut {
            self.inner.force(distance)
        } else {
            0.0
        }
    }
}

impl<P: Potential> Potential for Shifted<P> {
    fn characteristics(&self) -> Characteristics {
        let inner = self.inner.characteristics();
        let zero = root(0.5 * inner.zero, inner.equilibrium, |r| self.energy(r));
        Characteristics {
            zero,
            depth: inner.depth + self.offset,
            ..inner
        }
    }
}

/// The force never above a limit (thesis 5.88): nearer than where the law reaches it, the
/// force stays constant and the energy grows linearly, so that it is still conservative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limited<P> {
    inner: P,
    limit: f64,
    reached: f64,
}

impl<P: Potential> Limited<P> {
    /// Limits the repulsion of `inner`.
    ///
    /// # Errors
    /// Where the limit is not above the strength f* (it would cut the attraction too).
    pub fn new(inner: P, limit: f64) -> Result<Self, PotentialError> {
        let known = inner.characteristics();
        let limit = within("force limit", limit, known.strength, f64::MAX)?;
        let least = 0.1 * known.equilibrium;
        let reached = root(least, known.equilibrium, |r| limit - inner.force(r));
        Ok(Self {
            inner,
            limit,
            reached,
        })
    }

    /// The distance below which the force is the limit.
    pub fn reached(&self) -> f64 {
        self.reached
    }
}

impl<P: Potential> PairLaw for Limited<P> {
    fn energy(&self, distance: f64) -> f64 {
        let outside = self.inner.energy(distance.max(self.reached));
        outside + self.limit * (self.reached - distance.max(0.0)).max(0.0)
    }

    fn force(&self, distance: f64) -> f64 {
        self.inner.force(distance).min(self.limit)
    }
}

impl<P: Potential> Potential for Limited<P> {
    fn characteristics(&self) -> Characteristics {
        let inner = self.inner.characteristics();
        let zero = if inner.zero >= self.reached {
            inner.zero
        } else {
            self.reached + self.inner.energy(self.reached) / self.limit
        };
        Characteristics { zero, ..inner }
    }
}

/// Only the repulsion (Weeks, Chandler and Andersen 1971): the law up to a, lifted by D, so
/// that force and energy are continuous there. What the thesis calls "the repulsive part".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repulsive<P>(pub P);

impl<P: Potential> PairLaw for Repulsive<P> {
    fn energy(&self, distance: f64) -> f64 {
        let known = self.0.characteristics();
        if distance < known.equilibrium {
            self.0.energy(distance) + known.depth
        } else {
            0.0
        }
    }

    fn force(&self, distance: f64) -> f64 {
        let known = self.0.characteristics();
        if distance < known.equilibrium {
            self.0.force(distance)
        } else {
            0.0
        }
    }
}

/// Π(k(r − a) + a), thesis 5.34. It keeps a and D but, other than printed there, no other
/// property: C grows by k², f* by k, ε* by 1/k, k_v by k. Morse or Mie with the wanted k_v
/// does the same without a singularity at r = a(1 − 1/k).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretched<P> {
    inner: P,
    factor: f64,
}

impl<P: Potential> Stretched<P> {
    /// With range modifier k; above one the range is shorter.
    ///
    /// # Errors
    /// Where k is not positive and finite, or the zero σ would not lie at a positive distance.
    pub fn new(inner: P, factor: f64) -> Result<Self, PotentialError> {
        let factor = positive("range modifier", factor)?;
        let known = inner.characteristics();
        let least = 1.001 * (known.equilibrium - known.zero) / known.equilibrium;
        Ok(Self {
            inner,
            factor: within("range modifier", factor, least, 1000.0)?,
        })
    }

    fn argument(&self, distance: f64) -> f64 {
        let a = self.inner.characteristics().equilibrium;
        bounded(self.factor * (bounded(distance, 0.0) - a) + a, a)
    }
}

impl<P: Potential> PairLaw for Stretched<P> {
    fn energy(&self, distance: f64) -> f64 {
        self.inner.energy(self.argument(distance))
    }

    fn force(&self, distance: f64) -> f64 {
        self.factor * self.inner.force(self.argument(distance))
    }
}

impl<P: Potential> Potential for Stretched<P> {
    fn characteristics(&self) -> Characteristics {
        let inner = self.inner.characteristics();
        let moved = |r: f64| inner.equilibrium + (r - inner.equilibrium) / self.factor;
        Characteristics {
            zero: moved(inner.zero),
            critical: moved(inner.critical),
            strength: self.factor * inner.strength,
            stiffness: self.factor.powi(2) * inner.stiffness,
            ..inner
        }
    }
}

/// Krivtsov's spline law: the *force* faded by (1 − u²)², u = (r² − b²)/(cut² − b²), from the
/// critical distance b on, so that only the first shell is bound and f′ is continuous at b.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spline<P> {
    inner: P,
    cut: f64,
}

impl<P: Potential> Spline<P> {
    /// Fades the force of `inner` from b to `cut`; 1.4 a leaves one shell of an FCC lattice.
    ///
    /// # Errors
    /// Where the cut is not beyond b, or farther than 10 a.
    pub fn new(inner: P, cut: f64) -> Result<Self, PotentialError> {
        let known = inner.characteristics();
        let cut = within(
            "cut-off",
            cut,
            1.001 * known.critical,
            10.0 * known.equilibrium,
        )?;
        Ok(Self { inner, cut })
    }

    /// ∫ f from a distance beyond b to the cut, by Gauss's rule of five points on 16 parts:
    /// the integrand is smooth, the rest is rounding.
    fn work_to_cut(&self, from: f64) -> f64 {
        const PLACES: [f64; 5] = [
            -0.906_179_845_938_664,
            -0.538_469_310_105_683,
            0.0,
            0.538_469_310_105_683,
            0.906_179_845_938_664,
        ];
        const WEIGHTS: [f64; 5] = [
            0.236_926_885_056_189,
            0.478_628_670_499_366,
            0.568_888_888_888_889,
            0.478_628_670_499_366,
            0.236_926_885_056_189,
        ];
        let half = 0.5 * (self.cut - from) / 16.0;
        let part = |i: u32| from + (2.0 * f64::from(i) + 1.0) * half;
        let sum = |middle: f64| -> f64 {
            PLACES
                .iter()
                .zip(WEIGHTS)
                .map(|(x, w)| w * self.force(middle + half * x))
                .sum()
        };
        (0..16).map(|i| half * sum(part(i))).sum()
    }
}

impl<P: Potential> PairLaw for Spline<P> {
    fn energy(&self, distance: f64) -> f64 {
        let critical = self.inner.characteristics().critical;
        if distance.is_nan() || distance >= self.cut {
            return 0.0;
        }
        if distance >= critical {
            return self.work_to_cut(distance);
        }
        self.inner.energy(distance) - self.inner.energy(critical) + self.work_to_cut(critical)
    }

    fn force(&self, distance: f64) -> f64 {
        let critical = self.inner.characteristics().critical;
        if distance.is_nan() || distance >= self.cut {
            return 0.0;
        }
        let beyond = distance.max(critical).powi(2) - critical.powi(2);
        let u = beyond / (self.cut.powi(2) - critical.powi(2));
        (1.0 - u * u).powi(2) * self.inner.force(distance)
    }
}

impl<P: Potential> Potential for Spline<P> {
    fn characteristics(&self) -> Characteristics {
        let inner = self.inner.characteristics();
        Characteristics {
            zero: root(0.5 * inner.zero, inner.equilibrium, |r| self.energy(r)),
            depth: -self.energy(inner.equilibrium),
            ..inner
        }
    }
}
