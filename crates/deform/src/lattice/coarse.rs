//! A second, coarse level: the few smooth displacements of the whole box that iterations on
//! nodes find last.
//!
//! Iterations carry news one node further at a time, and the body behind the border is soft, so
//! that the box as a whole drifts slowly to its place. Its 12 affine displacements and the 3 of
//! a point force in the middle of the contact are therefore solved for directly: Newton's step
//! in the space of these 15, with their stiffness at rest and that of the contacts now.
//! Held nodes do not take part.

use glam::{DMat3, DVec3};

use super::nodes::Lattice;
use super::tool_contact::ContactNode;
use super::vectors::{Field, zero_field};

/// The 12 affine displacements and 3 of a point force.
const MODES: usize = 15;
/// Poisson's ratio of the point force; only the shape of a mode hangs on it.
const POINT_POISSON: f64 = 0.3;
type ModeVector = [f64; MODES];
type ModeMatrix = [[f64; MODES]; MODES];

/// The coarse level of a lattice.
#[derive(Clone, Debug)]
pub(super) struct Coarse {
    /// Where the contact is, and half the size of the box [mm].
    middle: DVec3,
    reach: f64,
    /// Places of nodes that move, scaled to about -1..1; the weight is 0 where held.
    coordinates: Field,
    weight: Vec<f64>,
    /// Displacement for each direction of the point force: xx, yy, zz, xy, xz, yz.
    point: [Vec<f64>; 6],
    stiffness: ModeMatrix,
}

impl Coarse {
    /// For a lattice in any state; `middle` is where the contact is expected [mm].
    pub fn new(lattice: &Lattice, middle: DVec3) -> Self {
        let length = lattice.layout.len();
        let mut coarse = Self {
            middle,
            reach: 0.5 * lattice.spacing * lattice.layout.size().as_dvec3().max_element(),
            coordinates: zero_field(length),
            weight: vec![0.0; length],
            point: std::array::from_fn(|_| vec![0.0; length]),
            stiffness: [[0.0; MODES]; MODES],
        };
        coarse.place_nodes(lattice);
        coarse.find_stiffness(lattice);
        coarse
    }

    fn place_nodes(&mut self, lattice: &Lattice) {
        for index in lattice.matter_nodes() {
            // a node held along one axis only is rare enough to be left to the iterations
            if (0..3).any(|axis| lattice.held[axis][index]) {
                continue;
            }
            let from_middle = lattice.rest_place(index) - self.middle;
            self.weight[index] = 1.0;
            for axis in 0..3 {
                self.coordinates[axis][index] = from_middle[axis] / self.reach;
            }
            let moved = self.point_displacement(from_middle, lattice.spacing);
            let entries = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
            for (values, (row, column)) in self.point.iter_mut().zip(entries) {
                values[index] = moved.col(column)[row];
            }
        }
    }

    /// Displacement of a point force, blunt at two spacings, of size 1 there.
    fn point_displacement(&self, from_middle: DVec3, spacing: f64) -> DMat3 {
        let blunt = 2.0 * spacing;
        let distance = (from_middle.length_squared() + blunt * blunt).sqrt();
        let radial = from_middle / distance;
        let along = DMat3::from_cols(radial * radial.x, radial * radial.y, radial * radial.z);
        (DMat3::IDENTITY * (3.0 - 4.0 * POINT_POISSON) + along) * (blunt / (3.0 * distance))
    }

    /// Stiffness of each mode at rest, by moving all nodes a little along it.
    fn find_stiffness(&mut self, lattice: &Lattice) {
        let mut probe = lattice.clone();
        let step = 1e-6 * lattice.spacing;
        for mode in 0..MODES {
            for axis in &mut probe.moved {
                axis.fill(0.0);
            }
            let mut shares = [0.0; MODES];
            shares[mode] = step;
            self.move_along(&shares, &mut probe.moved);
            probe.evaluate();
            let force = self.project(&probe.force);
            for other in 0..MODES {
                self.stiffness[other][mode] = -force[other] / step;
            }
        }
        for row in 0..MODES {
            for column in 0..row {
                let mean = 0.5 * (self.stiffness[row][column] + self.stiffness[column][row]);
                self.stiffness[row][column] = mean;
                self.stiffness[column][row] = mean;
            }
        }
    }

    /// Moves the nodes by Newton's step of the modes.
    pub fn correct(&self, lattice: &mut Lattice, contacts: &[ContactNode]) {
        let mut stiffness = self.stiffness;
        for contact in contacts {
            self.add_contact(&mut stiffness, contact);
        }
        let force = self.project(&lattice.force);
        let Some(shares) = solve(stiffness, force) else {
            return;
        };
        // no mode moves a node farther than a spacing
        let largest = shares
            .iter()
            .fold(0.0f64, |most, share| most.max(share.abs()));
        let scale = (lattice.spacing / largest.max(1e-300)).min(1.0);
        self.move_along(&shares.map(|share| share * scale), &mut lattice.moved);
    }

    fn add_contact(&self, stiffness: &mut ModeMatrix, contact: &ContactNode) {
        let along = self.mode_at(contact.node, contact.normal);
        for row in 0..MODES {
            for column in 0..MODES {
                stiffness[row][column] += contact.stiffness * along[row] * along[column];
            }
        }
    }

    /// How far each mode moves a node along a direction.
    fn mode_at(&self, index: usize, direction: DVec3) -> ModeVector {
        let at = [0, 1, 2].map(|axis| self.coordinates[axis][index]);
        let [xx, yy, zz, xy, xz, yz] = [0, 1, 2, 3, 4, 5].map(|entry| self.point[entry][index]);
        let weight = self.weight[index];
        let mut modes = [0.0; MODES];
        for axis in 0..3 {
            modes[4 * axis] = weight * direction[axis];
            for along in 0..3 {
                modes[4 * axis + 1 + along] = at[along] * direction[axis];
            }
        }
        let d = direction;
        modes[12] = xx * d.x + xy * d.y + xz * d.z;
        modes[13] = xy * d.x + yy * d.y + yz * d.z;
        modes[14] = xz * d.x + yz * d.y + zz * d.z;
        modes
    }

    /// The force along each mode.
    fn project(&self, force: &Field) -> ModeVector {
        let mut sums = [0.0; MODES];
        for index in 0..self.weight.len() {
            if self.weight[index] > 0.0 {
                let f = DVec3::new(force[0][index], force[1][index], force[2][index]);
                let modes = self.mode_at(index, f);
                for mode in 0..MODES {
                    sums[mode] += modes[mode];
                }
            }
        }
        sums
    }

    fn move_along(&self, shares: &ModeVector, moved: &mut Field) {
        // which of the six entries each row of the point force's matrix has
        let rows = [[0, 3, 4], [3, 1, 5], [4, 5, 2]];
        for axis in 0..3 {
            let [along_x, along_y, along_z] = [0, 1, 2].map(|along| &self.coordinates[along]);
            let [point_x, point_y, point_z] = rows[axis].map(|entry| &self.point[entry]);
            let affine = &shares[4 * axis..4 * axis + 4];
            for (index, moved) in moved[axis].iter_mut().enumerate() {
                // all of it is 0 where a node is held
                *moved += affine[0] * self.weight[index]
                    + affine[1] * along_x[index]
                    + affine[2] * along_y[index]
                    + affine[3] * along_z[index]
                    + shares[12] * point_x[index]
                    + shares[13] * point_y[index]
                    + shares[14] * point_z[index];
            }
        }
    }
}

/// Solves a symmetric positive system by Cholesky; a mode without stiffness stays where it is.
fn solve(mut matrix: ModeMatrix, mut right: ModeVector) -> Option<ModeVector> {
    let scale = (0..MODES).map(|n| matrix[n][n]).fold(0.0, f64::max);
    if !(scale > 0.0 && scale.is_finite()) {
        return None;
    }
    for column in 0..MODES {
        for row in column..MODES {
            let mut sum = matrix[row][column];
            for n in 0..column {
                sum -= matrix[row][n] * matrix[column][n];
            }
            if row == column {
                matrix[row][row] = if sum > 1e-10 * scale {
                    sum.sqrt()
                } else {
                    f64::INFINITY
                };
            } else {
                matrix[row][column] = sum / matrix[column][column];
            }
        }
    }
    for row in 0..MODES {
        for n in 0..row {
            right[row] -= matrix[row][n] * right[n];
        }
        right[row] /= matrix[row][row];
    }
    for row in (0..MODES).rev() {
        for n in row + 1..MODES {
            right[row] -= matrix[n][row] * right[n];
        }
        right[row] /= matrix[row][row];
    }
    right.iter().all(|share| share.is_finite()).then_some(right)
}
