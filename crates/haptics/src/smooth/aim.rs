//! Where the fields of a body are made for a probe: around a point's own place, and for a ball
//! around where it touches, or would.
//!
//! A ball's middle is a radius away from there, in a direction that has to be known before any
//! field is. It is that of the solid voxels around: from the middle to the mean place of those
//! in a somewhat larger ball; how far away that is tells how far the surface is. Nothing depends
//! on it but where the window stands, and where the search begins.
//!
//! Frames: the body's grid; ways in mm along its axes.

use super::cache::Source;
use super::cell_shape::CellShape;
use crate::ball::MAX_BODIES;
use glam::{DVec3, IVec3};
use palpate_volume::occupancy::Occupancy;
use palpate_volume::walk::voxel_of;

/// Where a body is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Aim {
    /// The middle of the window.
    pub(super) point: DVec3,
    /// A voxel that is free since the probe is where it is, and from which the free side is told.
    pub(super) seed: IVec3,
    /// Vector from the probe's centre to about where it touches [mm]; zero for a point.
    pub(super) contact: DVec3,
}

/// Largest offset of the window from the ball's centre, along the surface toward the device
/// [cells].
const FARTHEST_ASIDE: f64 = 2.5;
/// The seed is at most so far above the surface [cells], so that the window holds it.
const SEED_ABOVE: f64 = 2.0;
/// Voxels up to so far beyond the ball's surface tell the direction: in cells, and in longest
/// edges of voxels, of which two may be between a ball's cell and what blocks it.
const CELLS_BEYOND: f64 = 1.5;
const EDGES_BEYOND: f64 = 2.2;

/// Blocks are passed over where they are surely out of reach, whatever is rounded.
const ROUNDED: f64 = 1.0 + 1e-9;

/// Directions to what is solid around balls, kept while they stay what they are.
#[derive(Clone, Debug)]
pub(super) struct Aims {
    kept: [Option<Kept>; MAX_BODIES],
}

/// The direction of one body, and what it follows from.
#[derive(Clone, Copy, Debug)]
struct Kept {
    source: Source,
    radius_mm: f64,
    voxel: IVec3,
    solid: Nearest,
}

/// Where what is solid around a ball begins.
#[derive(Clone, Copy, Debug)]
struct Nearest {
    /// The direction from the ball's middle; zero where nothing is.
    toward: DVec3,
    /// Distance of the surface from the ball's centre [mm].
    distance: f64,
}

impl Aims {
    /// No direction is known for any body.
    pub(super) const NONE: Self = Self {
        kept: [None; MAX_BODIES],
    };

    /// Has all directions found anew.
    pub(super) fn forget(&mut self) {
        self.kept = [None; MAX_BODIES];
    }

    /// Where a body is looked at by a probe whose middle and device are points of its grid.
    #[inline]
    pub(super) fn aim<O: Occupancy>(
        &mut self,
        body: usize,
        source: Source,
        occupancy: &O,
        spacing: DVec3,
        [middle, device]: [DVec3; 2],
    ) -> Aim {
        let radius_mm = occupancy.probe_radius_mm();
        let voxel = voxel_of(middle);
        if radius_mm == 0.0 {
            return Aim {
                point: middle,
                seed: voxel,
                contact: DVec3::ZERO,
            };
        }
        let known = self.kept[body]
            .filter(|kept| (kept.source, kept.voxel, kept.radius_mm) == (source, voxel, radius_mm));
        let solid = match known {
            Some(kept) => kept.solid,
            None => Nearest::around(occupancy, spacing, radius_mm, voxel),
        };
        self.kept[body] = Some(Kept {
            source,
            radius_mm,
            voxel,
            solid,
        });
        let Nearest { toward, distance } = solid;
        let cell = (CellShape::for_spacing(spacing).voxels().as_dvec3() * spacing).min_element();
        let way = (device - middle) * spacing;
        let aside = (way - toward * way.dot(toward)).clamp_length_max(FARTHEST_ASIDE * cell);
        // in the ball, where nothing is solid
        let seed = (distance - SEED_ABOVE * cell).clamp(0.0, 0.9 * radius_mm);
        Aim {
            point: middle + (toward * distance + aside) / spacing,
            seed: voxel_of(middle + toward * seed / spacing),
            contact: toward * radius_mm,
        }
    }
}

impl Nearest {
    /// What is solid around a voxel, taken as what a plane cuts off a ball.
    #[inline(never)]
    fn around<O: Occupancy>(occupancy: &O, spacing: DVec3, radius_mm: f64, voxel: IVec3) -> Self {
        let cell = CellShape::for_spacing(spacing).voxels().as_dvec3() * spacing;
        let beyond = CELLS_BEYOND * cell.max_element();
        let reach_mm = radius_mm + beyond.max(EDGES_BEYOND * spacing.max_element());
        let (sum, count) = moment_around(occupancy, spacing, reach_mm, voxel);
        let mean = sum.length() / count.max(1.0);
        // the mean height of a ball's cap, 3 (R + a)² / (4 (2 R + a)), solved for its beginning a
        let half = 3.0 * reach_mm - 2.0 * mean;
        let rest = 3.0 * reach_mm * (3.0 * reach_mm - 8.0 * mean);
        let distance = ((half * half - rest).max(0.0).sqrt() - half) / 3.0;
        Self {
            toward: sum.normalize_or_zero(),
            distance: distance.clamp(0.5 * radius_mm, reach_mm),
        }
    }
}

/// The sum of the places of what is solid within a ball around a voxel [mm], and how many voxels
/// that is.
fn moment_around<O: Occupancy>(
    occupancy: &O,
    spacing: DVec3,
    reach_mm: f64,
    voxel: IVec3,
) -> (DVec3, f64) {
    let reach = (reach_mm / spacing).floor().as_ivec3();
    // the last blocks stand so that they read nothing beyond, of which bricks had to be made
    let last = (reach - 7).max(-reach);
    let (mut sum, mut count) = (DVec3::ZERO, 0.0);
    for z in (-reach.z..=reach.z).step_by(8) {
        for y in (-reach.y..=reach.y).step_by(8) {
            for x in (-reach.x..=reach.x).step_by(8) {
                let from = IVec3::new(x, y, z);
                let nearest = IVec3::ZERO.clamp(from, from + 7).as_dvec3() * spacing;
                if nearest.length() > ROUNDED * reach_mm {
                    continue;
                }
                let first = from.min(last);
                let block = occupancy.smooth_block(voxel + first);
                if block.0.iter().any(|&layer| layer != 0) {
                    let block = moment(&block.0, [first, from], spacing, reach_mm);
                    (sum, count) = (sum + block.0, count + block.1);
                }
            }
        }
    }
    (sum, count)
}

/// The same of the voxels of a block that begins at `first`, those at `from` and beyond, within a
/// ball around the origin.
fn moment(
    block: &[u64; 8],
    [first, from]: [IVec3; 2],
    spacing: DVec3,
    reach_mm: f64,
) -> (DVec3, f64) {
    let (mut sum, mut total) = (DVec3::ZERO, 0.0);
    let skipped = (from - first).clamp(IVec3::ZERO, IVec3::splat(7));
    for (z, layer) in (first.z..).zip(block).skip(skipped.z as usize) {
        if *layer == 0 {
            continue;
        }
        let z = f64::from(z) * spacing.z;
        for (y, row) in (first.y..)
            .zip(layer.to_le_bytes())
            .skip(skipped.y as usize)
        {
            let row = row & 0xff << skipped.x;
            let y = f64::from(y) * spacing.y;
            let left = reach_mm * reach_mm - y * y - z * z;
            if row == 0 || left < 0.0 {
                continue;
            }
            // voxels of the row within the ball
            let half = (left.sqrt() / spacing.x) as i32;
            let [low, high] = [-half - first.x, half - first.x].map(|x| x.clamp(-1, 8));
            let inside = (0xff_u32 << low.max(0)) & (0xff_u32 >> (7 - high.min(7)));
            let bits = u32::from(row) & if high < 0 { 0 } else { inside };
            let count = f64::from(bits.count_ones());
            let places = u32::from(X_SUMS[(bits & 0xff) as usize]);
            sum.x += (count * f64::from(first.x) + f64::from(places)) * spacing.x;
            sum.y += count * y;
            sum.z += count * z;
            total += count;
        }
    }
    (sum, total)
}

/// The sum of the places of the set bits of a byte.
static X_SUMS: [u8; 256] = x_sums();

const fn x_sums() -> [u8; 256] {
    let mut sums = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let mut bit = 0;
        while bit < 8 {
            sums[byte] += (byte as u8 >> bit & 1) * bit as u8;
            bit += 1;
        }
        byte += 1;
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec3;
    use palpate_volume::segment::Segment;
    use palpate_volume::voxel_box::VoxelBox;

    #[test]
    fn the_moment_is_that_of_all_solid_voxels_in_reach() {
        let mut random = oorandom::Rand32::new(5);
        let numbers: Vec<bool> = (0..40_u32.pow(3))
            .map(|_| random.rand_range(0..100) < 30)
            .collect();
        let number = |voxel: IVec3| numbers[((voxel.z * 40 + voxel.y) * 40 + voxel.x) as usize];
        let segment = Segment::from_fn(UVec3::splat(40), number);
        let spacing = DVec3::new(0.7, 0.9, 1.6);
        for (reach_mm, voxel) in [(0.5, 17), (2.3, 20), (5.3, 19), (7.2, 18), (11.9, 21)] {
            let voxel = IVec3::splat(voxel);
            let (sum, count) = moment_around(&segment, spacing, reach_mm, voxel);

            let (mut plain_sum, mut plain_count) = (DVec3::ZERO, 0.0);
            for place in VoxelBox::new(IVec3::ZERO, IVec3::splat(40)).voxels() {
                let way = (place - voxel).as_dvec3() * spacing;
                if number(place) && way.length() <= reach_mm {
                    (plain_sum, plain_count) = (plain_sum + way, plain_count + 1.0);
                }
            }
            assert_eq!(count, plain_count, "{reach_mm}");
            // rounding of some thousand terms of 10 mm
            assert!(sum.abs_diff_eq(plain_sum, 1e-8), "{sum} {plain_sum}");
        }
    }
}
