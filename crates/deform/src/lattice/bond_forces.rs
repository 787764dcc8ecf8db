//! Forces of all bonds: springs on their length, family by family over straight runs of memory.
//!
//! A bond of stiffness k and rest length l between nodes r apart pulls with k · (r - l). Its
//! energy is k/2 · (r - l)². Where tissue stiffens with strain, both grow (`stiffening.rs`). Broken bonds
//! and those to nodes that do not exist have k = 0.

use palpate_volume::simd_dispatch;

use super::layout::{CHUNK, FAMILIES, FAMILY_COUNT, Layout};
use super::stiffening::Stiffening;
use super::vectors::{Field, Lanes, lanes, lanes_mut};

/// All bonds of a box. Shape of each array [nodes], at the lower node.
#[derive(Clone, Debug)]
pub(super) struct Bonds {
    /// Stiffness [N/mm]; 0 where there is none.
    pub stiffness: [Vec<f64>; FAMILY_COUNT],
    /// Rest length [mm].
    pub rest: [Vec<f64>; FAMILY_COUNT],
    /// Whether a chunk of nodes has any bond.
    pub used: Vec<bool>,
}

impl Bonds {
    /// No bonds yet; rest lengths are those of the lattice.
    pub fn none(layout: &Layout, spacing: f64) -> Self {
        Self {
            stiffness: std::array::from_fn(|_| vec![0.0; layout.len()]),
            rest: std::array::from_fn(|family| vec![rest_length(family, spacing); layout.len()]),
            used: vec![false; layout.chunks()],
        }
    }

    /// Finds the chunks that have bonds.
    pub fn find_used(&mut self) {
        for (chunk, used) in self.used.iter_mut().enumerate() {
            let nodes = chunk * CHUNK..(chunk + 1) * CHUNK;
            let any = |family: &Vec<f64>| family[nodes.clone()].iter().any(|k| *k > 0.0);
            *used = self.stiffness.iter().any(any);
        }
    }
}

/// Length of the bonds of a family at rest [mm].
pub(super) fn rest_length(family: usize, spacing: f64) -> f64 {
    let [x, y, z] = FAMILIES[family].map(f64::from);
    spacing * (x * x + y * y + z * z).sqrt()
}

simd_dispatch! {
    /// Adds the force of every bond [N] to both of its nodes, from their displacements [mm]. `stiffened`:
    /// how the bonds of each node have grown, where any do.
    pub(super) fn add_bond_forces(
        layout: &Layout,
        spacing: f64,
        bonds: &Bonds,
        stiffened: Option<(&Stiffening, &[f64])>,
        moved: &Field,
        force: &mut Field,
    ) = [avx512, avx2] add_bond_forces_body
}

#[inline(always)]
fn add_bond_forces_body(
    layout: &Layout,
    spacing: f64,
    bonds: &Bonds,
    stiffened: Option<(&Stiffening, &[f64])>,
    moved: &Field,
    force: &mut Field,
) {
    let offsets: [usize; FAMILY_COUNT] = std::array::from_fn(|family| layout.offset(family));
    // keeps a bond of no length from dividing by zero
    let tiny = (1e-9 * spacing).powi(2);
    for (chunk, _) in bonds.used.iter().enumerate().filter(|(_, used)| **used) {
        let start = chunk * CHUNK;
        let [x, y, z] = [0, 1, 2].map(|axis| lanes(&moved[axis], start));
        let mut sum: [Lanes; 3] = [[0.0; CHUNK]; 3];
        for (family, &offset) in offsets.iter().enumerate() {
            let step = FAMILIES[family].map(|step| f64::from(step) * spacing);
            let [far_x, far_y, far_z] = [0, 1, 2].map(|axis| lanes(&moved[axis], start + offset));
            let mut stiffness = *lanes(&bonds.stiffness[family], start);
            if let Some((stiffening, growth)) = stiffened {
                stiffening.stiffen(growth, family, [start, offset], &mut stiffness);
            }
            let rest = lanes(&bonds.rest[family], start);

            let mut pull: [Lanes; 3] = [[0.0; CHUNK]; 3];
            for n in 0..CHUNK {
                let [dx, dy, dz] = [
                    step[0] + (far_x[n] - x[n]),
                    step[1] + (far_y[n] - y[n]),
                    step[2] + (far_z[n] - z[n]),
                ];
                let length = (dx * dx + dy * dy + dz * dz + tiny).sqrt();
                let share = stiffness[n] * (1.0 - rest[n] / length);
                pull[0][n] = share * dx;
                pull[1][n] = share * dy;
                pull[2][n] = share * dz;
            }
            for axis in 0..3 {
                let far = lanes_mut(&mut force[axis], start + offset);
                for n in 0..CHUNK {
                    sum[axis][n] += pull[axis][n];
                    far[n] -= pull[axis][n];
                }
            }
        }
        for axis in 0..3 {
            let near = lanes_mut(&mut force[axis], start);
            for n in 0..CHUNK {
                near[n] += sum[axis][n];
            }
        }
    }
}

/// Energy of all bonds that do not stiffen [N·mm].
pub(super) fn bond_energy(layout: &Layout, spacing: f64, bonds: &Bonds, moved: &Field) -> f64 {
    let mut energy = 0.0;
    for family in 0..FAMILY_COUNT {
        for (_, index) in layout.nodes() {
            let stiffness = bonds.stiffness[family][index];
            if stiffness > 0.0 {
                let length = bond_length(layout, spacing, moved, family, index);
                energy += 0.5 * stiffness * (length - bonds.rest[family][index]).powi(2);
            }
        }
    }
    energy
}

/// Length of a bond as its nodes stand [mm].
pub(super) fn bond_length(
    layout: &Layout,
    spacing: f64,
    moved: &Field,
    family: usize,
    index: usize,
) -> f64 {
    let far = index + layout.offset(family);
    let along = |axis: usize| {
        f64::from(FAMILIES[family][axis]) * spacing + moved[axis][far] - moved[axis][index]
    };
    let [x, y, z] = [along(0), along(1), along(2)];
    (x * x + y * y + z * z).sqrt()
}
