//! The border of the box: what stands for the body behind it.
//!
//! Far from a force, displacement falls with 1/r and stress with 1/r², whatever the shape of the
//! contact. So at a border node the body behind is a spring: the ratio of stress to displacement
//! of a point force in the middle of the contact. That ratio is taken from a force in an
//! unbounded body (Kelvin); under a free surface (Boussinesq) it differs by some percent.
//! Source: A. E. H. Love, A Treatise on the Mathematical Theory of Elasticity (1927), §130.

use glam::{DMat3, DVec3};

use super::nodes::Lattice;
use super::vectors::{Field, vector_at};
use crate::material::Solid;

/// What the border of a box does where tissue goes on behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Border {
    /// Nothing: the body ends there.
    Free,
    /// It does not move.
    Held,
    /// It gives as an endless body would under a force at this place [mm, lattice's frame].
    Endless {
        /// The middle of the contact.
        load: DVec3,
    },
}

/// A spring between a border node and the body behind it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ground {
    /// The node.
    pub node: u32,
    /// Symmetric, not negative [N/mm].
    pub stiffness: DMat3,
    /// Displacement of the spring's other end [mm].
    pub led: DVec3,
}

/// How many times stiffer than its springs a border is, at most, where the body behind is stiffer than
/// an endless one.
const MOST_STIFFNESS: f64 = 4.0;
/// Rounds over all entries by which eigenvalues are found.
const SWEEPS: u32 = 8;

/// What the body behind the border does as one: all springs end at it, and it moves by
/// `free + compliance · force` under the force that they give on.
///
/// The displacement is eliminated (static condensation: Guyan, AIAA Journal 3, 1965), so that nodes
/// and body come to rest together; an exchange of force and displacement between two models, one
/// after the other, would not where the body gives more than the nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// Symmetric [mm/N]; negative where the body is stiffer than an endless one.
    compliance: DMat3,
    /// Displacement without a force [mm].
    free: DVec3,
    /// (compliance⁻¹ + springs)⁻¹ [mm/N].
    by_pull: DMat3,
    /// Where it stands under no pull of the springs [mm].
    unpulled: DVec3,
}

impl Frame {
    /// The body behind the border stays where it is.
    pub const HELD: Self = Self {
        compliance: DMat3::ZERO,
        free: DVec3::ZERO,
        by_pull: DMat3::ZERO,
        unpulled: DVec3::ZERO,
    };

    fn new(ground: &[Ground], compliance: DMat3, free: DVec3) -> Self {
        let springs: DMat3 = ground.iter().map(|ground| ground.stiffness).sum();
        let stiffest = rows(springs, f64::abs);
        let allowed = not_stiffer(compliance, (MOST_STIFFNESS.recip() - 1.0) / stiffest);
        let eased = (DMat3::IDENTITY + allowed * springs).inverse();
        let by_pull = eased * allowed;
        let frame = Self {
            compliance,
            free,
            by_pull: (by_pull + by_pull.transpose()) * 0.5,
            unpulled: eased * free,
        };
        let is_known = frame.by_pull.is_finite() && frame.unpulled.is_finite();
        if is_known { frame } else { Self::HELD }
    }

    fn is_held(&self) -> bool {
        self.by_pull == DMat3::ZERO && self.unpulled == DVec3::ZERO
    }

    /// Under this pull of springs that end where nothing has moved [N].
    fn moved(&self, pull: DVec3) -> DVec3 {
        self.by_pull * pull + self.unpulled
    }
}

/// The largest sum of a row, with `size` of each entry.
fn rows(matrix: DMat3, size: impl Fn(f64) -> f64) -> f64 {
    let row = |row: usize| (0..3).map(|n| size(matrix.col(n)[row])).sum::<f64>();
    row(0).max(row(1)).max(row(2))
}

/// A symmetric compliance with the eigenvalues that are below `least` raised to it, the others as they are.
fn not_stiffer(compliance: DMat3, least: f64) -> DMat3 {
    let (values, vectors) = eigen(compliance);
    let raised = values.max(DVec3::splat(least)) - values;
    let along = |n: usize| outer(vectors.col(n), vectors.col(n)) * raised[n];
    compliance + along(0) + along(1) + along(2)
}

/// Eigenvalues of a symmetric matrix, and its eigenvectors of length 1 as columns (Jacobi; Golub & Van Loan, Matrix
/// Computations, 2013, 8.5.3).
fn eigen(matrix: DMat3) -> (DVec3, DMat3) {
    let (mut values, mut vectors) = (matrix, DMat3::IDENTITY);
    // it converges with the square of what is left: a few sweeps reach the last digit
    for _ in 0..SWEEPS {
        for [p, q] in [[0, 1], [0, 2], [1, 2]] {
            let apart = values.col(q)[p];
            if apart == 0.0 {
                continue;
            }
            let half = (values.col(q)[q] - values.col(p)[p]) / (2.0 * apart);
            let tangent = half.signum() / (half.abs() + half.hypot(1.0));
            let cosine = tangent.hypot(1.0).recip();
            let mut turn = DMat3::IDENTITY;
            (turn.col_mut(p)[p], turn.col_mut(q)[q]) = (cosine, cosine);
            (turn.col_mut(q)[p], turn.col_mut(p)[q]) = (tangent * cosine, -tangent * cosine);
            values = turn.transpose() * values * turn;
            vectors *= turn;
        }
    }
    let diagonal = DVec3::new(values.x_axis.x, values.y_axis.y, values.z_axis.z);
    (diagonal, vectors)
}

impl Lattice {
    /// Whether tissue goes on behind the border.
    pub(super) fn goes_on(&self) -> bool {
        !self.ground.is_empty()
    }

    /// Has the body behind the border give as one, besides as its springs do. See [`Frame`].
    pub(super) fn set_frame(&mut self, compliance: DMat3, free: DVec3) {
        self.frame = Frame::new(&self.ground, compliance, free);
    }

    /// The body behind the border is that behind another one, and has moved as far.
    pub(super) fn take_frame(&mut self, other: &Self) {
        self.set_frame(other.frame.compliance, other.frame.free);
    }

    /// The frame anew, where the springs are others.
    pub(super) fn settle_frame(&mut self) {
        self.set_frame(self.frame.compliance, self.frame.free);
    }

    /// How far the body behind the border stands where the nodes have moved so far [mm].
    pub(super) fn border_moved(&self, moved: &Field) -> DVec3 {
        let pull = |ground: &Ground| {
            ground.stiffness * (vector_at(moved, ground.node as usize) - ground.led)
        };
        match self.frame.is_held() {
            true => DVec3::ZERO,
            false => self.frame.moved(self.ground.iter().map(pull).sum()),
        }
    }

    /// Has the body behind the border rest where its nodes do: `lasting` [mm from where they were at
    /// first], one for each node.
    pub(super) fn rest_border_at(&mut self, plastic: &Field) {
        for ground in &mut self.ground {
            ground.led = vector_at(plastic, ground.node as usize);
        }
    }
}

/// Stress over displacement at a place on the border, with the sign of a spring [N/mm³]:
/// `from_load` [mm] leads there from the load, `outward` is the border's normal.
pub(super) fn spring_of_endless_body(solid: &Solid, from_load: DVec3, outward: DVec3) -> DMat3 {
    let (distance, nu) = (from_load.length(), solid.poisson);
    let radial = from_load / distance;
    let along = outer(radial, radial);
    let facing = radial.dot(outward);

    // stress on the border, and displacement, for each component of the force; the common
    // factor 1 / (8 π (1 - ν)) is left out of both
    let stress = ((DMat3::IDENTITY * facing + outer(radial, outward) - outer(outward, radial))
        * (1.0 - 2.0 * nu)
        + along * (3.0 * facing))
        * (1.0 / (distance * distance));
    let force_by_moved = ((DMat3::IDENTITY - along) * (1.0 / (3.0 - 4.0 * nu))
        + along * (1.0 / (4.0 - 4.0 * nu)))
        * (2.0 * solid.shear() * distance);

    // the part that is not symmetric would give or take energy on a way around
    let spring = stress * force_by_moved;
    (spring + spring.transpose()) * 0.5
}

/// The matrix a bᵀ.
pub(super) fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_too_stiff_is_made_less_so() {
        // turned, with eigenvalues of -29, -2 and 5
        let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, -2.0) / 3.0, 1.1);
        let of = |values: DVec3| turn * DMat3::from_diagonal(values) * turn.transpose();
        let near = |one: DMat3, other: DMat3| (one - other).to_cols_array().map(f64::abs);
        let worst = |one, other| near(one, other).into_iter().fold(0.0, f64::max);
        let found = not_stiffer(of(DVec3::new(-29.0, -2.0, 5.0)), -4.0);
        assert!(
            worst(found, of(DVec3::new(-4.0, -2.0, 5.0))) < 1e-12,
            "{found}"
        );
        let allowed = of(DVec3::new(-3.0, -2.0, 5.0));
        assert!(worst(not_stiffer(allowed, -4.0), allowed) < 1e-12);
        assert_eq!(not_stiffer(DMat3::ZERO, -1.0), DMat3::ZERO);
    }
}
