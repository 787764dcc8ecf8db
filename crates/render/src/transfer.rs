//! The transfer function as a table: colour and extinction by value, and their running integrals, of
//! which the mean over all values between two samples is a difference.
//!
//! Values are stored ones of the scan. Source: Engel et al., "Real-Time Volume Graphics" (2006), ch. 4
//! (pre-integration by integral functions).

use palpate_volume::intensities::Intensities;

use crate::appearance::ControlPoint;
use crate::lanes::{Floats, Gather, Ints, Masks, Vector};

/// Rows of the table.
const SIZE: usize = 1024;

/// Extinction below which nothing can be seen, even through a metre of it [1/mm].
const CLEAR: f32 = 1e-6;

/// A transfer function over stored values.
#[derive(Clone, Debug)]
pub(crate) struct Transfer {
    /// Place in the table, 0 to 1, of a stored value: factor and term.
    scale: (f32, f32),
    /// Linear colour and extinction [1/mm].
    rows: Vec<[f32; 4]>,
    /// The extinctions alone.
    extinctions: Vec<f32>,
    /// Places between which nothing is clear.
    seen: (f32, f32),
    /// For each row the first from there on that is seen; `SIZE` where there is none.
    next_seen: Vec<usize>,
    /// Running integrals of colour · extinction and of extinction over the place.
    integrals: Vec<[f32; 4]>,
}

impl Transfer {
    /// Bakes a function of at least two points by rising value.
    pub fn new(points: &[ControlPoint], scan: &Intensities) -> Self {
        let (low, high) = (points[0].value, points[points.len() - 1].value);
        let width = (high - low).max(f64::MIN_POSITIVE);
        let rows: Vec<_> = (0..SIZE)
            .map(|i| sample(points, low + width * i as f64 / (SIZE - 1) as f64))
            .collect();
        let scale = (scan.slope() / width) as f32;
        Self {
            scale: (scale, ((scan.intercept() - low) / width) as f32),
            integrals: integrated(&rows),
            extinctions: rows.iter().map(|row| row[3]).collect(),
            seen: seen_places(&rows),
            next_seen: next_seen(&rows),
            rows,
        }
    }

    /// Whether any stored value from `low` to `high` is seen.
    pub fn shows(&self, low: i16, high: i16) -> bool {
        let place = |stored: i16| f32::from(stored) * self.scale.0 + self.scale.1;
        let (a, b) = (place(low), place(high));
        let row = |place: f32| place.clamp(0.0, 1.0) * (SIZE - 1) as f32;
        let (first, last) = (
            row(a.min(b)).floor() as usize,
            row(a.max(b)).ceil() as usize,
        );
        self.next_seen[first] <= last
    }

    /// Extinction [1/mm] at a stored value.
    #[inline(always)]
    pub fn extinction_at<L: Gather>(&self, stored: L::Float) -> L::Float {
        let (first, share) = self.row_at::<L>(stored);
        // SAFETY: as in `integral_to`
        let [low, high] = unsafe { L::neighbours(&self.extinctions, first) };
        low + (high - low) * share
    }

    /// Linear colour, and extinction [1/mm], at a stored value.
    #[inline(always)]
    pub fn tissue_at<L: Gather>(&self, stored: L::Float) -> (Vector<L>, L::Float) {
        let (first, share) = self.row_at::<L>(stored);
        // SAFETY: as in `integral_to`
        let (low, high) = unsafe {
            (
                L::rows(&self.rows, first),
                L::rows(&self.rows, first + Ints::splat(1)),
            )
        };
        let mut tissue = low;
        for i in 0..4 {
            tissue[i] = low[i] + (high[i] - low[i]) * share;
        }
        let [red, green, blue, extinction] = tissue;
        (Vector::new(red, green, blue), extinction)
    }

    /// The row before a stored value, and how far it lies toward the next.
    #[inline(always)]
    fn row_at<L: Gather>(&self, stored: L::Float) -> (L::Int, L::Float) {
        let place = stored * Floats::splat(self.scale.0) + Floats::splat(self.scale.1);
        let row = place.max(Floats::splat(0.0)).min(Floats::splat(1.0))
            * Floats::splat((SIZE - 1) as f32);
        let first = row.truncated().min(Ints::splat(SIZE as i32 - 2));
        (first, row - first.to_float())
    }

    /// Where the mean over all stored values between two has no extinction, at least where all are beyond what is seen.
    #[inline(always)]
    pub fn are_clear_between<L: Gather>(&self, front: L::Float, back: L::Float) -> L::Mask {
        let place =
            |stored: L::Float| stored * Floats::splat(self.scale.0) + Floats::splat(self.scale.1);
        let (one, other) = (place(front), place(back));
        one.max(other).less(Floats::splat(self.seen.0))
            | L::Float::splat(self.seen.1).less(one.min(other))
    }

    /// Mean over all stored values between two: linear colour, and extinction [1/mm].
    ///
    /// Over less than two rows a difference of sums would be mostly their rounding.
    #[inline(always)]
    pub fn between<L: Gather>(&self, front: L::Float, back: L::Float) -> (Vector<L>, L::Float) {
        let half = L::Float::splat(0.5);
        let row = L::Float::splat(1.0 / SIZE as f32);
        let middle =
            (front + back) * half * Floats::splat(self.scale.0) + Floats::splat(self.scale.1);
        let reach = ((back - front) * half * Floats::splat(self.scale.0))
            .abs()
            .max(row);
        let low = self.integral_to::<L>(middle - reach);
        let high = self.integral_to::<L>(middle + reach);
        let width = L::Float::splat(0.5).div(reach);
        let extinction = (high[3] - low[3]) * width;
        let share = width.div(extinction.max(Floats::splat(1e-9)));
        let weighted = Vector::new(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
        (weighted.scaled(share), extinction)
    }

    /// The running integral up to a place; beyond the table the function stays as at its ends.
    #[inline(always)]
    fn integral_to<L: Gather>(&self, place: L::Float) -> [L::Float; 4] {
        let (zero, one) = (L::Float::splat(0.0), L::Float::splat(1.0));
        let inside = place.max(zero).min(one);
        let row = inside * Floats::splat((SIZE - 1) as f32);
        let first = row.truncated().min(Ints::splat(SIZE as i32 - 2));
        let share = row - first.to_float();
        // SAFETY: the first of two rows lies between 0 and SIZE - 2; what is no number was clamped to 0
        let (low, high) = unsafe {
            (
                L::rows(&self.integrals, first),
                L::rows(&self.integrals, first + Ints::splat(1)),
            )
        };
        let mut integral = [zero; 4];
        for i in 0..4 {
            integral[i] = low[i] + (high[i] - low[i]) * share;
        }
        let beyond = place - inside;
        if beyond.less(zero).any() || zero.less(beyond).any() {
            let below = beyond.less(zero);
            for (i, sum) in integral.iter_mut().enumerate() {
                let end = L::Float::splat(weighted(&self.rows[0], i))
                    .or_else(below, Floats::splat(weighted(&self.rows[SIZE - 1], i)));
                *sum = *sum + beyond * end;
            }
        }
        integral
    }
}

/// Places before and after which the integrals do not rise, with the rows that [`Transfer::between`] reaches beyond.
fn seen_places(rows: &[[f32; 4]]) -> (f32, f32) {
    let is_seen = |row: &[f32; 4]| row[3] > 0.0;
    let place = |row: f32| row / (SIZE - 1) as f32;
    let first = match rows.iter().position(is_seen) {
        Some(0) => f32::NEG_INFINITY,
        first => place(first.unwrap_or(2 * SIZE) as f32 - 3.0),
    };
    let last = match rows.iter().rposition(is_seen) {
        Some(last) if last < rows.len() - 1 => place(last as f32 + 3.0),
        _ => f32::INFINITY,
    };
    (first, last)
}

fn next_seen(rows: &[[f32; 4]]) -> Vec<usize> {
    let mut next = vec![SIZE; rows.len()];
    let mut seen = SIZE;
    for (i, row) in rows.iter().enumerate().rev() {
        if row[3] > CLEAR {
            seen = i;
        }
        next[i] = seen;
    }
    next
}

/// Colour · extinction, or extinction.
fn weighted(row: &[f32; 4], channel: usize) -> f32 {
    row[3] * if channel == 3 { 1.0 } else { row[channel] }
}

/// Running integrals of a table over its place from 0 to 1, by trapezoids.
fn integrated(rows: &[[f32; 4]]) -> Vec<[f32; 4]> {
    let mut sums = [0.0_f64; 4];
    let mut integrals = vec![[0.0; 4]];
    for pair in rows.windows(2) {
        for (i, sum) in sums.iter_mut().enumerate() {
            *sum += 0.5 * f64::from(weighted(&pair[0], i) + weighted(&pair[1], i))
                / (rows.len() - 1) as f64;
        }
        integrals.push(sums.map(|sum| sum as f32));
    }
    integrals
}

/// The function at a value, straight between its points.
fn sample(points: &[ControlPoint], value: f64) -> [f32; 4] {
    let above = points.partition_point(|point| point.value < value);
    let next = &points[above.min(points.len() - 1)];
    let previous = &points[above.saturating_sub(1)];
    let width = next.value - previous.value;
    let share = if width > 0.0 {
        ((value - previous.value) / width).clamp(0.0, 1.0) as f32
    } else {
        0.0
    };
    let colour = previous.colour.lerp(next.colour, share);
    let extinction = previous.extinction + (next.extinction - previous.extinction) * share;
    [colour.x, colour.y, colour.z, extinction]
}
