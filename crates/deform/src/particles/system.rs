//! Particles with their law and their lists of neighbours.

use super::neighbours::NeighbourList;
use super::pair_force::{PairOptions, PairSums, pair_forces};
use super::pair_laws::LaneLaw;
use super::space::Space;
use super::state::Particles;

/// Margin of the models' lists over the reach of the law [a].
pub const MARGIN: f64 = 0.3;

/// Particles that act on one another.
#[derive(Clone, Debug)]
pub struct ParticleSystem<L> {
    /// The particles.
    pub particles: Particles,
    /// Law of the pair forces.
    pub law: L,
    /// How their forces are computed.
    pub options: PairOptions,
    list: NeighbourList,
}

impl<L: LaneLaw> ParticleSystem<L> {
    /// Particles under a law that reaches so far, with lists that reach by `margin` farther.
    pub fn new(particles: Particles, law: L, reach: f64, margin: f64, space: Space) -> Self {
        Self {
            particles,
            law,
            options: PairOptions::default(),
            list: NeighbourList::new(reach, margin, space),
        }
    }

    /// The lists of neighbours.
    pub fn list(&self) -> &NeighbourList {
        &self.list
    }

    /// Sets the forces to those of the present positions.
    pub fn evaluate(&mut self) -> PairSums {
        self.list.update(&self.particles.sites);
        pair_forces(&self.law, &mut self.particles, &self.list, self.options)
    }
}
