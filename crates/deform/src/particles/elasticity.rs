//! Moduli of perfect lattices of particles, by lattice sums: what E a given D makes.
//!
//! All for D = 1 and a = 1, so moduli are in D/a³. The lattices have cubic symmetry: three
//! moduli C11, C12, C44, and a Young's modulus that depends on the direction. Central forces
//! obey Cauchy's relation, C12 = C44 where the pressure is zero, so Poisson's ratio cannot be
//! chosen. Source: Born & Huang, *Dynamical theory of crystal lattices* (1954), §11.

use glam::{DVec3, IVec3};

use super::lattices::FCC_BASIS;
use crate::potential::PairLaw;

/// Offsets to all particles of an FCC lattice within `reach`, with nearest ones at distance 1.
pub fn fcc_offsets(reach: f64) -> Vec<DVec3> {
    let side = std::f64::consts::SQRT_2;
    let first = FCC_BASIS[0];
    let places = FCC_BASIS.map(|place| side * (place - first));
    offsets(reach, side, &places)
}

/// Offsets to all particles of a simple cubic lattice of side 1 within a cube of half side
/// `reach`.
pub fn cubic_offsets(reach: f64) -> Vec<DVec3> {
    let mut all = offsets(reach * 3.0_f64.sqrt(), 1.0, &[DVec3::ZERO]);
    all.retain(|offset| offset.abs().max_element() <= reach);
    all
}

fn offsets(reach: f64, side: f64, basis: &[DVec3]) -> Vec<DVec3> {
    let range = (reach / side).ceil() as i32 + 1;
    let mut found = Vec::new();
    for z in -range..=range {
        for y in -range..=range {
            for x in -range..=range {
                let corner = side * IVec3::new(x, y, z).as_dvec3();
                found.extend(basis.iter().map(|place| corner + place));
            }
        }
    }
    found.retain(|offset| offset.length() <= reach && offset.length() > 1e-9);
    found
}

/// Pressure of a lattice [D/a³]: `force` gives the force on a particle at an offset from
/// another, `volume` is that of one particle.
pub fn pressure(offsets: &[DVec3], volume: f64, force: impl Fn(DVec3) -> DVec3) -> f64 {
    offsets.iter().map(|&d| force(d).dot(d)).sum::<f64>() / (6.0 * volume)
}

/// χ: the spacing at which a lattice has no pressure, in units of a. `volume` is that of one
/// particle at spacing 1.
pub fn spacing_without_pressure(
    offsets: &[DVec3],
    volume: f64,
    force: impl Fn(DVec3) -> DVec3 + Copy,
) -> f64 {
    let at = |spacing: f64| {
        let moved: Vec<_> = offsets.iter().map(|&d| spacing * d).collect();
        pressure(&moved, volume * spacing.powi(3), force)
    };
    crate::potential::root(0.9, 1.05, at)
}

/// The moduli of a lattice with cubic symmetry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubicModuli {
    /// Stress along an axis by strain along it.
    pub c11: f64,
    /// Stress across an axis by strain along it.
    pub c12: f64,
    /// Shear.
    pub c44: f64,
}

impl CubicModuli {
    /// Moduli of a lattice without pressure; `volume` is that of one particle.
    pub fn of(offsets: &[DVec3], volume: f64, law: &impl PairLaw) -> Self {
        let mut moduli = Self {
            c11: 0.0,
            c12: 0.0,
            c44: 0.0,
        };
        for d in offsets {
            let (r, h) = (d.length(), 1e-5);
            let slope = (law.force(r + h) - law.force(r - h)) / (2.0 * h);
            // (Π″ − Π′/r)/r², over both particles of each pair
            let share = (law.force(r) / r - slope) / (2.0 * volume * r * r);
            moduli.c11 += share * d.x.powi(4);
            moduli.c12 += share * (d.x * d.y).powi(2);
        }
        moduli.c44 = moduli.c12;
        moduli
    }

    /// Young's modulus along a direction.
    pub fn young(&self, direction: DVec3) -> f64 {
        let Self { c11, c12, c44 } = *self;
        let n = direction.normalize();
        let common = (c11 - c12) * (c11 + 2.0 * c12);
        let (s11, s12, s44) = ((c11 + c12) / common, -c12 / common, c44.recip());
        let mixed = (n.x * n.y).powi(2) + (n.y * n.z).powi(2) + (n.z * n.x).powi(2);
        (s11 - 2.0 * (s11 - s12 - 0.5 * s44) * mixed).recip()
    }

    /// Poisson's ratio of a pull along an axis.
    pub fn poisson_along_axis(&self) -> f64 {
        self.c12 / (self.c11 + self.c12)
    }

    /// Young's modulus of many grains in all directions, all strained alike (Voigt).
    pub fn voigt_young(&self) -> f64 {
        let bulk = (self.c11 + 2.0 * self.c12) / 3.0;
        let shear = (self.c11 - self.c12 + 3.0 * self.c44) / 5.0;
        9.0 * bulk * shear / (3.0 * bulk + shear)
    }

    /// 2 C44/(C11 − C12): one where all directions are alike.
    pub fn anisotropy(&self) -> f64 {
        2.0 * self.c44 / (self.c11 - self.c12)
    }
}

/// Young's modulus and Poisson's ratio of a lattice compressed along z with free sides, without assuming that the
/// law has an energy or a second derivative: the cuboid law has neither. `offsets` are those of
/// the lattice without pressure.
pub fn compression_moduli(
    offsets: &[DVec3],
    volume: f64,
    strain: f64,
    force: impl Fn(DVec3) -> DVec3 + Copy,
) -> (f64, f64) {
    // stress along an axis of a lattice strained by `side` across z
    let stress = |side: f64, axis: usize| {
        let stretch = DVec3::new(1.0 + side, 1.0 + side, 1.0 - strain);
        let each = |d: &DVec3| force(*d * stretch)[axis] * d[axis] * stretch[axis];
        offsets.iter().map(each).sum::<f64>() / (2.0 * volume * stretch.element_product())
    };
    let side = crate::potential::root(-strain, 2.0 * strain, |side| stress(side, 0));
    (stress(side, 2) / strain, side / strain)
}
