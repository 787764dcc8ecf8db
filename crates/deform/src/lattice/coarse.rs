//! A second, coarse level: the few smooth displacements of the whole box that iterations on
//! nodes find last.
//!
//! Iterations carry news one node further at a time, and the body behind the border is soft, so
//! that the box as a whole drifts slowly to its place. Its 12 affine displacements and the 3 of
//! a point force in the middle of the contact are therefore solved for directly in every
//! iteration, with their stiffness at rest and that of the contacts now (an additive two-level
//! preconditioner). Held nodes do not take part.
//! Source: Smith, Bjørstad & Gropp, Domain Decomposition (1996), chapter 2.

use glam::{DMat3, DVec3, IVec3};
use palpate_volume::simd_dispatch;

use super::layout::CHUNK;
use super::moduli::LatticeModuli;
use super::nodes::Lattice;
use super::tool_contact::ContactNode;
use super::vectors::{Field, Lanes, lanes, lanes_mut, zero_field};

/// The 12 affine displacements and 3 of a point force.
pub(super) const MODES: usize = 15;
type ModeVector = [f64; MODES];
type ModeMatrix = [[f64; MODES]; MODES];

/// How far a box goes on with the stiffness that its modes had [nodes], and by which share the nodes that
/// move may be more or fewer then: it only eases iterations, and must be about that of the tissue.
const SERVES: i32 = 6;
const ALIKE: f64 = 0.05;

/// The coarse level of a lattice.
#[derive(Clone, Debug)]
pub(super) struct Coarse {
    /// Distance that the box has moved since the stiffness was computed [nodes].
    gone: i32,
    /// Number of nodes that could move then.
    mobile: usize,
    /// Where the contact is, and half the size of the box [mm].
    middle: DVec3,
    reach: f64,
    /// Places of nodes that move, scaled to about -1..1; the weight is 0 where held.
    coordinates: Field,
    weight: Vec<f64>,
    /// Where the chunks of nodes begin of which any takes part.
    chunks: Vec<usize>,
    /// Displacement for each direction of the point force: xx, yy, zz, xy, xz, yz.
    point: [Vec<f64>; 6],
    stiffness: ModeMatrix,
}

impl Coarse {
    /// For a lattice in any state; `middle` is where the contact is expected [mm].
    pub fn new(lattice: &Lattice, middle: DVec3) -> Self {
        let length = lattice.layout.len();
        let mut coarse = Self {
            gone: 0,
            mobile: mobile_nodes(lattice),
            middle,
            reach: 0.5 * lattice.spacing * lattice.layout.size().as_dvec3().max_element(),
            coordinates: zero_field(length),
            weight: vec![0.0; length],
            chunks: Vec::new(),
            point: std::array::from_fn(|_| vec![0.0; length]),
            stiffness: [[0.0; MODES]; MODES],
        };
        coarse.place_nodes(lattice);
        coarse.find_stiffness(lattice);
        coarse
    }

    /// Whether the stiffness of its modes serves a lattice that has gone so many more nodes on.
    pub fn serves(&self, lattice: &Lattice, gone: IVec3) -> bool {
        let more = mobile_nodes(lattice).abs_diff(self.mobile) as f64;
        self.gone + gone.abs().max_element() <= SERVES && more <= ALIKE * self.mobile as f64
    }

    /// For a lattice that has gone on, with the stiffness that the modes had before.
    pub fn at(mut self, lattice: &Lattice, gone: IVec3) -> Self {
        self.gone += gone.abs().max_element();
        self.weight.fill(0.0);
        for values in self.coordinates.iter_mut().chain(&mut self.point) {
            values.fill(0.0);
        }
        self.place_nodes(lattice);
        self
    }

    fn place_nodes(&mut self, lattice: &Lattice) {
        let poisson = mean_poisson(lattice);
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
            let moved = point_displacement(from_middle, poisson, lattice.spacing);
            let entries = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
            for (values, (row, column)) in self.point.iter_mut().zip(entries) {
                values[index] = moved.col(column)[row];
            }
        }
        let starts = (0..self.weight.len()).step_by(CHUNK);
        let takes_part = |start: &usize| lanes(&self.weight, *start).iter().any(|w| *w > 0.0);
        self.chunks = starts.filter(takes_part).collect();
    }

    /// Stiffness of each mode at rest, by moving all nodes a little along it.
    fn find_stiffness(&mut self, lattice: &Lattice) {
        let length = lattice.layout.len();
        let [mut moved, mut force] = [zero_field(length), zero_field(length)];
        let step = 1e-6 * lattice.spacing;
        for mode in 0..MODES {
            for axis in &mut moved {
                axis.fill(0.0);
            }
            let mut shares = [0.0; MODES];
            shares[mode] = step;
            self.move_along(&shares, &mut moved);
            lattice.forces_at(&moved, &mut force);
            let force = self.project(&force);
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

    /// The stiffness of the modes with that of contacts, ready to be solved with.
    pub fn factor(&self, contacts: &[ContactNode]) -> CoarseFactor {
        let mut stiffness = self.stiffness;
        for contact in contacts {
            self.add_contact(&mut stiffness, contact);
        }
        CoarseFactor(factor(stiffness))
    }

    /// Adds to each node's displacement what the modes give under these forces.
    pub fn add_response(&self, factor: &CoarseFactor, force: &Field, moved: &mut Field) {
        let shares = factor.solve(self.project(force));
        self.move_along(&shares, moved);
    }

    fn add_contact(&self, stiffness: &mut ModeMatrix, contact: &ContactNode) {
        let along = self.mode_at(contact.node, contact.normal);
        for row in 0..MODES {
            for column in 0..MODES {
                stiffness[row][column] += contact.stiffness * along[row] * along[column];
            }
        }
    }

    /// Displacement of a node along a direction by each mode of amplitude 1.
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
        project(self, force, &mut sums);
        sums
    }

    fn move_along(&self, shares: &ModeVector, moved: &mut Field) {
        move_along(self, shares, moved);
    }
}

fn mobile_nodes(lattice: &Lattice) -> usize {
    let matter = lattice.matter_nodes();
    matter.filter(|node| lattice.is_mobile(*node)).count()
}

/// Displacement of a point force, blunt at two spacings, of size 1 there.
fn point_displacement(from_middle: DVec3, poisson: f64, spacing: f64) -> DMat3 {
    let blunt = 2.0 * spacing;
    let distance = (from_middle.length_squared() + blunt * blunt).sqrt();
    let radial = from_middle / distance;
    let along = DMat3::from_cols(radial * radial.x, radial * radial.y, radial * radial.z);
    (DMat3::IDENTITY * (3.0 - 4.0 * poisson) + along) * (blunt / (3.0 * distance))
}

/// Mean Poisson's ratio of the nodes that move, on which the shape of the point-force modes
/// depends.
fn mean_poisson(lattice: &Lattice) -> f64 {
    let moving = lattice
        .matter_nodes()
        .filter(|node| lattice.is_mobile(*node));
    let solids = moving.filter_map(|node| lattice.matter(node).solid());
    let poissons = solids.map(|solid| LatticeModuli::of(solid, lattice.spacing).poisson);
    let (sum, count) = poissons.fold((0.0, 0.0), |(sum, count), nu| (sum + nu, count + 1.0));
    sum / f64::max(count, 1.0)
}

/// Which of the six entries of the point force's matrix each row has.
const ROWS: [[usize; 3]; 3] = [[0, 3, 4], [3, 1, 5], [4, 5, 2]];

simd_dispatch! {
    /// The force along each mode.
    fn project(coarse: &Coarse, force: &Field, sums: &mut ModeVector)
        = [avx512, avx2] project_body
}

#[inline(always)]
fn project_body(coarse: &Coarse, force: &Field, sums: &mut ModeVector) {
    let mut lanewise: [Lanes; MODES] = [[0.0; CHUNK]; MODES];
    for &start in &coarse.chunks {
        let weight = lanes(&coarse.weight, start);
        let along = [0, 1, 2].map(|axis| lanes(&coarse.coordinates[axis], start));
        for axis in 0..3 {
            let force = lanes(&force[axis], start);
            let point = ROWS[axis].map(|entry| lanes(&coarse.point[entry], start));
            for n in 0..CHUNK {
                lanewise[4 * axis][n] += weight[n] * force[n];
                lanewise[4 * axis + 1][n] += along[0][n] * force[n];
                lanewise[4 * axis + 2][n] += along[1][n] * force[n];
                lanewise[4 * axis + 3][n] += along[2][n] * force[n];
            }
            for n in 0..CHUNK {
                lanewise[12][n] += point[0][n] * force[n];
                lanewise[13][n] += point[1][n] * force[n];
                lanewise[14][n] += point[2][n] * force[n];
            }
        }
    }
    *sums = lanewise.map(|lanes| lanes.iter().sum());
}

simd_dispatch! {
    /// Moves all nodes along the modes; none of them moves a node that is held.
    fn move_along(coarse: &Coarse, shares: &ModeVector, moved: &mut Field)
        = [avx512, avx2] move_along_body
}

#[inline(always)]
fn move_along_body(coarse: &Coarse, shares: &ModeVector, moved: &mut Field) {
    let point_shares = [shares[12], shares[13], shares[14]];
    for &start in &coarse.chunks {
        let weight = lanes(&coarse.weight, start);
        let along = [0, 1, 2].map(|axis| lanes(&coarse.coordinates[axis], start));
        for axis in 0..3 {
            let point = ROWS[axis].map(|entry| lanes(&coarse.point[entry], start));
            let affine = [0, 1, 2, 3].map(|n| shares[4 * axis + n]);
            let moved = lanes_mut(&mut moved[axis], start);
            for n in 0..CHUNK {
                moved[n] += affine[0] * weight[n]
                    + affine[1] * along[0][n]
                    + affine[2] * along[1][n]
                    + affine[3] * along[2][n]
                    + point_shares[0] * point[0][n]
                    + point_shares[1] * point[1][n]
                    + point_shares[2] * point[2][n];
            }
        }
    }
}

/// The stiffness of all modes, as the lower triangle of Cholesky; none where it is none.
#[derive(Clone, Debug, Default)]
pub(super) struct CoarseFactor(Option<ModeMatrix>);

impl CoarseFactor {
    /// Amplitude of each mode under these forces.
    fn solve(&self, mut right: ModeVector) -> ModeVector {
        let Some(lower) = &self.0 else {
            return [0.0; MODES];
        };
        for row in 0..MODES {
            for n in 0..row {
                right[row] -= lower[row][n] * right[n];
            }
            right[row] /= lower[row][row];
        }
        for row in (0..MODES).rev() {
            for n in row + 1..MODES {
                right[row] -= lower[n][row] * right[n];
            }
            right[row] /= lower[row][row];
        }
        right
    }
}

/// Cholesky's lower triangle of a symmetric positive matrix; a mode without stiffness stays
/// where it is.
fn factor(mut matrix: ModeMatrix) -> Option<ModeMatrix> {
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
            if row > column {
                matrix[row][column] = sum / matrix[column][column];
            } else if sum > 1e-10 * scale {
                matrix[row][row] = sum.sqrt();
            } else {
                matrix[row][row] = f64::INFINITY;
            }
        }
    }
    Some(matrix)
}
