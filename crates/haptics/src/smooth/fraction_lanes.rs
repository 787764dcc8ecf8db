//! The fractions of several voxels at once, side by side, as processors work fastest.
//!
//! All is decided by picking numbers, never by branches, which would be guessed wrong where a
//! surface is rough. What comes out is the same, to the bit, as [`Limits::fraction`] tells of each.
//!
//! Frame: grid. Values and limits as stored.

use super::occupancy_fractions::{Limits, Stored};
use glam::IVec3;
use palpate_volume::simd_dispatch;

/// Voxels side by side.
const LANES: usize = 8;

/// A number for each voxel.
type Lane = [f32; LANES];

/// Values of some voxels and of their neighbours.
struct Lanes {
    /// Stored values of the voxel itself, then of those before and after it along x, y and z.
    values: [[i16; LANES]; 7],
    /// 1 for a solid one, 0 for others.
    solid: Lane,
}

impl Limits {
    /// By how much each of some voxels counts for more or less than its bit, where values are
    /// `stored`; see `Occupancy::fraction_changes`.
    #[inline]
    pub fn fraction_changes(
        &self,
        stored: impl Fn(IVec3) -> Stored,
        voxels: &[(IVec3, bool)],
        changes: &mut [f32],
    ) {
        for (voxels, changes) in voxels.chunks(LANES).zip(changes.chunks_mut(LANES)) {
            let mut lanes = Lanes {
                values: [[0; LANES]; 7],
                solid: [0.0; LANES],
            };
            for (lane, (voxel, solid)) in voxels.iter().enumerate() {
                lanes.solid[lane] = f32::from(u8::from(*solid));
                for (values, value) in lanes.values.iter_mut().zip(stored(*voxel)) {
                    values[lane] = value;
                }
            }
            let told = changes_of(self, &lanes);
            for (change, told) in changes.iter_mut().zip(told) {
                *change = told;
            }
        }
    }

    #[inline(always)]
    fn changes_plainly(&self, lanes: &Lanes) -> Lane {
        let mut within = [[f32::NEG_INFINITY; LANES]; 7];
        for [low, high] in self.ranges.iter().take(self.count) {
            for (within, values) in within.iter_mut().zip(&lanes.values) {
                for (within, value) in within.iter_mut().zip(values) {
                    let value = f32::from(*value);
                    *within = larger(*within, smaller(value - low, high - value));
                }
            }
        }
        let [
            here,
            before_x,
            after_x,
            before_y,
            after_y,
            before_z,
            after_z,
        ] = within;
        let mut changes = [0.0; LANES];
        for i in 0..LANES {
            let columns = [
                [before_x[i], after_x[i]],
                [before_y[i], after_y[i]],
                [before_z[i], after_z[i]],
            ];
            changes[i] = change(here[i], columns, lanes.solid[i]);
        }
        changes
    }
}

simd_dispatch! {
    /// Occupancy fraction of each voxel less its bit, -½..=½.
    fn changes_of(limits: &Limits, lanes: &Lanes) -> Lane = [avx2] Limits::changes_plainly
}

/// By how much a voxel counts for more or less than its bit; see `fraction` in `occupancy_fractions.rs`.
#[inline(always)]
fn change(here: f32, columns: [[f32; 2]; 3], solid: f32) -> f32 {
    let is_solid = solid > 0.5;
    let is_within = here >= 0.0;
    let rise = |[before, after]: [f32; 2]| larger((before - here).abs(), (after - here).abs());
    let [x, y, z] = columns.map(rise);
    let [[before, after], rises] = if y > x {
        [columns[1], [y, y]]
    } else {
        [columns[0], [x, x]]
    };
    let [before, after, rises] = if z > rises[0] {
        [columns[2][0], columns[2][1], z]
    } else {
        [before, after, rises[0]]
    };
    let side = if is_solid { 1.0 } else { -1.0 };
    let [before, here, after] = [side * before, side * here, side * after];
    let ways = way_to_surface(after, here, before) + way_to_surface(before, here, after);
    let own = larger(0.5 * ways, 0.5);
    let fraction = if is_solid { own } else { 1.0 - own };
    let known = (is_solid == is_within) & (rises != 0.0) & fraction.is_finite();
    if known { fraction - solid } else { 0.0 }
}

/// See there.
#[inline(always)]
fn way_to_surface(before: f32, here: f32, beyond: f32) -> f32 {
    let most = larger(before, here);
    let fall = here - beyond;
    let straight = here / fall;
    let filled = 0.5 + 0.5 * (here + beyond) / most;
    let even = smaller((most - here) / fall, 1.0);
    let blend = filled + 0.5 * (even + even * even) * (straight - filled);
    let way = if most > 0.0 { blend } else { straight };
    let way = smaller(larger(way, 0.0), 1.0);
    if beyond >= 0.0 { 1.0 } else { way }
}

/// One instruction, where numbers are numbers.
#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// One instruction, where numbers are numbers.
#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::super::occupancy_fractions::Around;
    use super::*;
    use glam::UVec3;
    use palpate_volume::intensities::Intensities;

    #[test]
    fn fractions_asked_at_once_are_those_asked_one_by_one_to_the_bit() {
        let mut random = oorandom::Rand32::new(7);
        let size = UVec3::new(9, 7, 5);
        let ranges: [&[(f64, f64)]; 4] = [
            &[(40.0, f64::INFINITY)],
            &[(40.0, 60.0)],
            &[(10.0, 20.0), (55.5, 70.0), (90.0, 95.0)],
            &[],
        ];
        let mut known = 0;
        for run in 0..200 {
            // also with many equal values
            let steps = 2 + run % 99;
            let values: Vec<i16> = (0..size.element_product())
                .map(|_| (random.rand_range(0..steps) * 100 / steps) as i16)
                .collect();
            let scan = Intensities::new(size, values, 1.0, 0.0).expect("one value per voxel");
            let limits = Limits::new((1.0, 0.0), ranges[run as usize % 4].iter().copied());
            // beyond the border as well
            let voxels: Vec<(IVec3, bool)> = (0..random.rand_range(0..40))
                .map(|_| {
                    let [x, y, z] = [9, 7, 5].map(|n| random.rand_range(0..n + 2) as i32 - 1);
                    (IVec3::new(x, y, z), random.rand_range(0..2) == 1)
                })
                .collect();
            let mut changes = vec![f32::NAN; voxels.len()];
            let stored = |voxel| Around::stored(&scan, voxel);
            limits.fraction_changes(stored, &voxels, &mut changes);
            for ((voxel, solid), change) in voxels.into_iter().zip(changes) {
                let fraction = limits.fraction(&Around::of(&scan, voxel), solid);
                let bit = f32::from(u8::from(solid));
                let expected = fraction.map_or(0.0, |fraction| fraction - bit);
                assert_eq!(
                    change.to_bits(),
                    expected.to_bits(),
                    "{voxel}: {fraction:?}"
                );
                known += u32::from(fraction.is_some());
            }
        }
        assert!(known > 500, "{known}");
    }
}
