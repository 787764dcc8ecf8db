//! FIRE: brings particles to rest at a minimum of their energy.
//!
//! Motion with inertia whose velocity is turned toward the force, and which is stopped where it
//! climbs. Time has no meaning here: each particle's mass is the stiffness it feels, so that
//! soft tissue beside bone comes to rest as fast as one tissue alone.
//! Source: Bitzek et al., PRL 97 (2006); Guénolé et al., Comput. Mater. Sci. 175 (2020).

use glam::DVec3;

use crate::particles::Particles;

/// Longest step, for masses equal to the stiffness of one link: of the stable 2/√12.2 (FCC,
/// four shells) what leaves room for compressed links, which are stiffer.
const LONGEST: f64 = 0.4;
const FIRST: f64 = 0.1;
const SHORTEST: f64 = 0.002;
/// Steps downhill before the step grows.
const PATIENCE: u32 = 5;
/// Farthest move of a particle in one step [a]: nothing jumps over a neighbour.
const FARTHEST: f64 = 0.1;

/// The state of one relaxation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fire {
    step: f64,
    turn: f64,
    downhill: u32,
    farthest: f64,
}

impl Fire {
    /// From rest, for links of this equilibrium distance; velocities must be zero.
    pub fn new(equilibrium: f64) -> Self {
        Self {
            step: FIRST,
            turn: 0.25,
            downhill: 0,
            farthest: FARTHEST * equilibrium,
        }
    }

    /// One step: `inertia` is the stiffness of each particle's links, forces are those of the
    /// present positions. Returns the largest force on a free particle before the step.
    pub fn step(&mut self, particles: &mut Particles, inertia: &[f64]) -> f64 {
        let Particles {
            sites,
            velocities,
            forces,
            free,
            ..
        } = particles;

        // how much goes downhill, and the sizes of velocity and acceleration by inertia
        let (mut power, mut speed, mut pull, mut largest) = (0.0, 0.0, 0.0, 0.0_f64);
        for (((velocity, force), free), mass) in
            velocities.iter().zip(&*forces).zip(&*free).zip(inertia)
        {
            let force = *force * *free;
            power += force.dot(*velocity);
            speed += mass * velocity.length_squared();
            pull += force.length_squared() / mass;
            largest = largest.max(force.length_squared());
        }

        self.choose_step(power);
        let back = if power > 0.0 { 0.0 } else { -0.5 * self.step };
        let keep = if power > 0.0 { 1.0 - self.turn } else { 0.0 };
        let mix = if power > 0.0 && pull > 0.0 {
            self.turn * (speed / pull).sqrt()
        } else {
            0.0
        };

        let each = sites
            .iter_mut()
            .zip(velocities)
            .zip(&*forces)
            .zip(&*free)
            .zip(inertia);
        for ((((site, velocity), force), free), mass) in each {
            let acceleration = *force * *free / *mass;
            let retreat = back * *velocity;
            *velocity = keep * *velocity + (mix + self.step) * acceleration;
            let drift = (self.step * *velocity + retreat).clamp_length_max(self.farthest);
            site.set_position(site.position() + drift);
        }
        largest.sqrt()
    }

    fn choose_step(&mut self, power: f64) {
        if power > 0.0 {
            self.downhill += 1;
            if self.downhill > PATIENCE {
                self.step = (1.1 * self.step).min(LONGEST);
                self.turn *= 0.99;
            }
        } else {
            self.downhill = 0;
            self.turn = 0.25;
            self.step = (0.5 * self.step).max(SHORTEST);
        }
    }
}

/// Stops all particles, as a relaxation begins.
pub fn stop(particles: &mut Particles) {
    particles.velocities.fill(DVec3::ZERO);
}
