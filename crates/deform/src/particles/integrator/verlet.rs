//! Velocity Verlet, with viscous friction where wanted.
//!
//! Half a kick, half a drift, friction, half a drift, half a kick; without friction that is
//! velocity Verlet. Friction is solved exactly, v e^(−B Δt/m), so no B is too great.
//! Source: Swope et al., J. Chem. Phys. 76 (1982); thesis 5.48, 5.59.

use crate::particles::{ParticleSystem, Particles, pair_laws::LaneLaw};

/// One step of motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityVerlet {
    /// Δt.
    pub step: f64,
    /// B/m [1/time]: how fast velocities decay by themselves.
    pub friction: f64,
}

impl VelocityVerlet {
    /// First part: velocities and positions; forces must be those of the present positions.
    pub fn before_forces(&self, particles: &mut Particles) {
        let decay = (-self.friction * self.step).exp();
        let Particles {
            sites,
            velocities,
            forces,
            masses,
            free,
            ..
        } = particles;
        let each = sites
            .iter_mut()
            .zip(velocities)
            .zip(forces)
            .zip(masses)
            .zip(free);
        for ((((site, velocity), force), mass), free) in each {
            *velocity = *free * (*velocity + 0.5 * self.step / *mass * *force);
            let drift = 0.5 * self.step * (1.0 + decay) * *velocity;
            *velocity *= decay;
            site.set_position(site.position() + drift);
        }
    }

    /// Second part: velocities, by the forces of the new positions.
    pub fn after_forces(&self, particles: &mut Particles) {
        let Particles {
            velocities,
            forces,
            masses,
            free,
            ..
        } = particles;
        for (((velocity, force), mass), free) in
            velocities.iter_mut().zip(forces).zip(masses).zip(free)
        {
            *velocity = *free * (*velocity + 0.5 * self.step / *mass * *force);
        }
    }

    /// A whole step; `evaluate` sets the forces to those of the new positions.
    pub fn advance<L: LaneLaw, R>(
        &self,
        system: &mut ParticleSystem<L>,
        evaluate: impl FnOnce(&mut ParticleSystem<L>) -> R,
    ) -> R {
        self.before_forces(&mut system.particles);
        let result = evaluate(system);
        self.after_forces(&mut system.particles);
        result
    }
}
