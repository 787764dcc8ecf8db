//! The field of least bending near given values: a linear system, solved by conjugate gradients.
//!
//! Σ over cells and axes of c (φ₋ − 2 φ + φ₊)² + Σ over cells of w (φ − t)² is least where
//! (B + W) φ = W t; the preconditioner is its diagonal (Shewchuk 1994).

use super::band::NONE;

/// What is to be solved; all lists are by the number of a cell.
#[derive(Debug)]
pub(super) struct System<'a> {
    /// Numbers of the cells before and after each along x, y and z.
    pub(super) neighbours: &'a [[u32; 6]],
    /// What bending costs along each axis.
    pub(super) stiffness: &'a [[f32; 3]],
    /// What being off the target costs.
    pub(super) weights: &'a [f32],
    /// The values wanted.
    pub(super) targets: &'a [f32],
}

impl System<'_> {
    /// Improves a field by some iterations.
    pub(super) fn improve(&self, field: &mut [f32], iterations: usize) {
        let inverse = self.inverse_diagonal();
        let mut product = vec![0.0; field.len()];
        self.apply(field, &mut product);
        let wanted = self.weights.iter().zip(self.targets).map(|(w, t)| w * t);
        let mut rest: Vec<f32> = wanted.zip(&product).map(|(w, p)| w - p).collect();
        let mut way: Vec<f32> = rest.iter().zip(&inverse).map(|(r, i)| r * i).collect();
        let mut error = dot(&rest, &way);
        let enough = error * 1e-12;
        for _ in 0..iterations {
            self.apply(&way, &mut product);
            let curvature = dot(&way, &product);
            if error <= enough || curvature <= 0.0 {
                return;
            }
            let step = (error / curvature) as f32;
            let mut next = 0.0;
            for k in 0..field.len() {
                field[k] += step * way[k];
                rest[k] -= step * product[k];
                next += f64::from(rest[k] * rest[k] * inverse[k]);
            }
            let turn = (next / error) as f32;
            for ((way, rest), inverse) in way.iter_mut().zip(&rest).zip(&inverse) {
                *way = rest * inverse + turn * *way;
            }
            error = next;
        }
    }

    /// (B + W) times a field.
    fn apply(&self, field: &[f32], product: &mut [f32]) {
        for ((product, field), weight) in product.iter_mut().zip(field).zip(self.weights) {
            *product = weight * field;
        }
        self.visit_bends(|before, here, after, stiffness| {
            let bend = stiffness * (field[before] + field[after] - 2.0 * field[here]);
            product[before] += bend;
            product[after] += bend;
            product[here] -= 2.0 * bend;
        });
    }

    fn inverse_diagonal(&self) -> Vec<f32> {
        let mut diagonal = self.weights.to_vec();
        self.visit_bends(|before, here, after, stiffness| {
            diagonal[before] += stiffness;
            diagonal[after] += stiffness;
            diagonal[here] += 4.0 * stiffness;
        });
        // a cell that nothing holds stays as it is
        let inverse = |d: f32| if d > 0.0 { d.recip() } else { 0.0 };
        diagonal.into_iter().map(inverse).collect()
    }

    /// Tells three cells in a row, and what bending costs there.
    #[inline]
    fn visit_bends(&self, mut tell: impl FnMut(usize, usize, usize, f32)) {
        for (here, (beside, stiffness)) in self.neighbours.iter().zip(self.stiffness).enumerate() {
            for (pair, &stiffness) in beside.as_chunks::<2>().0.iter().zip(stiffness) {
                let &[before, after] = pair;
                if before != NONE && after != NONE {
                    tell(before as usize, here, after as usize, stiffness);
                }
            }
        }
    }
}

fn dot(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from(a * b)).sum()
}
