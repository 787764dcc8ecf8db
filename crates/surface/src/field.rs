//! Smoothing: a field that is positive where solid, blurred, and its zero between two samples.
//!
//! Degree d blurs d times by a small kernel along each axis. A blur pulls curved surfaces inward;
//! one more blur tells by how much, and that is undone: w = (1 + b) Bᵈu - b Bᵈ⁺¹u with b chosen so
//! that flat and round surfaces stay where they are; only what is about as short as a voxel goes. A vertex thus depends on d + 1 samples around its edge, its normal on
//! one more: (d + 2) · step voxels, by which the thesis extends its patches (5.2.2).
//!
//! The blur has the same width [mm] along each axis: thick slices are blurred little across.
//! A thin wall has no place where the blurred field would be positive. So a vertex keeps away
//! from the far side of what is thin: walls, gaps and lone voxels keep their thickness.
//! With limits, a sample begins as how far it is inside of them, in cells, between -1 and 1: where a
//! limit is passed is known between samples, and unequal contrasts on both sides do not move it.
//! Source of undoing the blur: van Cittert (1931), first order.

use glam::{DVec3, IVec3};
use palpate_volume::voxel_box::VoxelBox;

use crate::frame::Frame;
use crate::place::{Placed, Placement};
use crate::samples::Samples;
use crate::settings::MAX_SMOOTHING;

/// What a blur moves to each side along the axis of the smallest spacing.
const SPREAD: f32 = 0.25;

/// Mean depth of the triangles under a ball of radius 1 on which their vertices lie [cells²],
/// measured on balls of 5 and 20 cells.
const CHORD: f32 = 0.15;

/// Variance of a ramp from one voxel inside to one voxel outside of a surface [cells²].
const RAMP: f32 = 1.0 / 3.0;

/// How near a vertex comes to the middle of a sample [edge], where that end is one, two or more
/// samples thick along the edge. A wall of one stays 0.8 thick, one of two 1.6.
const NEAREST: [f64; 3] = [0.4, 0.3, 0.02];

/// Kernels for the blur of a grid.
#[derive(Clone, Debug)]
pub(crate) struct Blur {
    degree: usize,
    /// One blur along each axis.
    once: [Vec<f32>; 3],
    /// Kernel of all blurs together, along each axis.
    all: [Vec<f32>; 3],
}

impl Blur {
    pub(crate) fn new(spacing: DVec3, degree: u8) -> Self {
        debug_assert!(degree <= MAX_SMOOTHING);
        let smallest = spacing.min_element();
        let once = spacing.to_array().map(|along| {
            // variances add up, so equal widths in mm are equal variances in mm²
            let side = SPREAD * ((smallest / along) as f32).powi(2);
            vec![side, 1.0 - 2.0 * side, side]
        });
        let all = once
            .clone()
            .map(|once| (0..degree).fold(vec![1.0], |kernel, _| convolved(&kernel, &once)));
        Self {
            degree: usize::from(degree),
            once,
            all,
        }
    }

    /// How much of the difference that one more blur makes is taken back, where the field jumps at
    /// the surface.
    ///
    /// At the surface of a ball of radius r it goes down by a share of the blur's width over r:
    /// (1 + b) √d - b √(d + 1) would be zero. It is made so much less than zero that vertices stand
    /// out by CHORD / r, as triangles lie inside of a ball by their chords.
    fn undone_of_bits(&self) -> f32 {
        let [width, wider] = self.variances().map(f32::sqrt);
        (width + CHORD * (width + wider) / (width * wider)) / (wider - width)
    }

    /// The same where the field rises across the surface by RAMP.
    ///
    /// Such a ramp is a jump that is blurred already, without having moved. So it falls less: by
    /// v / √(v + RAMP), where v is the variance of the blur.
    fn undone_of_depths(&self) -> f32 {
        let [fall, more] = self.variances().map(|v| (v + CHORD) / (v + RAMP).sqrt());
        fall / (more - fall)
    }

    /// Variances of all blurs, and of one more [cells²].
    fn variances(&self) -> [f32; 2] {
        [self.degree, self.degree + 1].map(|degree| 2.0 * SPREAD * degree as f32)
    }

    /// Samples that the field must have beyond those where it is wanted, for a gradient too.
    pub(crate) fn margin(&self) -> i32 {
        if self.degree == 0 {
            1
        } else {
            self.degree as i32 + 2
        }
    }
}

/// Product of two kernels.
fn convolved(a: &[f32], b: &[f32]) -> Vec<f32> {
    let mut product = vec![0.0; a.len() + b.len() - 1];
    for (i, a) in a.iter().enumerate() {
        for (j, b) in b.iter().enumerate() {
            product[i + j] += a * b;
        }
    }
    product
}

/// Values of a box of samples, x fastest.
#[derive(Clone, Debug, Default)]
pub(crate) struct Field {
    bounds: VoxelBox,
    values: Vec<f32>,
}

/// What a thread keeps between patches.
#[derive(Debug, Default)]
pub(crate) struct FieldScratch {
    fields: [Field; 2],
    depths: Field,
}

/// What a field begins with.
pub(crate) enum Beginning<'a> {
    /// The bits alone.
    Bits,
    /// The scan's values too: how far each of a row of samples is within the limits.
    Depths(&'a dyn Fn(IVec3, &mut [f32])),
}

impl Field {
    /// Asks for the values of each row along x, by its first sample.
    fn fill(&mut self, bounds: VoxelBox, values_of: impl Fn(IVec3, &mut [f32])) {
        self.bounds = bounds;
        let size = bounds.size().as_usizevec3();
        self.values.clear();
        self.values.resize(size.x * size.y * size.z, 0.0);
        let mut rows = self.values.chunks_exact_mut(size.x);
        for z in bounds.min.z..bounds.max.z {
            for y in bounds.min.y..bounds.max.y {
                let row = rows.next().expect("a row for each y and z");
                values_of(IVec3::new(bounds.min.x, y, z), row);
            }
        }
    }

    /// How far the samples of a row are inside of the surface, in cells, from depths in the units
    /// of the scan; with the sign of their bits, and no more than 1.
    ///
    /// A plane at distance d changes the depth by its slope along each axis: d is the depth over
    /// the sum of the slopes. Where a bit is not what the depth says, an edit made it so, and the
    /// sample counts as those far inside or outside do: so edits look as their bits. It is how
    /// touch counts shares of voxels (`palpate-haptics`, `smooth/occupancy_fractions.rs`).
    fn distances(&self, bits: &Samples, first: IVec3, distances: &mut [f32]) {
        let (start, [_, y, z]) = (self.index(first), self.strides());
        let row =
            |shift: isize| &self.values[start.wrapping_add_signed(shift)..][..distances.len()];
        let (y, z) = (y as isize, z as isize);
        let beside = [row(-1), row(1), row(-y), row(y), row(-z), row(z)];
        let here = row(0);
        bits.halves(first, distances);
        for (x, distance) in distances.iter_mut().enumerate() {
            let rise = |axis: usize| (beside[2 * axis + 1][x] - beside[2 * axis][x]).abs();
            let slope = 0.5 * (rise(0) + rise(1) + rise(2));
            let sign = 2.0 * *distance;
            let inside = sign * here[x] / slope;
            // also where there is no slope
            let agrees = sign * here[x] >= 0.0 && inside < 1.0;
            *distance = if agrees { sign * inside } else { sign };
        }
    }

    /// Blurs along an axis; the box loses what the kernel reaches over.
    fn convolve(&self, axis: usize, kernel: &[f32], into: &mut Self) {
        let mut reach = IVec3::ZERO;
        reach[axis] = kernel.len() as i32 / 2;
        into.bounds = VoxelBox::new(self.bounds.min + reach, self.bounds.max - reach);
        let size = into.bounds.size().as_ivec3();
        into.values.clear();
        into.values.resize((size.x * size.y * size.z) as usize, 0.0);

        let stride = self.strides()[axis];
        let width = size.x as usize;
        for z in 0..size.z {
            for y in 0..size.y {
                let row = (z * size.y + y) as usize * width;
                let first = self.index(into.bounds.min - reach + IVec3::new(0, y, z));
                let sums = &mut into.values[row..row + width];
                weigh(&self.values[first..], stride, kernel, sums);
            }
        }
    }

    fn strides(&self) -> [usize; 3] {
        let size = self.bounds.size();
        [1, size.x as usize, (size.x * size.y) as usize]
    }

    #[inline]
    fn index(&self, sample: IVec3) -> usize {
        let (local, size) = (sample - self.bounds.min, self.bounds.size());
        (local.z as usize * size.y as usize + local.y as usize) * size.x as usize + local.x as usize
    }
}

/// Sums of values `stride` apart, weighed by a kernel, for each place from the first on.
fn weigh(values: &[f32], stride: usize, kernel: &[f32], sums: &mut [f32]) {
    // so many sums stay in registers while the kernel passes
    const LANES: usize = 8;
    let whole = sums.len() - sums.len() % LANES;
    let (blocks, rest) = sums.split_at_mut(whole);
    for (block, sums) in blocks.chunks_exact_mut(LANES).enumerate() {
        let mut held = [0.0; LANES];
        for (tap, &weight) in kernel.iter().enumerate() {
            let start = block * LANES + tap * stride;
            for (sum, value) in held.iter_mut().zip(&values[start..start + LANES]) {
                *sum += weight * value;
            }
        }
        sums.copy_from_slice(&held);
    }
    for (place, sum) in rest.iter_mut().enumerate() {
        let taps = kernel.iter().enumerate();
        *sum = taps.fold(0.0, |sum, (tap, weight)| {
            sum + weight * values[whole + place + tap * stride]
        });
    }
}

impl FieldScratch {
    /// The smoothed field on the samples of a box and one more on each side.
    pub(crate) fn smooth(
        &mut self,
        blur: &Blur,
        bits: &Samples,
        samples: VoxelBox,
        beginning: &Beginning<'_>,
    ) -> &Field {
        let [field, other] = &mut self.fields;
        let all = samples.dilate(blur.margin());
        match beginning {
            Beginning::Bits => field.fill(all, |first, values| bits.halves(first, values)),
            Beginning::Depths(depths) => {
                self.depths.fill(all.dilate(1), depths);
                field.fill(all, |first, values| {
                    self.depths.distances(bits, first, values)
                });
            }
        }
        if blur.degree == 0 {
            return field;
        }
        field.convolve(0, &blur.all[0], other);
        other.convolve(1, &blur.all[1], field);
        field.convolve(2, &blur.all[2], other);
        let blurred = std::mem::take(other);
        blurred.convolve(0, &blur.once[0], other);
        other.convolve(1, &blur.once[1], field);
        field.convolve(2, &blur.once[2], other);

        let undone = match beginning {
            Beginning::Bits => blur.undone_of_bits(),
            Beginning::Depths(_) => blur.undone_of_depths(),
        };
        for z in other.bounds.min.z..other.bounds.max.z {
            for y in other.bounds.min.y..other.bounds.max.y {
                let first = IVec3::new(other.bounds.min.x, y, z);
                let (row, once) = (other.index(first), blurred.index(first));
                let width = other.bounds.size().x as usize;
                let once = &blurred.values[once..once + width];
                for (value, once) in other.values[row..row + width].iter_mut().zip(once) {
                    *value = (1.0 + undone) * once - undone * *value;
                }
            }
        }
        // its room serves the next patch
        *field = blurred;
        other
    }
}

/// Vertices where the field is zero.
pub(crate) struct Zeros<'a> {
    pub(crate) field: &'a Field,
    pub(crate) frame: &'a Frame,
    /// Whether thin walls and gaps need their thickness kept.
    pub(crate) keep_thin: bool,
}

impl Placement for Zeros<'_> {
    #[inline]
    fn place(&self, samples: &Samples, axis: usize, sample: IVec3) -> Placed {
        let strides = self.field.strides();
        let [first, second] = [0, strides[axis]].map(|step| self.field.index(sample) + step);
        let values = &self.field.values;
        let (low, high) = self.limits(samples, axis, sample);
        let share = zero_between(samples, sample, [values[first], values[second]]);
        let share = share.clamp(low, high);

        let mut gradient = DVec3::ZERO;
        for (along, stride) in strides.into_iter().enumerate() {
            let difference = |at: usize| f64::from(values[at + stride] - values[at - stride]);
            gradient[along] = difference(first) * (1.0 - share) + difference(second) * share;
        }
        let normal = self.frame.normal(gradient);
        let normal = normal.or_else(|| {
            let mut along = DVec3::ZERO;
            along[axis] = if samples.is_solid(sample) { -1.0 } else { 1.0 };
            self.frame.normal(along)
        });
        Placed {
            share,
            normal: normal.expect("an axis of a grid is no zero vector"),
        }
    }
}

impl Zeros<'_> {
    /// Between which shares of its edge a vertex may stand.
    #[inline]
    fn limits(&self, samples: &Samples, axis: usize, sample: IVec3) -> (f64, f64) {
        let [.., nearest] = NEAREST;
        if !self.keep_thin {
            return (nearest, 1.0 - nearest);
        }
        let mut step = IVec3::ZERO;
        step[axis] = 1;
        let first = samples.is_solid(sample);
        let thickness = |from: IVec3, step: IVec3, kind: bool| {
            let more = |n: i32| samples.is_solid(from + step * n) == kind;
            NEAREST[if !more(1) {
                0
            } else {
                usize::from(more(2)) + 1
            }]
        };
        let low = thickness(sample, -step, first);
        let high = 1.0 - thickness(sample + step, step, !first);
        (low, high)
    }
}

/// Share of the way at which values turn their sign, also where they do not do as the bits say.
#[inline]
fn zero_between(samples: &Samples, sample: IVec3, values: [f32; 2]) -> f64 {
    // the first as the bits have it positive
    let sign = if samples.is_solid(sample) { 1.0 } else { -1.0 };
    let [inner, outer] = values.map(|value| sign * f64::from(value));
    match (inner > 0.0, outer < 0.0) {
        (true, true) => inner / (inner - outer),
        (false, true) => 0.0,
        (true, false) => 1.0,
        (false, false) => 0.5,
    }
}
