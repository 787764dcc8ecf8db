//! What eases the pressure of nearly incompressible tissue.
//!
//! With Poisson's ratio near ½ a node that moves alone is held by the pressures of its 8 cells, far
//! stiffer than its bonds, so that a step by each node's own stiffness hardly shears tissue. Nodes
//! therefore respond by the stiffness of their bonds, D, and the pressures that this brings are taken
//! off again. The stiffness of bonds and cells D + Bᵀ Λ B, with B the volume that a cell gains and Λ
//! its stiffness, has the inverse D⁻¹ − D⁻¹ Bᵀ S⁻¹ B D⁻¹ with S = Λ⁻¹ + B D⁻¹ Bᵀ, a Laplacian of
//! pressures with one number for each cell. Cells of other tissue count in D, as the bonds do. S⁻¹ is
//! replaced by some steps of Richardson's iteration, which underestimate it, so that what eases stays
//! positive definite.
//!
//! Source: Benzi, Golub & Liesen, Acta Numerica 14 (2005), sections 8 and 10.3 (Schur complements).

use palpate_volume::simd_dispatch;

use super::layout::CHUNK;
use super::nodes::Lattice;
use super::vectors::{Field, Lanes, lanes, lanes_mut};
use super::volume_forces::{cofactors, corners, side};

/// Poisson's ratio above which a cell is eased so: up to 0.45, and what rounding adds to it in a mean, each
/// node's own stiffness serves.
pub(super) const EASED_FROM: f64 = 0.45 + 1e-9;
/// Richardson's iterations.
const STEPS: usize = 3;

/// Pressures of all cells, and scratch. Shape of each array [nodes], at a cell's lowest node.
#[derive(Clone, Debug, Default)]
pub(super) struct PressureEasing {
    corners: [usize; 8],
    /// Where the chunks of nodes begin of which any cell is eased.
    chunks: Vec<usize>,
    /// One over the stiffness of each cell [mm⁵/N].
    compliance: Vec<f64>,
    /// One over the largest that S can be; 0 where a cell is not eased.
    step: Vec<f64>,
    /// How a cell's volume grows with its corners' displacements, but for their signs [mm²].
    cofactors: [[Vec<f64>; 3]; 3],
    /// Volume gained, and what is left of it.
    gained: Vec<f64>,
    pressure: Vec<f64>,
    /// Displacement of the nodes by the pressures.
    moved: Field,
}

impl PressureEasing {
    /// For a lattice as its nodes stand, which move by `mobility`.
    pub fn prepare(&mut self, lattice: &Lattice, mobility: &Field) {
        let chunks = lattice.cells.eased.chunks_exact(CHUNK).enumerate();
        self.chunks.clear();
        self.chunks.extend(
            chunks
                .filter(|(_, eased)| eased.contains(&true))
                .map(|(n, _)| n * CHUNK),
        );
        if self.is_none() {
            return;
        }
        self.clear(lattice);
        self.find_cofactors(lattice);
        for index in (0..lattice.layout.len()).filter(|index| lattice.cells.eased[*index]) {
            self.compliance[index] = lattice.spacing.powi(3) / lattice.cells.modulus[index];
            self.step[index] = self.largest(index, mobility).recip();
        }
    }

    fn clear(&mut self, lattice: &Lattice) {
        self.corners = corners(&lattice.layout);
        let of_cells = [
            &mut self.compliance,
            &mut self.step,
            &mut self.gained,
            &mut self.pressure,
        ];
        let of_axes = self.cofactors.iter_mut().flatten().chain(&mut self.moved);
        for values in of_cells.into_iter().chain(of_axes) {
            values.clear();
            values.resize(lattice.layout.len(), 0.0);
        }
    }

    fn find_cofactors(&mut self, lattice: &Lattice) {
        for &start in &self.chunks {
            let found = cofactors(&self.corners, lattice.spacing, &lattice.moved, start);
            for (own, found) in self.cofactors.iter_mut().zip(&found) {
                for (along, found) in own.iter_mut().zip(found) {
                    *lanes_mut(along, start) = *found;
                }
            }
        }
    }

    /// More than S can be for a cell.
    fn largest(&self, index: usize, mobility: &Field) -> f64 {
        let area = |along: usize| -> f64 {
            let axes = self.cofactors.iter();
            axes.map(|axis| axis[along][index].powi(2)).sum()
        };
        let most = area(0).max(area(1)).max(area(2));
        let gives = |offset: &usize| {
            let axes = mobility.iter();
            axes.map(|axis| axis[index + offset]).fold(0.0, f64::max)
        };
        let gives: f64 = self.corners.iter().map(gives).sum();
        self.compliance[index] + 8.0 * most * gives
    }

    /// Whether no cell is eased so.
    pub fn is_none(&self) -> bool {
        self.chunks.is_empty()
    }

    /// Takes off a response of the nodes what their cells' pressures hold of it.
    pub fn hold(&mut self, mobility: &Field, response: &mut Field) {
        if self.is_none() {
            return;
        }
        hold(self, mobility, response);
    }
}

simd_dispatch! {
    /// See [`PressureEasing::hold`].
    fn hold(easing: &mut PressureEasing, mobility: &Field, response: &mut Field)
        = [avx512, avx2] hold_body
}

#[inline(always)]
fn hold_body(easing: &mut PressureEasing, mobility: &Field, response: &mut Field) {
    for &start in &easing.chunks {
        let gained = gains(&easing.corners, &easing.cofactors, response, start);
        let step = lanes(&easing.step, start);
        let pressure = lanes_mut(&mut easing.pressure, start);
        for n in 0..CHUNK {
            pressure[n] = step[n] * gained[n];
        }
        *lanes_mut(&mut easing.gained, start) = gained;
    }
    for _ in 1..STEPS {
        push(easing, mobility);
        for &start in &easing.chunks {
            let taken = gains(&easing.corners, &easing.cofactors, &easing.moved, start);
            let [step, gained, compliance] =
                [&easing.step, &easing.gained, &easing.compliance].map(|v| *lanes(v, start));
            let pressure = lanes_mut(&mut easing.pressure, start);
            for n in 0..CHUNK {
                let left = gained[n] - compliance[n] * pressure[n] - taken[n];
                pressure[n] += step[n] * left;
            }
        }
    }
    push(easing, mobility);
    for axis in 0..3 {
        for (response, moved) in response[axis].iter_mut().zip(&easing.moved[axis]) {
            *response -= moved;
        }
    }
}

/// Moves the nodes by the pressures.
#[inline(always)]
fn push(easing: &mut PressureEasing, mobility: &Field) {
    for axis in &mut easing.moved {
        axis.fill(0.0);
    }
    for &start in &easing.chunks {
        let pressure = lanes(&easing.pressure, start);
        for axis in 0..3 {
            let mut of: [Lanes; 3] = [[0.0; CHUNK]; 3];
            for along in 0..3 {
                let cofactor = lanes(&easing.cofactors[axis][along], start);
                for n in 0..CHUNK {
                    of[along][n] = pressure[n] * cofactor[n];
                }
            }
            for (corner, offset) in easing.corners.iter().enumerate() {
                let [sx, sy, sz] = [0, 1, 2].map(|along| side(corner, along));
                let there = lanes_mut(&mut easing.moved[axis], start + offset);
                for n in 0..CHUNK {
                    there[n] += sx * of[0][n] + sy * of[1][n] + sz * of[2][n];
                }
            }
        }
    }
    for axis in 0..3 {
        for (moved, mobility) in easing.moved[axis].iter_mut().zip(&mobility[axis]) {
            *moved *= mobility;
        }
    }
}

/// Volume that each cell of a chunk gains where nodes move so.
#[inline(always)]
fn gains(
    corners: &[usize; 8],
    cofactors: &[[Vec<f64>; 3]; 3],
    moved: &Field,
    start: usize,
) -> Lanes {
    let mut gained: Lanes = [0.0; CHUNK];
    for axis in 0..3 {
        let at = corners.map(|offset| lanes(&moved[axis], start + offset));
        let [cx, cy, cz] = [0, 1, 2].map(|along| lanes(&cofactors[axis][along], start));
        for n in 0..CHUNK {
            let low = [at[0][n] + at[1][n], at[2][n] + at[3][n]];
            let high = [at[4][n] + at[5][n], at[6][n] + at[7][n]];
            let low_step = [at[1][n] - at[0][n], at[3][n] - at[2][n]];
            let high_step = [at[5][n] - at[4][n], at[7][n] - at[6][n]];
            gained[n] += cx[n] * ((low_step[0] + low_step[1]) + (high_step[0] + high_step[1]))
                + cy[n] * ((low[1] - low[0]) + (high[1] - high[0]))
                + cz[n] * ((high[0] + high[1]) - (low[0] + low[1]));
        }
    }
    gained
}
