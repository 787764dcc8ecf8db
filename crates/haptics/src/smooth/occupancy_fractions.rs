//! How much of a voxel at the surface is solid, from the intensities that it was made from.
//!
//! A threshold makes whole voxels solid or free; the intensities still tell where between
//! two voxels the threshold is crossed. Counting each voxel at the surface by its fraction takes
//! most of the stairs away, and leaves all the rest as it is: what the proxy does not reach is
//! filled, noise is blurred, and a voxel that was edited counts as its bit says.
//!
//! This in place of a trilinear surface at the threshold: its gradient steps from voxel to
//! voxel, it is as rough as the noise, and it knows nothing of edits nor of thin walls.
//!
//! Frame: grid. Values and limits as stored.

use glam::{IVec3, UVec3, Vec3A};
use palpate_volume::intensities::Intensities;

/// Stored values of a voxel and of its neighbours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Around {
    /// Value of the voxel itself.
    pub here: f32,
    /// Values of the voxels before it along x, y and z.
    pub before: Vec3A,
    /// Values of the voxels after it along x, y and z.
    pub after: Vec3A,
}

/// A voxel's stored value, then those before and after it along x, y and z.
pub type Stored = [i16; 7];

impl Around {
    /// Of a voxel of a scan; beyond its border the outermost values go on, so that a body that
    /// the border cuts ends there as its bits do.
    #[inline]
    #[must_use]
    pub fn of(scan: &Intensities, voxel: IVec3) -> Self {
        Self::of_stored(Self::stored(scan, voxel))
    }

    /// The stored values themselves.
    #[inline]
    #[must_use]
    pub fn stored(scan: &Intensities, voxel: IVec3) -> Stored {
        Self::of_inner(scan, voxel).unwrap_or_else(|| Self::of_outer(scan, voxel))
    }

    /// From values as they are stored.
    #[inline]
    #[must_use]
    pub fn of_stored(stored: Stored) -> Self {
        let [
            here,
            before_x,
            after_x,
            before_y,
            after_y,
            before_z,
            after_z,
        ] = stored.map(f32::from);
        Self {
            here,
            before: Vec3A::new(before_x, before_y, before_z),
            after: Vec3A::new(after_x, after_y, after_z),
        }
    }

    /// Values around a voxel that is not at the border; none for others.
    #[inline]
    fn of_inner(scan: &Intensities, voxel: IVec3) -> Option<Stored> {
        // without its sign, what is negative is large
        let before = (voxel - 1).as_uvec3();
        let inner = scan.dimensions().saturating_sub(UVec3::splat(2));
        if !before.cmplt(inner).all() {
            return None;
        }
        let [nx, ny] = [scan.dimensions().x as usize, scan.dimensions().y as usize];
        let [x, y, z] = voxel.to_array().map(|i| i as usize);
        let layer = nx * ny;
        // from the one below to the one above
        let first = (z - 1) * layer + y * nx + x;
        let values = scan.values().get(first..=first + 2 * layer)?;
        let [before_x, here, after_x] = *values.get(layer - 1..layer + 2)?.first_chunk()?;
        let [before_y, after_y] = [*values.get(layer - nx)?, *values.get(layer + nx)?];
        let [before_z, after_z] = [*values.first()?, *values.last()?];
        Some([
            here, before_x, after_x, before_y, after_y, before_z, after_z,
        ])
    }

    /// Values around any voxel, the outermost ones continued beyond the border.
    #[inline(never)]
    fn of_outer(scan: &Intensities, voxel: IVec3) -> Stored {
        let size = scan.dimensions().as_ivec3();
        Self::stored_from(voxel, |voxel| {
            let [x, y, z] = voxel.clamp(IVec3::ZERO, size - 1).to_array();
            let place = (z as usize * size.y as usize + y as usize) * size.x as usize + x as usize;
            scan.values().get(place).copied().unwrap_or_default()
        })
    }

    /// Values around a voxel, each asked for by its place.
    #[must_use]
    pub fn from_fn(voxel: IVec3, stored: impl Fn(IVec3) -> i16) -> Self {
        Self::of_stored(Self::stored_from(voxel, stored))
    }

    /// Stored values around a voxel, each asked for by its place.
    #[must_use]
    pub fn stored_from(voxel: IVec3, stored: impl Fn(IVec3) -> i16) -> Stored {
        let [x, y, z] = [IVec3::X, IVec3::Y, IVec3::Z];
        [
            voxel,
            voxel - x,
            voxel + x,
            voxel - y,
            voxel + y,
            voxel - z,
            voxel + z,
        ]
        .map(stored)
    }
}

/// Most ranges apart from each other; of more, the lowest count.
const MAX_RANGES: usize = 8;

/// The values that are solid: those of one threshold, or of any of several.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Apart from each other and rising; as stored.
    pub(super) ranges: [[f32; 2]; MAX_RANGES],
    pub(super) count: usize,
}

impl Limits {
    /// Thresholds on a scan of this slope and intercept, each from a lowest to a highest
    /// physical value. Where no stored value lies between two of them they are one, so that
    /// there is no surface where segments touch.
    #[must_use]
    pub fn new(
        (slope, intercept): (f64, f64),
        thresholds: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        let stored = |value: f64| ((value - intercept) / slope) as f32;
        let mut ranges: Vec<[f32; 2]> = thresholds
            .into_iter()
            .map(|(low, high)| {
                let [first, second] = [low, high].map(stored);
                // a negative slope turns them around
                [first.min(second), first.max(second)]
            })
            .collect();
        ranges.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut limits = Self::default();
        for [low, high] in ranges {
            match limits.ranges[..limits.count].last_mut() {
                Some(last) if low <= last[1].floor() + 1.0 => last[1] = last[1].max(high),
                _ if limits.count < MAX_RANGES => {
                    limits.ranges[limits.count] = [low, high];
                    limits.count += 1;
                }
                _ => {}
            }
        }
        limits
    }

    /// Whether no value is solid.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Distance of a stored value from the nearest limit; negative outside.
    fn within(&self, stored: f32) -> f32 {
        let ranges = self.ranges.iter().take(self.count);
        let within = ranges.map(|[low, high]| (stored - low).min(high - stored));
        within.fold(f32::NEG_INFINITY, f32::max)
    }

    /// The fraction of a voxel that is solid; see `Occupancy::fraction`.
    #[inline]
    #[must_use]
    pub fn fraction(&self, around: &Around, solid: bool) -> Option<f32> {
        match self.count {
            // there is mostly but one
            1 => {
                let [low, high] = self.ranges[0];
                let within = |values: Vec3A| (values - low).min(high - values);
                let [above, below] = [around.here - low, high - around.here];
                let here = if above < below { above } else { below };
                fraction(within(around.before), here, within(around.after), solid)
            }
            _ => self.share_of_many(around, solid),
        }
    }

    /// The occupancy fraction for any number of ranges.
    #[inline(never)]
    fn share_of_many(&self, around: &Around, solid: bool) -> Option<f32> {
        if self.is_empty() {
            return None;
        }
        let within = |values: Vec3A| values.map(|stored| self.within(stored));
        fraction(
            within(around.before),
            self.within(around.here),
            within(around.after),
            solid,
        )
    }
}

/// The fraction of a voxel that is solid, from how far values are within what is solid: its own, and
/// those before and after it along each axis.
///
/// Along the axis on which values change most, a surface passes between the middles of one solid
/// voxel and one free voxel of each column. So each of these two gives or takes half of how far it
/// is from the middle between them, and the column counts just as much as is solid.
#[inline]
fn fraction(before: Vec3A, here: f32, after: Vec3A, solid: bool) -> Option<f32> {
    // an edit, or another segment, made it what it is
    if solid != (here >= 0.0) {
        return None;
    }
    let own = Vec3A::splat(here);
    let changes = (before - own).abs().max((after - own).abs());
    // nothing rises here
    if changes == Vec3A::ZERO {
        return None;
    }
    let axis = changes.max_position();
    let side = if solid { 1.0 } else { -1.0 };
    let [before, here, after] = [before[axis], here, after[axis]].map(|value| side * value);
    let ways = way_to_surface(after, here, before) + way_to_surface(before, here, after);
    let own = (0.5 * ways).max(0.5);
    let fraction = if solid { own } else { 1.0 - own };
    fraction.is_finite().then_some(fraction)
}

/// The way from the middle of a voxel to where values pass zero, of that to the next voxel; 1 where
/// they do not pass it there. By how far the value before it, its own and that beyond are above it.
///
/// Where values go on evenly they are taken as straight lines. Where they do not rise before it,
/// as if the scanner blurred no more than over a voxel, the two at the surface are what is solid
/// of them, and the one before is as far above zero as free ones are below. Between, a blend.
#[inline]
fn way_to_surface(before: f32, here: f32, beyond: f32) -> f32 {
    if beyond >= 0.0 {
        return 1.0;
    }
    let most = before.max(here);
    let fall = here - beyond;
    let straight = here / fall;
    let filled = 0.5 + 0.5 * (here + beyond) / most;
    // none of both where the threshold is met by no value above it
    let even = ((most - here) / fall).min(1.0);
    let way = if most > 0.0 {
        filled + 0.5 * (even + even * even) * (straight - filled)
    } else {
        straight
    };
    way.clamp(0.0, 1.0)
}
