//! One linear problem of the relaxation: which step brings all forces to zero, as far as their
//! change is linear.
//!
//! Conjugate gradients with each node's own stiffness and the coarse level as preconditioner, so
//! that soft and hard tissue come to rest equally fast, and large boxes as fast as small ones. The
//! change of the forces along a direction is told by their difference over a short way along it; no
//! matrix is built. Chunks of nodes of which none moves, as air and bone, are passed over.
//! Source: Nocedal & Wright, Numerical Optimization (2006), algorithms 5.3 and 7.1.

use palpate_volume::simd_dispatch;

use super::coarse::{Coarse, CoarseFactor};
use super::layout::CHUNK;
use super::nodes::Lattice;
use super::pressure_easing::PressureEasing;
use super::vectors::{Field, Lanes, lanes, lanes_mut, zero_field};

/// Largest displacement of a node when the change of forces is probed [spacings].
const PROBE: f64 = 1e-4;

/// What eases a problem: a guess of where forces bring the nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Easing<'a> {
    /// One over the stiffness that a node feels along each axis; 0 where held.
    pub mobility: &'a Field,
    /// The smooth displacements of the whole box.
    pub coarse: Option<(&'a Coarse, &'a CoarseFactor)>,
}

impl<'a> Easing<'a> {
    /// A preconditioner with the coarse level of a lattice, where it has one.
    pub fn of(mobility: &'a Field, lattice: &'a Lattice, factor: &'a CoarseFactor) -> Self {
        let coarse = lattice.coarse.as_ref();
        Self {
            mobility,
            coarse: coarse.map(|coarse| (coarse, factor)),
        }
    }
}

/// A linear problem and how far it is solved. Each field has a value for each node.
#[derive(Clone, Debug, Default)]
pub(super) struct Conjugate {
    /// Where the chunks of nodes begin of which any moves.
    chunks: Vec<usize>,
    /// What the cells hold of a response.
    pressures: PressureEasing,
    /// Where the nodes stand, and the forces there.
    place: Field,
    force: Field,
    /// The step so far.
    pub step: Field,
    /// Forces that are left after it.
    left: Field,
    direction: Field,
    /// Decrease of the forces along the direction.
    fall: Field,
    /// Where the forces that are left would bring the nodes.
    response: Field,
    /// Forces left along their response.
    weight: f64,
    first_weight: f64,
    /// Force squared at the beginning [N²].
    first_left: f64,
    scale: f64,
    /// Largest component of the step [mm].
    longest: f64,
}

impl Conjugate {
    /// The problem of the nodes as they stand, and the forces that they feel, less those that are to
    /// `stay`.
    pub fn begin(&mut self, lattice: &Lattice, easing: &Easing<'_>, stay: Option<&Field>) {
        let length = lattice.layout.len();
        self.chunks = chunks_of(easing.mobility);
        self.pressures.prepare(lattice, easing.mobility);
        self.place.clone_from(&lattice.moved);
        self.force.clone_from(&lattice.force);
        self.left.clone_from(&lattice.force);
        for (left, stay) in self.left.iter_mut().zip(stay.into_iter().flatten()) {
            left.iter_mut()
                .zip(stay)
                .for_each(|(left, stay)| *left -= stay);
        }
        for field in [
            &mut self.step,
            &mut self.direction,
            &mut self.fall,
            &mut self.response,
        ] {
            *field = zero_field(length);
        }
        let mut sums = Sums::default();
        self.first_left = unbalanced(easing.mobility, &self.left);
        self.longest = 0.0;
        descend(easing.mobility, 0.0, self, &mut sums);
        self.first_weight = self.ease(easing, sums.weight);
        self.weight = self.first_weight;
        turn(0.0, self);
    }

    /// Takes the pressures of cells off the response of the nodes alone, adds that of the coarse
    /// level, and gives the forces along all of it.
    fn ease(&mut self, easing: &Easing<'_>, weight: f64) -> f64 {
        if easing.coarse.is_none() && self.pressures.is_none() {
            return weight;
        }
        self.pressures.hold(easing.mobility, &mut self.response);
        if let Some((coarse, factor)) = easing.coarse {
            coarse.add_response(factor, &self.left, &mut self.response);
        }
        let mut along = 0.0;
        dot(&self.chunks, &self.left, &self.response, &mut along);
        along
    }

    /// Moves the nodes a little along the direction.
    pub fn probe(&mut self, spacing: f64, moved: &mut Field) {
        let longest = longest(&self.chunks, &self.direction);
        self.scale = PROBE * spacing / longest.max(f64::MIN_POSITIVE);
        place_along(
            &self.chunks,
            &self.place,
            self.scale,
            &self.direction,
            moved,
        );
    }

    /// Goes on with the forces that the probe felt, and gives what is left of them squared [N²];
    /// none where the forces do not fall along the direction, and the step is as good as it gets.
    pub fn advance(&mut self, force: &Field, easing: &Easing<'_>) -> Option<f64> {
        let mut along = 0.0;
        look(easing.mobility, force, self, &mut along);
        // comparisons with NaN are false
        if !(along > 0.0 && along.is_finite()) {
            return None;
        }
        let mut sums = Sums::default();
        descend(easing.mobility, self.weight / along, self, &mut sums);
        self.longest = sums.longest;
        let weight = self.ease(easing, sums.weight);
        let share = weight / self.weight;
        self.weight = weight;
        turn(share, self);
        Some(sums.left)
    }

    /// Another step: each node goes where the force at its beginning brings it alone.
    pub fn respond_each(&mut self, mobility: &Field) {
        for axis in 0..3 {
            let each = self.force[axis].iter().zip(&mobility[axis]);
            let each = each.map(|(force, mobility)| force * mobility);
            self.step[axis].clear();
            self.step[axis].extend(each);
        }
        self.longest = longest(&self.chunks, &self.step);
    }

    /// How much smaller the forces are than at the beginning, as the problem sees them.
    pub fn gain(&self) -> f64 {
        (self.weight / self.first_weight).sqrt()
    }

    /// Force squared of all nodes that move, before any step [N²].
    pub fn first_left(&self) -> f64 {
        self.first_left
    }

    /// Forces along the whole step [N·mm]: those at its beginning, and others there.
    pub fn along_step(&self, force: &Field) -> [f64; 2] {
        [&self.force, force].map(|force| {
            let mut along = 0.0;
            dot(&self.chunks, force, &self.step, &mut along);
            along
        })
    }

    /// Puts the nodes at a share of the step.
    pub fn go(&self, share: f64, moved: &mut Field) {
        place_along(&self.chunks, &self.place, share, &self.step, moved);
    }

    /// The longest part of the step along an axis [mm].
    pub fn longest_step(&self) -> f64 {
        self.longest
    }
}

/// What all nodes tell together.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    /// Forces left, squared, by mobility.
    weight: f64,
    /// Sum of squares of the residual forces themselves [N²].
    left: f64,
    /// The longest step along an axis [mm].
    longest: f64,
}

/// Force squared of all nodes that move [N²].
pub(super) fn unbalanced(mobility: &Field, force: &Field) -> f64 {
    let mut sum = 0.0;
    for (mobility, force) in mobility.iter().zip(force) {
        let each = mobility.iter().zip(force);
        sum += each
            .map(|(w, f)| if *w > 0.0 { f * f } else { 0.0 })
            .sum::<f64>();
    }
    sum
}

/// Where the chunks begin of which any value is above 0.
fn chunks_of(mobility: &Field) -> Vec<usize> {
    let starts = (0..mobility[0].len()).step_by(CHUNK);
    let moves = |start: &usize| {
        let mut axes = mobility.iter();
        axes.any(|axis| lanes(axis, *start).iter().any(|value| *value > 0.0))
    };
    starts.filter(moves).collect()
}

fn longest(chunks: &[usize], field: &Field) -> f64 {
    let mut most: Lanes = [0.0; CHUNK];
    for axis in field {
        for &start in chunks {
            let values = lanes(axis, start);
            for n in 0..CHUNK {
                most[n] = most[n].max(values[n].abs());
            }
        }
    }
    most.into_iter().fold(0.0, f64::max)
}

simd_dispatch! {
    /// place + share · direction.
    fn place_along(
        chunks: &[usize],
        place: &Field,
        share: f64,
        direction: &Field,
        moved: &mut Field,
    ) = [avx512, avx2] place_along_body
}

#[inline(always)]
fn place_along_body(
    chunks: &[usize],
    place: &Field,
    share: f64,
    direction: &Field,
    moved: &mut Field,
) {
    for axis in 0..3 {
        for &start in chunks {
            let [from, along] = [lanes(&place[axis], start), lanes(&direction[axis], start)];
            let to = lanes_mut(&mut moved[axis], start);
            for n in 0..CHUNK {
                to[n] = from[n] + share * along[n];
            }
        }
    }
}

simd_dispatch! {
    /// Decrease of the forces along the direction, and its component along the direction.
    fn look(mobility: &Field, force: &Field, problem: &mut Conjugate, along: &mut f64)
        = [avx512, avx2] look_body
}

#[inline(always)]
fn look_body(mobility: &Field, force: &Field, problem: &mut Conjugate, along: &mut f64) {
    let mut sums: Lanes = [0.0; CHUNK];
    let scale = 1.0 / problem.scale;
    for axis in 0..3 {
        for &start in &problem.chunks {
            let [w, there] = [lanes(&mobility[axis], start), lanes(&force[axis], start)];
            let here = lanes(&problem.force[axis], start);
            let direction = lanes(&problem.direction[axis], start);
            let fall = lanes_mut(&mut problem.fall[axis], start);
            for n in 0..CHUNK {
                fall[n] = if w[n] > 0.0 {
                    scale * (here[n] - there[n])
                } else {
                    0.0
                };
                sums[n] += fall[n] * direction[n];
            }
        }
    }
    *along = sums.iter().sum();
}

simd_dispatch! {
    /// Goes so many directions on, and adds up what is left.
    fn descend(mobility: &Field, way: f64, problem: &mut Conjugate, sums: &mut Sums)
        = [avx512, avx2] descend_body
}

#[inline(always)]
fn descend_body(mobility: &Field, way: f64, problem: &mut Conjugate, sums: &mut Sums) {
    let mut lanewise: [Lanes; 2] = [[0.0; CHUNK]; 2];
    let mut longest: Lanes = [0.0; CHUNK];
    for axis in 0..3 {
        for &start in &problem.chunks {
            let w = lanes(&mobility[axis], start);
            let direction = lanes(&problem.direction[axis], start);
            let fall = lanes(&problem.fall[axis], start);
            let step = lanes_mut(&mut problem.step[axis], start);
            for n in 0..CHUNK {
                step[n] += way * direction[n];
                longest[n] = longest[n].max(step[n].abs());
            }
            let left = lanes_mut(&mut problem.left[axis], start);
            let response = lanes_mut(&mut problem.response[axis], start);
            for n in 0..CHUNK {
                left[n] = if w[n] > 0.0 {
                    left[n] - way * fall[n]
                } else {
                    0.0
                };
                response[n] = w[n] * left[n];
                lanewise[0][n] += response[n] * left[n];
                lanewise[1][n] += left[n] * left[n];
            }
        }
    }
    let [weight, left] = lanewise.map(|lanes| lanes.iter().sum());
    let longest = longest.into_iter().fold(0.0, f64::max);
    *sums = Sums {
        weight,
        left,
        longest,
    };
}

simd_dispatch! {
    /// The next direction: the response, and a share of the one before.
    fn turn(share: f64, problem: &mut Conjugate) = [avx512, avx2] turn_body
}

#[inline(always)]
fn turn_body(share: f64, problem: &mut Conjugate) {
    for axis in 0..3 {
        for &start in &problem.chunks {
            let response = lanes(&problem.response[axis], start);
            let direction = lanes_mut(&mut problem.direction[axis], start);
            for n in 0..CHUNK {
                direction[n] = response[n] + share * direction[n];
            }
        }
    }
}

simd_dispatch! {
    /// The sum of all products.
    fn dot(chunks: &[usize], first: &Field, second: &Field, sum: &mut f64) = [avx512, avx2] dot_body
}

#[inline(always)]
fn dot_body(chunks: &[usize], first: &Field, second: &Field, sum: &mut f64) {
    let mut sums: Lanes = [0.0; CHUNK];
    for axis in 0..3 {
        for &start in chunks {
            let [a, b] = [lanes(&first[axis], start), lanes(&second[axis], start)];
            for n in 0..CHUNK {
                sums[n] += a[n] * b[n];
            }
        }
    }
    *sum = sums.iter().sum();
}
