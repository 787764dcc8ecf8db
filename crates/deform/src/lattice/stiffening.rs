//! Strain stiffening: the bonds of a node grow stiffer with the energy that they hold.
//!
//! A node holds the energy E of its halves of its bonds. Its strain X = 15 E / C, with C the energy of
//! the same bonds twice as long as at rest, is a mean square of their strains, and I₁ − 3 of a body that
//! keeps its volume, to the second order of strain. The node's energy is that of Demiray's law, an
//! exponential of Fung's kind in I₁: C / (15 b) · (exp(b X) − 1), which is E where the exponent b is 0. So the
//! force of a bond is that of its spring, times exp(b X) of its two nodes: an exact gradient,
//! isotropic, of any spacing. From [`STRAIGHT_FROM`] on the energy grows in proportion to E, so that
//! nothing is more than e³ = 20 times as stiff as its springs.
//!
//! The two halves of a bond are springs in series: each holds energy by its compliance. The pressure of
//! the cells does not stiffen.
//!
//! Source: Demiray, J. Biomech. 5 (1972), 309; Fung, Am. J. Physiol. 213 (1967), 1532.

use palpate_volume::simd_dispatch;

use super::bond_forces::{Bonds, rest_length};
use super::layout::{CHUNK, FAMILIES, FAMILY_COUNT, Layout};
use super::nodes::Lattice;
use super::vectors::{Field, Lanes, lanes, lanes_mut};

/// Exponent b X from which on bonds stiffen no more.
const STRAIGHT_FROM: f64 = 3.0;
/// X of a uniform strain over the mean square of the strains of bonds, each weighted by k l²: 15 springs
/// k (6 faces, 12 edges twice as strong, by halves) hold the energy of a shear modulus k / h.
const BONDS: f64 = 15.0;
/// Share of a node's C that its bonds to one side have: 9 of 30.
const PLANE: f64 = 0.3;

/// What stiffens in a lattice. Shape of each array [nodes], of bonds at the lower node.
#[derive(Clone, Debug)]
pub(super) struct Stiffening {
    /// b of each node.
    exponent: Vec<f64>,
    /// Energy that a node's halves of bonds hold at a strain of 1 each, C [N·mm].
    full: Vec<f64>,
    /// Share of a bond's energy that its lower node holds.
    lower: [Vec<f64>; FAMILY_COUNT],
}

impl Stiffening {
    /// Of a lattice with these bonds; none where nothing stiffens.
    pub fn of(lattice: &Lattice) -> Option<Self> {
        let layout = &lattice.layout;
        let exponent_of = |index: usize| {
            let solid = lattice.matter[index].solid();
            solid
                .filter(|_| lattice.is_mobile(index))
                .map_or(0.0, |solid| solid.stiffening)
        };
        let exponent: Vec<f64> = (0..layout.len())
            .map(|index| layout.node_at(index).map_or(0.0, |_| exponent_of(index)))
            .collect();
        exponent.iter().any(|b| *b > 0.0).then(|| {
            let mut stiffening = Self {
                exponent,
                full: vec![0.0; layout.len()],
                lower: std::array::from_fn(|_| vec![0.5; layout.len()]),
            };
            stiffening.share_bonds(lattice);
            stiffening
        })
    }

    fn share_bonds(&mut self, lattice: &Lattice) {
        for family in 0..FAMILY_COUNT {
            let (offset, length) = (
                lattice.layout.offset(family),
                rest_length(family, lattice.spacing),
            );
            for (_, index) in lattice.layout.nodes() {
                let stiffness = lattice.bonds.stiffness[family][index];
                if stiffness > 0.0 {
                    let [near, far] = [index, index + offset].map(|n| lattice.node_stiffness[n]);
                    let lower = far / (near + far);
                    let energy = 0.5 * stiffness * length * length;
                    self.lower[family][index] = lower;
                    self.full[index] += lower * energy;
                    self.full[index + offset] += (1.0 - lower) * energy;
                }
            }
        }
    }

    /// Energy that each node's halves of bonds hold as springs [N·mm].
    fn held(&self, lattice: &Lattice, moved: &Field) -> Vec<f64> {
        let mut held = vec![0.0; lattice.layout.len()];
        add_bond_energies(
            &lattice.layout,
            lattice.spacing,
            &lattice.bonds,
            &self.lower,
            moved,
            &mut held,
        );
        held
    }

    /// b X of a node that holds so much.
    fn strained(&self, index: usize, held: f64) -> f64 {
        if held > 0.0 {
            BONDS * self.exponent[index] * held / self.full[index]
        } else {
            0.0
        }
    }

    /// How many times as hard the bonds of each node pull as their springs.
    pub fn growth(&self, lattice: &Lattice, moved: &Field) -> Vec<f64> {
        let mut held = self.held(lattice, moved);
        for (index, held) in held.iter_mut().enumerate() {
            *held = growth(self.strained(index, *held));
        }
        held
    }

    /// The exponent b X of each node as it stands.
    pub fn exponents(&self, lattice: &Lattice) -> Vec<f64> {
        let mut held = self.held(lattice, &lattice.moved);
        for (index, held) in held.iter_mut().enumerate() {
            *held = self.strained(index, *held);
        }
        held
    }

    /// Energy of all bonds [N·mm].
    pub fn energy(&self, lattice: &Lattice) -> f64 {
        let held = self.held(lattice, &lattice.moved);
        let of_node = |(index, held): (usize, &f64)| match self.strained(index, *held) {
            // no strain, or no exponent
            0.0 => *held,
            strained => held * energy(strained) / strained,
        };
        held.iter().enumerate().map(of_node).sum()
    }

    /// How many times the energy of springs a plane of bonds sets free that all tear at this strain, by the
    /// exponents of their nodes.
    pub fn set_free(
        &self,
        exponents: &[f64],
        [family, index]: [usize; 2],
        offset: usize,
        strain: f64,
    ) -> f64 {
        let lower = self.lower[family][index];
        let of = |node: usize| {
            let plane = BONDS * PLANE * self.exponent[node] * strain * strain;
            set_free(exponents[node], plane)
        };
        lower * of(index) + (1.0 - lower) * of(index + offset)
    }

    /// Makes the stiffness of a chunk of bonds that of stiffened ones.
    #[inline(always)]
    pub fn stiffen(
        &self,
        growth: &[f64],
        family: usize,
        [start, offset]: [usize; 2],
        stiffness: &mut Lanes,
    ) {
        let lower = lanes(&self.lower[family], start);
        let [near, far] = [lanes(growth, start), lanes(growth, start + offset)];
        for n in 0..CHUNK {
            stiffness[n] *= lower[n] * near[n] + (1.0 - lower[n]) * far[n];
        }
    }

    /// Stiffness that a node's bonds have by now beyond that of their springs [N/mm], about: 0.8 C / h²
    /// is what they have along an axis.
    pub fn added_stiffness(&self, lattice: &Lattice) -> Vec<f64> {
        let growth = self.growth(lattice, &lattice.moved);
        let scale = 0.8 / (lattice.spacing * lattice.spacing);
        let full = growth.iter().zip(&self.full);
        full.map(|(growth, full)| (growth - 1.0) * full * scale)
            .collect()
    }
}

/// exp(y), which stays as it is beyond [`STRAIGHT_FROM`].
fn growth(y: f64) -> f64 {
    if y == 0.0 {
        1.0
    } else {
        y.min(STRAIGHT_FROM).exp()
    }
}

/// The sum of [`growth`] from 0 to y.
fn energy(y: f64) -> f64 {
    let curved = y.min(STRAIGHT_FROM);
    curved.exp_m1() + curved.exp() * (y - curved)
}

/// Of a node at the exponent y, of which bonds to one side hold `plane`: the energy that these set free,
/// over that of their springs. The rest of its bonds stays with the rest of its volume.
fn set_free(y: f64, plane: f64) -> f64 {
    let taken = plane.min(y);
    if taken > 0.0 {
        let rest = 1.0 - PLANE;
        (energy(y) - rest * energy((y - taken) / rest)) / taken
    } else {
        1.0
    }
}

simd_dispatch! {
    /// Adds the energy of every bond as a spring [N·mm] to its nodes, by their shares.
    fn add_bond_energies(
        layout: &Layout,
        spacing: f64,
        bonds: &Bonds,
        lower: &[Vec<f64>; FAMILY_COUNT],
        moved: &Field,
        held: &mut [f64],
    ) = [avx512, avx2] add_bond_energies_body
}

#[inline(always)]
fn add_bond_energies_body(
    layout: &Layout,
    spacing: f64,
    bonds: &Bonds,
    lower: &[Vec<f64>; FAMILY_COUNT],
    moved: &Field,
    held: &mut [f64],
) {
    let tiny = (1e-9 * spacing).powi(2);
    for (chunk, _) in bonds.used.iter().enumerate().filter(|(_, used)| **used) {
        let start = chunk * CHUNK;
        let [x, y, z] = [0, 1, 2].map(|axis| lanes(&moved[axis], start));
        for family in 0..FAMILY_COUNT {
            let offset = layout.offset(family);
            let step = FAMILIES[family].map(|step| f64::from(step) * spacing);
            let [far_x, far_y, far_z] = [0, 1, 2].map(|axis| lanes(&moved[axis], start + offset));
            let stiffness = lanes(&bonds.stiffness[family], start);
            let rest = lanes(&bonds.rest[family], start);
            let lower = lanes(&lower[family], start);
            let mut energy: Lanes = [0.0; CHUNK];
            for n in 0..CHUNK {
                let [dx, dy, dz] = [
                    step[0] + (far_x[n] - x[n]),
                    step[1] + (far_y[n] - y[n]),
                    step[2] + (far_z[n] - z[n]),
                ];
                let longer = (dx * dx + dy * dy + dz * dz + tiny).sqrt() - rest[n];
                energy[n] = 0.5 * stiffness[n] * longer * longer;
            }
            let near = lanes_mut(held, start);
            for n in 0..CHUNK {
                near[n] += lower[n] * energy[n];
            }
            let far = lanes_mut(held, start + offset);
            for n in 0..CHUNK {
                far[n] += (1.0 - lower[n]) * energy[n];
            }
        }
    }
}
