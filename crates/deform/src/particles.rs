//! The models of particles: `fcc-lj`, `cuboid-lj` and `global-lj`.
