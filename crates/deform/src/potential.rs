//! Potentials between pairs of particles.
