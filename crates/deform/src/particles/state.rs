//! The state of all particles: where they are, how they move, what they were made of.
//!
//! Arrays, one entry per particle, in the order in which particles were taken from the pool;
//! those given back leave their places to the others, and no memory is allocated or freed
//! while a model runs (the pool of thesis 5.11, without its flags and lists).

use glam::{DVec3, IVec3};
use palpate_volume::segment_set::SegmentSet;
use palpate_volume::voxel_state::VoxelState;

/// Where a particle is, and how soft its links are. Four doubles, so that one load brings all
/// that a pair needs to know of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(32))]
pub struct Site {
    /// Position, first axis.
    pub x: f64,
    /// Position, second axis.
    pub y: f64,
    /// Position, third axis.
    pub z: f64,
    /// 1/D of the particle's own tissue: the depth of a pair is the harmonic mean, 2/(s₁ + s₂).
    pub softness: f64,
}

impl Site {
    /// A site at a place, with the depth D of its material.
    pub fn new(position: DVec3, depth: f64) -> Self {
        let DVec3 { x, y, z } = position;
        Self {
            x,
            y,
            z,
            softness: depth.recip(),
        }
    }

    /// Place of the particle.
    #[inline]
    pub fn position(&self) -> DVec3 {
        DVec3::new(self.x, self.y, self.z)
    }

    /// Puts it elsewhere.
    #[inline]
    pub fn set_position(&mut self, position: DVec3) {
        (self.x, self.y, self.z) = position.into();
    }
}

/// The voxel that a particle was made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Origin {
    /// Which voxel.
    pub voxel: IVec3,
    /// Intensity and segments of the voxel.
    pub matter: VoxelState,
}

impl Default for Origin {
    fn default() -> Self {
        let matter = VoxelState {
            stored: 0,
            segments: SegmentSet::EMPTY,
        };
        Self {
            voxel: IVec3::ZERO,
            matter,
        }
    }
}

/// All particles. Every array has one entry per particle.
#[derive(Clone, Debug, Default)]
pub struct Particles {
    /// Positions and softness.
    pub sites: Vec<Site>,
    /// Velocities.
    pub velocities: Vec<DVec3>,
    /// Forces at the present positions.
    pub forces: Vec<DVec3>,
    /// Masses.
    pub masses: Vec<f64>,
    /// Where each was put when it was taken from the pool: its initial position.
    pub homes: Vec<DVec3>,
    /// Taken off the force of each that is bound to its initial position: what was left there.
    pub left: Vec<DVec3>,
    /// Along which axes it moves: 1, or 0 where it stands still whatever pushes it.
    pub free: Vec<DVec3>,
    /// What each was made of.
    pub origins: Vec<Origin>,
}

impl Particles {
    /// Room for so many; until then nothing is allocated.
    pub fn with_capacity(capacity: usize) -> Self {
        Self {
            sites: Vec::with_capacity(capacity),
            velocities: Vec::with_capacity(capacity),
            forces: Vec::with_capacity(capacity),
            masses: Vec::with_capacity(capacity),
            homes: Vec::with_capacity(capacity),
            left: Vec::with_capacity(capacity),
            free: Vec::with_capacity(capacity),
            origins: Vec::with_capacity(capacity),
        }
    }

    /// Particles of one material, at rest at these places.
    pub fn at_rest(positions: &[DVec3], depth: f64, mass: f64) -> Self {
        let mut particles = Self::with_capacity(positions.len());
        for &position in positions {
            particles.take(position, depth, mass, Origin::default());
        }
        particles
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.sites.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.sites.is_empty()
    }

    /// Takes one from the pool, at rest at its initial position.
    pub fn take(&mut self, home: DVec3, depth: f64, mass: f64, origin: Origin) {
        self.sites.push(Site::new(home, depth));
        self.velocities.push(DVec3::ZERO);
        self.forces.push(DVec3::ZERO);
        self.masses.push(mass);
        self.homes.push(home);
        self.left.push(DVec3::ZERO);
        self.free.push(DVec3::ONE);
        self.origins.push(origin);
    }

    /// Gives those back for which `leaves` says so, asked by index; the order of the others
    /// stays.
    pub fn give_back(&mut self, leaves: impl Fn(&Self, usize) -> bool) -> usize {
        let before = self.len();
        let mut kept = 0;
        for index in 0..before {
            if leaves(self, index) {
                continue;
            }
            self.sites[kept] = self.sites[index];
            self.velocities[kept] = self.velocities[index];
            self.forces[kept] = self.forces[index];
            self.masses[kept] = self.masses[index];
            self.homes[kept] = self.homes[index];
            self.left[kept] = self.left[index];
            self.free[kept] = self.free[index];
            self.origins[kept] = self.origins[index];
            kept += 1;
        }
        self.truncate(kept);
        before - kept
    }

    /// Gives all back.
    pub fn clear(&mut self) {
        self.truncate(0);
    }

    fn truncate(&mut self, length: usize) {
        self.sites.truncate(length);
        self.velocities.truncate(length);
        self.forces.truncate(length);
        self.masses.truncate(length);
        self.homes.truncate(length);
        self.left.truncate(length);
        self.free.truncate(length);
        self.origins.truncate(length);
    }

    /// Σ m v.
    pub fn momentum(&self) -> DVec3 {
        self.velocities
            .iter()
            .zip(&self.masses)
            .map(|(&v, &m)| m * v)
            .sum()
    }

    /// Σ m v²/2.
    pub fn kinetic_energy(&self) -> f64 {
        let each = |(v, m): (&DVec3, &f64)| 0.5 * m * v.length_squared();
        self.velocities.iter().zip(&self.masses).map(each).sum()
    }
}
