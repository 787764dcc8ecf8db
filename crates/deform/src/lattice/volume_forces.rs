//! The volume term: a pressure in each cell of 8 nodes, for Poisson's ratios above 1/4.
//!
//! F is the gradient of the deformation at the middle of the cell, J = det F its volume over
//! that at rest; the energy is λv/2 · (J - 1)² · h³. It does not feel rotation, and its force is
//! the exact gradient, so that nothing is gained or lost on a way around.

use palpate_volume::simd_dispatch;

use super::layout::{CHUNK, Layout};
use super::vectors::{Field, Lanes, lanes, lanes_mut};

/// The cells of a box, each kept at its lowest node.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    /// λv [N/mm²]; 0 where a node is missing. Shape [nodes].
    pub modulus: Vec<f64>,
    /// Whether a chunk of nodes has any cell with a pressure.
    pub used: Vec<bool>,
    /// Whether a cell's tissue is so nearly incompressible that its pressure is eased on its own.
    pub eased: Vec<bool>,
}

impl Cells {
    /// No pressure yet.
    pub fn none(layout: &Layout) -> Self {
        Self {
            modulus: vec![0.0; layout.len()],
            used: vec![false; layout.chunks()],
            eased: vec![false; layout.len()],
        }
    }

    /// Finds the chunks that have cells.
    pub fn find_used(&mut self) {
        for (chunk, used) in self.used.iter_mut().enumerate() {
            *used = self.modulus[chunk * CHUNK..][..CHUNK]
                .iter()
                .any(|modulus| *modulus > 0.0);
        }
    }
}

/// Offsets in memory from the lowest node of a cell to each of its nodes, x fastest.
pub(super) fn corners(layout: &Layout) -> [usize; 8] {
    std::array::from_fn(|corner| {
        (corner & 1) + (corner >> 1 & 1) * layout.row() + (corner >> 2) * layout.plane()
    })
}

/// +1 where a corner lies on the upper side along an axis, else -1.
#[inline(always)]
pub(super) fn side(corner: usize, axis: usize) -> f64 {
    if corner >> axis & 1 == 1 { 1.0 } else { -1.0 }
}

simd_dispatch! {
    /// Adds the force of every cell's pressure [N] to its nodes, from their displacements [mm].
    pub(super) fn add_volume_forces(
        layout: &Layout,
        spacing: f64,
        cells: &Cells,
        moved: &Field,
        force: &mut Field,
    ) = [avx512, avx2] add_volume_forces_body
}

#[inline(always)]
fn add_volume_forces_body(
    layout: &Layout,
    spacing: f64,
    cells: &Cells,
    moved: &Field,
    force: &mut Field,
) {
    let corners = corners(layout);
    for (chunk, _) in cells.used.iter().enumerate().filter(|(_, used)| **used) {
        let start = chunk * CHUNK;
        let gradient = gradients(&corners, spacing, moved, start);
        let push = pushes(lanes(&cells.modulus, start), spacing, &gradient);
        for (corner, offset) in corners.iter().enumerate() {
            for axis in 0..3 {
                let there = lanes_mut(&mut force[axis], start + offset);
                let [px, py, pz] = &push[axis];
                let [sx, sy, sz] = [0, 1, 2].map(|along| side(corner, along));
                for n in 0..CHUNK {
                    there[n] -= sx * px[n] + sy * py[n] + sz * pz[n];
                }
            }
        }
    }
}

/// F of each cell: row = component of the place, column = axis along which it changes.
#[inline(always)]
fn gradients(corners: &[usize; 8], spacing: f64, moved: &Field, start: usize) -> [[Lanes; 3]; 3] {
    let scale = 1.0 / (4.0 * spacing);
    let mut gradient = [[[0.0; CHUNK]; 3]; 3];
    for axis in 0..3 {
        let at = corners.map(|offset| lanes(&moved[axis], start + offset));
        for n in 0..CHUNK {
            // sums and differences along x, then y, then z
            let low = [at[0][n] + at[1][n], at[2][n] + at[3][n]];
            let high = [at[4][n] + at[5][n], at[6][n] + at[7][n]];
            let low_step = [at[1][n] - at[0][n], at[3][n] - at[2][n]];
            let high_step = [at[5][n] - at[4][n], at[7][n] - at[6][n]];
            gradient[axis][0][n] =
                scale * ((low_step[0] + low_step[1]) + (high_step[0] + high_step[1]));
            gradient[axis][1][n] = scale * ((low[1] - low[0]) + (high[1] - high[0]));
            gradient[axis][2][n] = scale * ((high[0] + high[1]) - (low[0] + low[1]));
        }
    }
    for axis in 0..3 {
        for n in 0..CHUNK {
            gradient[axis][axis][n] += 1.0;
        }
    }
    gradient
}

/// How the volume of each cell grows with its corners' displacements, but for their signs [mm²].
#[inline(always)]
pub(super) fn cofactors(
    corners: &[usize; 8],
    spacing: f64,
    moved: &Field,
    start: usize,
) -> [[Lanes; 3]; 3] {
    let [x, y, z] = gradients(corners, spacing, moved, start);
    let scale = spacing * spacing / 4.0;
    let mut found = [[[0.0; CHUNK]; 3]; 3];
    for (own, (a, b)) in found.iter_mut().zip([(&y, &z), (&z, &x), (&x, &y)]) {
        for n in 0..CHUNK {
            own[0][n] = scale * (a[1][n] * b[2][n] - a[2][n] * b[1][n]);
            own[1][n] = scale * (a[2][n] * b[0][n] - a[0][n] * b[2][n]);
            own[2][n] = scale * (a[0][n] * b[1][n] - a[1][n] * b[0][n]);
        }
    }
    found
}

/// Pressure times the cofactors of F: how the energy grows with each row of corners.
#[inline(always)]
fn pushes(modulus: &Lanes, spacing: f64, gradient: &[[Lanes; 3]; 3]) -> [[Lanes; 3]; 3] {
    let scale = spacing * spacing / 4.0;
    let mut push = [[[0.0; CHUNK]; 3]; 3];
    let [x, y, z] = gradient;
    for n in 0..CHUNK {
        let cofactor = |a: &[Lanes; 3], b: &[Lanes; 3]| {
            [
                a[1][n] * b[2][n] - a[2][n] * b[1][n],
                a[2][n] * b[0][n] - a[0][n] * b[2][n],
                a[0][n] * b[1][n] - a[1][n] * b[0][n],
            ]
        };
        let [cx, cy, cz] = [cofactor(y, z), cofactor(z, x), cofactor(x, y)];
        let volume = x[0][n] * cx[0] + x[1][n] * cx[1] + x[2][n] * cx[2];
        let pressure = modulus[n] * (volume - 1.0) * scale;
        for along in 0..3 {
            push[0][along][n] = pressure * cx[along];
            push[1][along][n] = pressure * cy[along];
            push[2][along][n] = pressure * cz[along];
        }
    }
    push
}

/// Energy of the pressure of each cell [N·mm]; below 0 where it is pressed together. Shape [nodes].
pub(super) fn cell_energies(
    layout: &Layout,
    spacing: f64,
    cells: &Cells,
    moved: &Field,
) -> Vec<f64> {
    let mut energies = vec![0.0; layout.len()];
    add_cell_energies(layout, spacing, cells, moved, &mut energies);
    energies
}

/// Energy of all cells [N·mm].
pub(super) fn volume_energy(layout: &Layout, spacing: f64, cells: &Cells, moved: &Field) -> f64 {
    let energies = cell_energies(layout, spacing, cells, moved);
    energies.into_iter().map(f64::abs).sum()
}

simd_dispatch! {
    /// Adds the energy of each cell, with the sign of its change of volume [N·mm].
    fn add_cell_energies(
        layout: &Layout,
        spacing: f64,
        cells: &Cells,
        moved: &Field,
        energies: &mut [f64],
    ) = [avx512, avx2] add_cell_energies_body
}

#[inline(always)]
fn add_cell_energies_body(
    layout: &Layout,
    spacing: f64,
    cells: &Cells,
    moved: &Field,
    energies: &mut [f64],
) {
    let corners = corners(layout);
    let scale = 0.5 * spacing.powi(3);
    for (chunk, _) in cells.used.iter().enumerate().filter(|(_, used)| **used) {
        let start = chunk * CHUNK;
        let [x, y, z] = gradients(&corners, spacing, moved, start);
        let modulus = lanes(&cells.modulus, start);
        let energy = lanes_mut(energies, start);
        for n in 0..CHUNK {
            let volume = x[0][n] * (y[1][n] * z[2][n] - y[2][n] * z[1][n])
                + x[1][n] * (y[2][n] * z[0][n] - y[0][n] * z[2][n])
                + x[2][n] * (y[0][n] * z[1][n] - y[1][n] * z[0][n]);
            let growth = volume - 1.0;
            energy[n] += scale * modulus[n] * growth * growth.abs();
        }
    }
}
