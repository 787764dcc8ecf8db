//! The scan along a row of places that lie on one line along x: value and gradient, blended from its rows of voxels
//! once for all of them, so that many places of it cost little.

use std::ops::Range;

use crate::field::Field;
use crate::lanes::{Floats, Gather, Ints, Vector};

/// Values and gradients beside the voxels of a line.
pub(super) struct Line {
    /// Mean of four rows at the line itself, and one voxel before and after along y and z; one more at the end.
    means: [Vec<f32>; 5],
    /// For each voxel the gradient in the scan's unit [per mm], and 0; one more at the end.
    gradients: Vec<[f32; 4]>,
    rows: [Vec<i16>; 4],
}

/// Two voxels and the fraction of the way from the first to the second; the outermost go on.
fn between(place: f32, size: i32) -> (i32, i32, f32) {
    let inside = (place - 0.5).clamp(0.0, (size - 1) as f32);
    let first = inside as i32;
    (first, (first + 1).min(size - 1), inside - first as f32)
}

impl Line {
    pub fn new(columns: usize) -> Self {
        Self {
            means: std::array::from_fn(|_| vec![0.0; columns + 1]),
            gradients: vec![[0.0; 4]; columns + 1],
            rows: std::array::from_fn(|_| vec![0; columns]),
        }
    }

    /// Reads some columns of the line at these places [grid] along y and z.
    #[inline(always)]
    pub fn read(
        &mut self,
        field: &Field,
        (y, z): (f32, f32),
        columns: &Range<usize>,
        with_gradient: bool,
    ) {
        self.blend(field, (y, z), columns, 0);
        let end = self.gradients.len() - 1;
        self.means[0][end] = self.means[0][end - 1];
        if !with_gradient {
            return;
        }
        for (i, place) in [(y - 1.0, z), (y + 1.0, z), (y, z - 1.0), (y, z + 1.0)]
            .into_iter()
            .enumerate()
        {
            self.blend(field, place, columns, i + 1);
        }
        let scale = field.gradient_scale();
        let [values, below, above, near, far] = self.means.each_ref().map(|it| &it[..]);
        for x in columns.clone() {
            let (before, after) = (x.saturating_sub(1), (x + 1).min(end - 1));
            self.gradients[x] = [
                (values[after] - values[before]) * scale.x,
                (above[x] - below[x]) * scale.y,
                (far[x] - near[x]) * scale.z,
                0.0,
            ];
        }
        self.gradients[end] = self.gradients[end - 1];
    }

    #[inline(always)]
    fn blend(&mut self, field: &Field, (y, z): (f32, f32), columns: &Range<usize>, number: usize) {
        let size = field.dimensions().as_ivec3();
        let (y0, y1, y) = between(y, size.y);
        let (z0, z1, z) = between(z, size.z);
        let [a, b, c, d] = &mut self.rows;
        let a = field.row(y0, z0, columns, a);
        let b = field.row(y1, z0, columns, b);
        let c = field.row(y0, z1, columns, c);
        let d = field.row(y1, z1, columns, d);
        let mean = &mut self.means[number][columns.clone()];
        let count = mean.len();
        let (a, b, c, d) = (&a[..count], &b[..count], &c[..count], &d[..count]);
        for x in 0..count {
            let near = f32::from(a[x]) + (f32::from(b[x]) - f32::from(a[x])) * y;
            let far = f32::from(c[x]) + (f32::from(d[x]) - f32::from(c[x])) * y;
            mean[x] = near + (far - near) * z;
        }
    }

    /// The voxels between which places along x lie [grid].
    #[inline(always)]
    pub fn at<L: Gather>(&self, x: L::Float) -> OnLine<'_, L> {
        let last = (self.gradients.len() - 2) as f32;
        let inside = (x - Floats::splat(0.5))
            .max(Floats::splat(0.0))
            .min(Floats::splat(last));
        let first = inside.truncated();
        OnLine {
            line: self,
            first,
            share: inside - first.to_float(),
        }
    }
}

/// Places on a line.
#[derive(Clone, Copy)]
pub(super) struct OnLine<'a, L: Gather> {
    line: &'a Line,
    /// The voxel before each, and the fraction of the way to the next.
    first: L::Int,
    share: L::Float,
}

impl<L: Gather> OnLine<'_, L> {
    #[inline(always)]
    pub fn value(self) -> L::Float {
        // SAFETY: the first was clamped to the voxels, of which there is one mean more
        let [low, high] = unsafe { L::neighbours(&self.line.means[0], self.first) };
        low + (high - low) * self.share
    }

    #[inline(always)]
    pub fn gradient(self) -> Vector<L> {
        let gradients = &self.line.gradients;
        // SAFETY: the first was clamped to the voxels, of which there is one gradient more
        let (low, high) = unsafe {
            (
                L::rows(gradients, self.first),
                L::rows(gradients, self.first + Ints::splat(1)),
            )
        };
        let mixed = |axis: usize| low[axis] + (high[axis] - low[axis]) * self.share;
        Vector::new(mixed(0), mixed(1), mixed(2))
    }
}
