//! The scan along a row of places that lie on one line along x: value and gradient, blended from its rows of voxels
//! once for all of them, so that many places of it cost little.

use std::ops::Range;

use crate::field::Field;
use crate::lanes::{Floats, Gather, Ints, Vector};

/// Values and gradients beside the voxels of a line.
pub(super) struct Line {
    /// Mean of four rows at the line itself, and one voxel before and after along y and z.
    means: [Vec<f32>; 5],
    /// For each voxel: value, and gradient in the scan's unit [per mm]; one more at the end.
    records: Vec<[f32; 4]>,
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
            means: std::array::from_fn(|_| vec![0.0; columns]),
            records: vec![[0.0; 4]; columns + 1],
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
        if with_gradient {
            for (i, place) in [(y - 1.0, z), (y + 1.0, z), (y, z - 1.0), (y, z + 1.0)]
                .into_iter()
                .enumerate()
            {
                self.blend(field, place, columns, i + 1);
            }
        }
        let scale = field.gradient_scale();
        let [values, below, above, near, far] = self.means.each_ref().map(|it| &it[..]);
        let end = self.records.len() - 1;
        for x in columns.clone() {
            let (before, after) = (x.saturating_sub(1), (x + 1).min(end - 1));
            self.records[x] = [
                values[x],
                (values[after] - values[before]) * scale.x,
                (above[x] - below[x]) * scale.y,
                (far[x] - near[x]) * scale.z,
            ];
        }
        self.records[end] = self.records[end - 1];
    }

    #[inline(always)]
    fn blend(&mut self, field: &Field, (y, z): (f32, f32), columns: &Range<usize>, number: usize) {
        let size = field.dimensions().as_ivec3();
        let (y0, y1, y) = between(y, size.y);
        let (z0, z1, z) = between(z, size.z);
        let [a, b, c, d] = &mut self.rows;
        let a = field.row(y0, z0, a);
        let b = field.row(y1, z0, b);
        let c = field.row(y0, z1, c);
        let d = field.row(y1, z1, d);
        let mean = &mut self.means[number][columns.clone()];
        let count = mean.len();
        let (a, b) = (&a[columns.clone()][..count], &b[columns.clone()][..count]);
        let (c, d) = (&c[columns.clone()][..count], &d[columns.clone()][..count]);
        for x in 0..count {
            let near = f32::from(a[x]) + (f32::from(b[x]) - f32::from(a[x])) * y;
            let far = f32::from(c[x]) + (f32::from(d[x]) - f32::from(c[x])) * y;
            mean[x] = near + (far - near) * z;
        }
    }

    /// Value and gradient at places along x [grid].
    #[inline(always)]
    pub fn at<L: Gather>(&self, x: L::Float) -> (L::Float, Vector<L>) {
        let last = (self.records.len() - 2) as f32;
        let inside = (x - Floats::splat(0.5))
            .max(Floats::splat(0.0))
            .min(Floats::splat(last));
        let first = inside.truncated();
        let share = inside - first.to_float();
        // SAFETY: the first was clamped to the voxels, of which there is one record more
        let (low, high) = unsafe {
            (
                L::rows(&self.records, first),
                L::rows(&self.records, first + Ints::splat(1)),
            )
        };
        let mut mixed = low;
        for i in 0..4 {
            mixed[i] = low[i] + (high[i] - low[i]) * share;
        }
        let [value, x, y, z] = mixed;
        (value, Vector::new(x, y, z))
    }
}
