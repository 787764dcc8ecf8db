//! The fraction of the sky that reaches a cell past what stands around it. Half of all directions are behind any flat
//! surface, so half is all that there is.

use std::ops::Range;

use glam::Vec3;
use palpate_volume::simd_dispatch;

use crate::light_volume::cells::CellGrid;
use crate::light_volume::clarity::{Beside, Clarity, Scratch};

/// How far what stands around takes of the sky [mm].
const REACH: f32 = 40.0;

const DIRECTIONS: usize = 16;

/// Growth of steps with the distance.
const GROWTH: f32 = 1.4;

/// Steps so short, in all they count, that they are left out [cells].
const NOTHING: f32 = 1e-3;

/// Where the light of the sky is looked at beside a cell.
pub(super) struct Sky {
    directions: Vec<Vec<Step>>,
}

/// A part of the way to the sky.
struct Step {
    /// Its middle, from the cell's [cells].
    offset: Vec3,
    /// Its length: what is farther away counts for a longer part of the way, and less.
    length: Power,
}

impl Sky {
    pub fn new(grid: &CellGrid) -> Self {
        let directions = (0..DIRECTIONS)
            .map(|i| steps_along(direction(i) * grid.cells_per_edge(), REACH / grid.edge))
            .collect();
        Self { directions }
    }
}

/// How far a cell's sky reaches [cells].
pub(super) fn reach(grid: &CellGrid) -> Vec3 {
    grid.cells_per_edge() * REACH / grid.edge
}

/// Evenly over the sphere (Fibonacci lattice).
fn direction(i: usize) -> Vec3 {
    let z = 1.0 - (2.0 * i as f32 + 1.0) / DIRECTIONS as f32;
    let (sin, cos) = (2.399_963_2 * i as f32).sin_cos();
    let radius = (1.0 - z * z).sqrt();
    Vec3::new(radius * cos, radius * sin, z)
}

/// `direction`: the way of a cell's edge along each axis; `reach` in cells' edges.
fn steps_along(direction: Vec3, reach: f32) -> Vec<Step> {
    let mut steps = Vec::new();
    let (mut from, mut size) = (0.5, 1.0);
    while from < reach {
        let away = from + 0.5 * size;
        let length = size * (1.0 - away / reach).max(0.0);
        if length > NOTHING {
            steps.push(Step {
                offset: direction * away,
                length: Power::new(length),
            });
        }
        from += size;
        size *= GROWTH;
    }
    steps
}

simd_dispatch! {
    /// Fractions of the sky that reach some cells of a row.
    pub(super) fn reach_row(
        sky: &Sky,
        clarity: &Clarity,
        row: (i32, i32),
        span: &Range<usize>,
        scratch: &mut Scratch,
    ) = [avx2] reach_row_body
}

#[inline(always)]
fn reach_row_body(
    sky: &Sky,
    clarity: &Clarity,
    row: (i32, i32),
    span: &Range<usize>,
    scratch: &mut Scratch,
) {
    scratch.sum[span.clone()].fill(0.0);
    for steps in &sky.directions {
        scratch.clear[span.clone()].fill(1.0);
        for step in steps {
            match clarity.beside(row, step.offset, span, scratch) {
                Beside::Outside => break,
                Beside::All => {}
                Beside::Some(cells) => {
                    step.length.dim(&mut scratch.clear[cells], &scratch.passing);
                }
            }
        }
        let clear = &scratch.clear[span.clone()];
        let sum = &mut scratch.sum[span.clone()];
        for i in 0..sum.len() {
            sum[i] += clear[i];
        }
    }
    for share in &mut scratch.sum[span.clone()] {
        *share = (*share * (2.0 / DIRECTIONS as f32)).min(1.0);
    }
}

/// Takes from light what does not pass.
#[inline(always)]
pub(super) fn dim(light: &mut [f32], passing: &[f32]) {
    let passing = &passing[..light.len()];
    for i in 0..light.len() {
        light[i] *= passing[i];
    }
}

/// Powers of fractions with one exponent, to 1/200: a cubic for one from 1 to 2, then squares or roots.
struct Power {
    coefficients: [f32; 3],
    squares: u32,
    roots: u32,
}

impl Power {
    fn new(exponent: f32) -> Self {
        let doublings = exponent.log2().floor();
        Self {
            coefficients: cubic(exponent / doublings.exp2()),
            squares: doublings.max(0.0) as u32,
            roots: (-doublings).max(0.0) as u32,
        }
    }

    /// Takes from light what does not pass, over this length of the way.
    #[inline(always)]
    fn dim(&self, light: &mut [f32], passing: &[f32]) {
        // the usual lengths have loops without loops in them
        match (self.roots, self.squares) {
            (0, 0) => self.dim_by::<0, 0>(light, passing),
            (1, 0) => self.dim_by::<1, 0>(light, passing),
            (0, 1) => self.dim_by::<0, 1>(light, passing),
            (0, 2) => self.dim_by::<0, 2>(light, passing),
            (roots, squares) => {
                for (light, &share) in light.iter_mut().zip(passing) {
                    *light *= self.of(share, roots, squares);
                }
            }
        }
    }

    #[inline(always)]
    fn dim_by<const ROOTS: u32, const SQUARES: u32>(&self, light: &mut [f32], passing: &[f32]) {
        let passing = &passing[..light.len()];
        for i in 0..light.len() {
            light[i] *= self.of(passing[i], ROOTS, SQUARES);
        }
    }

    #[inline(always)]
    fn of(&self, share: f32, roots: u32, squares: u32) -> f32 {
        let [a, b, c] = self.coefficients;
        let x = (0..roots).fold(share, |x, _| x.sqrt());
        let power = x * (a + x * (b + x * c));
        (0..squares).fold(power, |x, _| x * x)
    }
}

/// Coefficients of x, x² and x³ that give powers of 0.2, 0.6 and 1.
fn cubic(exponent: f32) -> [f32; 3] {
    let places = [0.2_f32, 0.6, 1.0];
    let matrix = glam::Mat3::from_cols(
        Vec3::from(places),
        Vec3::from(places.map(|x| x * x)),
        Vec3::from(places.map(|x| x * x * x)),
    );
    let powers = Vec3::from(places.map(|x| x.powf(exponent)));
    (matrix.inverse() * powers).to_array()
}

#[cfg(test)]
mod tests {
    use super::Power;

    #[test]
    fn powers_are_right_to_a_half_percent_of_all_light() {
        for exponent in [0.05, 0.3, 0.95, 1.0, 1.24, 1.9, 2.0, 3.7, 9.0] {
            let power = Power::new(exponent);
            let places: Vec<f32> = (0..=1000).map(|i| i as f32 / 1000.0).collect();
            let mut powers = vec![1.0; places.len()];
            power.dim(&mut powers, &places);
            // squares double errors
            let allowed = 0.005 * f32::max(1.0, exponent / 2.0);
            for (place, found) in places.iter().zip(powers) {
                let error = (found - place.powf(exponent)).abs();
                assert!(error < allowed, "{place} to {exponent} is off by {error}");
            }
        }
    }
}
