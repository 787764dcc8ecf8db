//! What the field of a level is to be: how stiff it is, and where it is zero.
//!
//! Both follow from the field as it is: its normals, and how it bends.

use glam::{IVec3, Vec3};

use super::band::NONE;
use super::cell_of;
use super::faces::Face;
use super::level::{Level, corners, weight_of};
use crate::bits::Bits;

/// Length over which a surface at 45° is smoothed [longest voxel sides].
const SMOOTHED: f32 = 8.0;
/// Radius of curvature above which a surface is taken as flat [longest voxel sides].
const FLAT_RADIUS: f32 = 450.0;
/// Least sine of an angle between face and surface; below it the edges of terraces give no
/// information.
const EPSILON: f32 = 0.2;
/// Least weight of a face of a flat terrace, relative to a face at 45°.
const TERRACE: f32 = 0.05;
/// The same least weight where the surface bends, times a voxel's side over the radius of
/// curvature.
const BENT_TERRACE: f32 = 0.3;
/// A normal that points farther away from a face's solid side is not used (cosine).
const AGAINST: f32 = -0.3;
/// Least length of the gradient for a normal to be known.
const RISING: f32 = 0.2;
/// Weight of being on the wrong side, relative to being off a face.
const WRONG_SIDE: f32 = 1.0;
/// Weight of being off a fraction that is known, relative to the same.
const KNOWN: f32 = 100.0;
/// What being off a flat face costs: more than stiffness, so that it ends with its last voxel.
const FLAT: f32 = 1e4;
/// One over the mean square of a way that is anywhere in 0 to 1, from its middle.
const ANYWHERE: f32 = 12.0;
/// Cells that the band is thick.
const THICKNESS: f32 = 4.0;

/// Terms of a level, by the number of a cell.
#[derive(Debug)]
pub(super) struct Terms {
    /// What bending costs along each axis.
    pub(super) stiffness: Vec<[f32; 3]>,
    /// Curvature of the field [1/mm].
    bends: Vec<f32>,
    /// Gradient of the field.
    gradients: Vec<Vec3>,
}

impl Terms {
    /// Those of a field as it is; where it is not known yet how it bends, it is stiff.
    pub(super) fn of(level: &Level, is_bent: bool) -> Self {
        let count = level.band.cells.len();
        let [spacing, side] = [level.spacing, level.side];
        let longest = spacing.max_element();
        let area = spacing.element_product() * longest;
        let volume = side.element_product();
        let cost =
            ANYWHERE * (SMOOTHED * longest).powi(4) / area * volume / (THICKNESS * volume.cbrt());
        let flat = FLAT_RADIUS * longest;
        let mut terms = Self {
            stiffness: Vec::with_capacity(count),
            bends: Vec::with_capacity(count),
            gradients: (0..count).map(|number| gradient(level, number)).collect(),
        };
        for number in 0..count {
            let bend = |axis| {
                if is_bent {
                    bend(level, number, axis)
                } else {
                    0.0
                }
            };
            let bends: [f32; 3] = std::array::from_fn(bend);
            let stiffness = |axis: usize| {
                let relative: f32 = bends[axis] * flat;
                cost / (side[axis].powi(4) * (1.0 + relative * relative))
            };
            terms.stiffness.push(std::array::from_fn(stiffness));
            let all = bends.into_iter().map(f32::abs).sum();
            terms.bends.push(if is_bent { all } else { 1.0 });
        }
        terms
    }

    /// Weights and targets: where faces, and fractions that are known, want the field to be zero.
    pub(super) fn data(&self, level: &Level) -> (Vec<f32>, Vec<f32>) {
        let count = level.band.cells.len();
        let (mut weights, mut sums) = (vec![0.0; count], vec![0.0; count]);
        let mut add = |cell: IVec3, target: f32, weight: f32| {
            let number = level.band.number(cell);
            if number != NONE {
                weights[number as usize] += weight;
                sums[number as usize] += weight * target;
            }
        };
        let flat = level.flat.iter().copied().chain(std::iter::repeat(false));
        for (face, is_flat) in level.faces.iter().zip(flat) {
            let (normal, weight) = match is_flat {
                true => (
                    (face.solid - face.free).as_vec3(),
                    FLAT * usual_cost(level.spacing),
                ),
                false => self.of_face(level, face),
            };
            let toward = level.spacing[face.axis] * normal[face.axis].abs();
            if level.factor.element_product() == 1 {
                add(face.solid, 0.5 * toward, 0.5 * weight);
                add(face.free, -0.5 * toward, 0.5 * weight);
                continue;
            }
            let middle = 0.5 * (face.solid + face.free + 1).as_vec3() * level.spacing;
            let place = middle / level.side - 0.5;
            let first = place.floor();
            for corner in corners() {
                let cell = first.as_ivec3() + corner;
                let at = (cell.as_vec3() + 0.5) * level.side;
                let part = weight_of(corner, place - first);
                add(cell, normal.dot(at - middle), weight * part);
            }
        }
        for (sum, weight) in sums.iter_mut().zip(&weights) {
            *sum = if *weight > 0.0 { *sum / weight } else { 0.0 };
        }
        self.hold(level, &mut weights, &mut sums);
        (weights, sums)
    }

    /// The normal at a face, into the solid side, and how much the face tells.
    fn of_face(&self, level: &Level, face: &Face) -> (Vec3, f32) {
        let inward = (face.solid - face.free).as_vec3();
        let [solid, free] = [face.solid, face.free]
            .map(|voxel| level.band.number(cell_of(voxel, level.factor)) as usize);
        let gradient = 0.5 * (self.gradients[solid] + self.gradients[free]);
        let rise = gradient.length();
        let along = gradient.dot(inward);
        let normal = if rise > RISING && along > AGAINST * rise {
            // a face that looks a little the wrong way tells as one along the surface
            gradient / rise - inward * (along / rise).min(0.0)
        } else {
            inward
        };
        let cosine = normal.dot(inward);
        let side = level.spacing[face.axis];
        // how far off the surface the middle between both voxels may be
        let width = side * side * (cosine * cosine + EPSILON * EPSILON);
        // all faces of a flat terrace tell the same
        let bent = BENT_TERRACE * side * self.bends[solid];
        let told = (1.0 - cosine * cosine).max(TERRACE.max(bent).min(1.0));
        (normal, ANYWHERE / width * told)
    }

    /// Puts fractions that are known in the place of what faces tell.
    fn hold(&self, level: &Level, weights: &mut [f32], targets: &mut [f32]) {
        let cost = KNOWN * usual_cost(level.spacing);
        for &(number, fraction) in &level.held {
            let Some(gradient) = self.gradients[number].try_normalize() else {
                continue;
            };
            let steps = (gradient * level.spacing).abs();
            weights[number] = cost;
            targets[number] = (2.0 * fraction - 1.0) * steps.max_element();
        }
    }

    /// Pulls back what is on the wrong side of the surface.
    pub(super) fn keep_sides(
        &self,
        level: &Level,
        bits: &Bits,
        weights: &mut [f32],
        targets: &mut [f32],
    ) {
        let cost = WRONG_SIDE * usual_cost(level.spacing);
        for (number, &cell) in level.band.cells.iter().enumerate() {
            let is_wrong = bits.is_solid(cell) != (level.field[number] >= 0.0);
            if is_wrong && weights[number] > 0.0 {
                let weight = weights[number] + cost;
                targets[number] *= weights[number] / weight;
                weights[number] = weight;
            }
        }
    }
}

/// What being off a face costs that tells all it can.
fn usual_cost(spacing: Vec3) -> f32 {
    ANYWHERE / (spacing.max_element() * spacing.min_element())
}

/// Gradient of the field at a cell.
fn gradient(level: &Level, number: usize) -> Vec3 {
    let here = level.field[number];
    let beside = level.band.neighbours[number];
    let value = |number: u32| level.field.get(number as usize).copied();
    Vec3::from_array(std::array::from_fn(|axis| {
        let [before, after] = [value(beside[2 * axis]), value(beside[2 * axis + 1])];
        let rise = match (before, after) {
            (Some(before), Some(after)) => 0.5 * (after - before),
            (Some(before), None) => here - before,
            (None, Some(after)) => after - here,
            (None, None) => 0.0,
        };
        rise / level.side[axis]
    }))
}

/// Second derivative of the field along an axis at a cell and beside it [1/mm].
fn bend(level: &Level, number: usize, axis: usize) -> f32 {
    let [before, after] = beside(level, number, axis);
    if before == NONE || after == NONE {
        return 0.0;
    }
    let mut sum = 0.0;
    let mut total = 0.0;
    for (number, weight) in [(before, 1.0), (number as u32, 2.0), (after, 1.0)] {
        let number = number as usize;
        let [before, after] = beside(level, number, axis);
        if before != NONE && after != NONE {
            let [before, after] = [before, after].map(|number| level.field[number as usize]);
            sum += weight * (before + after - 2.0 * level.field[number]);
            total += weight;
        }
    }
    sum / (total * level.side[axis] * level.side[axis])
}

fn beside(level: &Level, number: usize, axis: usize) -> [u32; 2] {
    let all = level.band.neighbours[number];
    [all[2 * axis], all[2 * axis + 1]]
}
