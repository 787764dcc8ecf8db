//! Lennard-Jones laws as the pair loop computes them: force over distance and energy, both
//! for D = 1, from squared distances, eight at once and without a square root.

use super::lanes::Lanes;
use crate::potential::{LennardJones, PairLaw, PotentialError};

/// A law of pairs that the pair loop can take.
pub trait LaneLaw: Copy + Send + Sync + sealed::Evaluate {}
impl<L: Copy + Send + Sync + sealed::Evaluate> LaneLaw for L {}

pub(crate) mod sealed {
    use super::Lanes;

    /// What the pair loop asks of a law.
    pub trait Evaluate {
        /// Pairs whose measure is not less do not act on one another.
        fn cut_squared(&self) -> f64;
        /// What is compared with the cut: the squared distance, or another measure of it.
        fn measure<V: Lanes>(&self, _offset: [V; 3], squared: V) -> V {
            squared
        }
        /// (f/r, Π) of a pair, for D = 1.
        fn evaluate<V: Lanes>(&self, measure: V, squared: V) -> (V, V);
    }
}

/// Lennard-Jones, cut bare: the law of the benchmark, and of lattice sums.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutLaw {
    equilibrium_squared: f64,
    cut_squared: f64,
}

impl CutLaw {
    /// With equilibrium distance a and the distance from which on there is no force.
    pub fn new(equilibrium: f64, cut: f64) -> Self {
        Self {
            equilibrium_squared: equilibrium * equilibrium,
            cut_squared: cut * cut,
        }
    }
}

/// ((a/r)¹² − (a/r)⁶)·12/r² and (a/r)¹² − 2(a/r)⁶.
#[inline(always)]
fn lennard_jones<V: Lanes>(equilibrium_squared: f64, squared: V) -> (V, V) {
    let inverse = V::splat(1.0).div(squared);
    let ratio = inverse.mul(V::splat(equilibrium_squared));
    let sixth = ratio.mul(ratio).mul(ratio);
    let force = sixth
        .mul_add(sixth, V::splat(0.0).sub(sixth))
        .mul(inverse)
        .mul(V::splat(12.0));
    let energy = sixth.mul(sixth.sub(V::splat(2.0)));
    (force, energy)
}

impl sealed::Evaluate for CutLaw {
    fn cut_squared(&self) -> f64 {
        self.cut_squared
    }

    #[inline(always)]
    fn evaluate<V: Lanes>(&self, _measure: V, squared: V) -> (V, V) {
        lennard_jones(self.equilibrium_squared, squared)
    }
}

/// Lennard-Jones faded to nothing before its cut, with a greatest force: the law of the models.
/// The same as [`crate::potential::Switched`] of [`crate::potential::Limited`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FadedLaw {
    equilibrium_squared: f64,
    from_squared: f64,
    cut_squared: f64,
    /// Where the force reaches its limit.
    reached: f64,
    /// Π there, for D = 1.
    energy_reached: f64,
    /// The limit, for D = 1.
    limit: f64,
}

impl FadedLaw {
    /// Faded from `from` to `cut`; no force above `limit` [D/a].
    ///
    /// # Errors
    /// Where the range or the limit are those of no potential.
    pub fn new(equilibrium: f64, from: f64, cut: f64, limit: f64) -> Result<Self, PotentialError> {
        use crate::potential::{Limited, Switched};
        let law = LennardJones::new(equilibrium, 1.0)?;
        let limited = Limited::new(law, limit / equilibrium)?;
        Switched::new(limited, from, cut)?;
        let reached = limited.reached();
        Ok(Self {
            equilibrium_squared: equilibrium.powi(2),
            from_squared: from.powi(2),
            cut_squared: cut.powi(2),
            reached,
            energy_reached: law.energy(reached),
            limit: limit / equilibrium,
        })
    }
}

impl sealed::Evaluate for FadedLaw {
    fn cut_squared(&self) -> f64 {
        self.cut_squared
    }

    #[inline(always)]
    fn evaluate<V: Lanes>(&self, _measure: V, squared: V) -> (V, V) {
        let (force, energy) = lennard_jones(self.equilibrium_squared, squared);

        // S = 1 − t³(10 − 15 t + 6 t²), −S′/r = 60 t²(1 − t)²/span
        let span = (self.cut_squared - self.from_squared).recip();
        let t = squared.sub(V::splat(self.from_squared)).mul(V::splat(span));
        let t = t.max(V::splat(0.0)).min(V::splat(1.0));
        let curve = t
            .mul_add(V::splat(6.0), V::splat(-15.0))
            .mul_add(t, V::splat(10.0));
        let share = V::splat(1.0).sub(t.mul(t).mul(t).mul(curve));
        let hill = t.mul(V::splat(1.0).sub(t));
        let slope = hill.mul(hill).mul(V::splat(60.0 * span));
        let faded = (force.mul_add(share, slope.mul(energy)), energy.mul(share));

        // rarely is any pair so near that its force is limited
        let near = squared.less(V::splat(self.reached * self.reached));
        if near == 0 {
            return faded;
        }
        let distance = squared.sqrt();
        let deeper = V::splat(self.reached).sub(distance);
        let force = V::splat(self.limit).div(distance);
        let energy = deeper.mul_add(V::splat(self.limit), V::splat(self.energy_reached));
        (
            force.keep(near).add(faded.0.keep(!near)),
            energy.keep(near).add(faded.1.keep(!near)),
        )
    }
}

/// The thesis' cuboid law (5.62–5.65) with only the radial part of its gradient as force: not
/// conservative. Cut by the Chebyshev distance, in which the law is one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CuboidLaw {
    side_squared: f64,
    cut_squared: f64,
    nearest_squared: f64,
}

impl CuboidLaw {
    /// With side a and Chebyshev cut-off; cubes whose centres are nearer than `nearest` push
    /// as hard as there, which limits the force (5.20).
    pub fn new(side: f64, cut: f64, nearest: f64) -> Self {
        Self {
            side_squared: side * side,
            cut_squared: cut * cut,
            nearest_squared: nearest * nearest,
        }
    }
}

impl sealed::Evaluate for CuboidLaw {
    fn cut_squared(&self) -> f64 {
        self.cut_squared
    }

    #[inline(always)]
    fn measure<V: Lanes>(&self, offset: [V; 3], _squared: V) -> V {
        let far = offset[0].abs().max(offset[1].abs()).max(offset[2].abs());
        far.mul(far)
    }

    #[inline(always)]
    fn evaluate<V: Lanes>(&self, measure: V, squared: V) -> (V, V) {
        let nearest = V::splat(self.nearest_squared);
        let ratio = V::splat(self.side_squared).div(measure.max(nearest));
        let sixth = ratio.mul(ratio).mul(ratio);
        let pull = sixth
            .mul_add(sixth, V::splat(0.0).sub(sixth))
            .mul(V::splat(12.0));
        (
            pull.div(squared.max(nearest)),
            sixth.mul(sixth.sub(V::splat(2.0))),
        )
    }
}
