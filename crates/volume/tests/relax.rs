//! Occupancy fractions worked out from bits: flat slopes without stairs, bodies that keep their size, and never a
//! fraction that disagrees with its bit.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests may fail a test, as the tests themselves"
)]

use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::occupancy_fractions::OccupancyFractions;
use palpate_volume::relax::{regions, relaxed_fractions};
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use proptest::prelude::*;

const CUBES: (UVec3, DVec3) = (UVec3::splat(92), DVec3::ONE);
const SLICES: (UVec3, DVec3) = (UVec3::new(132, 132, 37), DVec3::new(0.7, 0.7, 2.5));
/// Where bodies stand: nowhere special among the voxels [mm].
const CENTRE: DVec3 = DVec3::new(45.3, 45.1, 45.2);
const AXES: [IVec3; 3] = [IVec3::X, IVec3::Y, IVec3::Z];

/// The voxels whose middles are inside; `distance` is negative there [mm].
fn voxelised(
    (dimensions, spacing): (UVec3, DVec3),
    distance: impl Fn(DVec3) -> f64 + Sync,
) -> Bits {
    let inside = |voxel: IVec3| distance((voxel.as_dvec3() + 0.5) * spacing) < 0.0;
    Segment::from_fn(dimensions, inside).occupancy().clone()
}

fn plane(degrees: f64) -> impl Fn(DVec3) -> f64 + Sync {
    let outward = DMat3::from_rotation_y(degrees.to_radians()) * DVec3::Z;
    move |point| outward.dot(point - CENTRE)
}

/// All fractions of a mask.
fn worked_out(bits: &Bits, spacing: DVec3) -> OccupancyFractions {
    let mut fractions = OccupancyFractions::unknown(bits.dimensions());
    for region in regions(bits) {
        let known = fractions.clone();
        for mut swap in relaxed_fractions(bits, spacing.as_vec3(), &region, &known) {
            fractions.swap(&mut swap);
        }
    }
    fractions
}

/// How far what columns along an axis count is from the true surface, negative inside [mm], in the
/// middle of the grid; only where columns go through the surface once.
fn errors(
    bits: &Bits,
    fractions: &OccupancyFractions,
    (spacing, axis): (DVec3, usize),
    distance: impl Fn(DVec3) -> f64,
) -> Vec<f64> {
    let size = bits.dimensions().as_ivec3();
    let inner = VoxelBox::of_dimensions(bits.dimensions());
    let margin = IVec3::from_array((DVec3::splat(18.0) / spacing).as_ivec3().to_array());
    let inner = VoxelBox::new(inner.min + margin, inner.max - margin);
    let step = AXES[axis];
    inner
        .voxels()
        .filter(|&voxel| bits.is_solid(voxel) && !bits.is_solid(voxel + step))
        .filter(|&voxel| (voxel + step)[axis] < size[axis])
        .map(|voxel| {
            let solid = fractions.fraction(voxel, true).unwrap();
            let free = fractions.fraction(voxel + step, false).unwrap();
            let mut top = voxel.as_dvec3() + 0.5;
            top[axis] += f64::from(solid + free) - 0.5;
            distance(top * spacing)
        })
        .collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Root mean square about the mean.
fn ripple(values: &[f64]) -> f64 {
    let middle = mean(values);
    let squares = values.iter().map(|value| (value - middle).powi(2));
    (squares.sum::<f64>() / values.len() as f64).sqrt()
}

#[test]
fn flat_slopes_have_no_stairs_on_cubes_nor_on_slices() {
    for (grid, degrees, most) in [
        (CUBES, 3.0, 0.05),
        (CUBES, 5.0, 0.05),
        (CUBES, 10.0, 0.05),
        // in parts of 0.7 mm; the terraces of 3 degrees are 68 voxels long and 2.5 mm high
        (SLICES, 3.0, 0.15),
        (SLICES, 5.0, 0.1),
        (SLICES, 10.0, 0.08),
    ] {
        let spacing = grid.1;
        let bits = voxelised(grid, plane(degrees));
        let fractions = worked_out(&bits, spacing);
        let errors = errors(&bits, &fractions, (spacing, 2), plane(degrees));
        let ripple = ripple(&errors) / spacing.min_element();
        let bias = mean(&errors) / spacing.min_element();
        assert!(ripple < most, "{degrees} degrees, {spacing}: {ripple} h");
        assert!(
            bias.abs() < 0.15,
            "{degrees} degrees, {spacing}: {bias} h off"
        );
    }
}

/// Its risers run along an axis, with a jog of a voxel now and then, that look like faces of a box.
#[test]
fn a_slope_whose_steps_have_jogs_has_no_stairs() {
    let grid = CUBES;
    let slope = |point: DVec3| point.z - (40.0 + 0.09 * point.x + 0.02 * point.y);
    let bits = voxelised(grid, slope);
    let fractions = worked_out(&bits, grid.1);
    let errors = errors(&bits, &fractions, (grid.1, 2), slope);
    let most = errors
        .iter()
        .fold(0.0, |most: f64, error| most.max(error.abs()));
    assert!(errors.len() > 500, "{} columns", errors.len());
    assert!(most < 0.15, "{most} h");
}

#[test]
fn a_ball_keeps_its_size_and_its_shape() {
    for (grid, most) in [(CUBES, 0.1), (SLICES, 0.25)] {
        let spacing = grid.1;
        let distance = |point: DVec3| point.distance(CENTRE) - 20.0;
        let bits = voxelised(grid, distance);
        let fractions = worked_out(&bits, spacing);
        // a cap on which columns go through the surface steeply
        let cap = |point: DVec3| {
            let steep = (point - CENTRE).normalize().z > 0.75;
            if steep { distance(point) } else { f64::NAN }
        };
        let mut errors = errors(&bits, &fractions, (spacing, 2), cap);
        errors.retain(|error| error.is_finite());
        assert!(errors.len() > 300, "{} columns", errors.len());
        let h = spacing.min_element();
        let (ripple, bias) = (ripple(&errors) / h, mean(&errors) / h);
        assert!(ripple < most, "{spacing}: {ripple} h");
        assert!(bias.abs() < 0.1, "{spacing}: {bias} h off");
    }
}

#[test]
fn faces_of_a_box_are_flat_and_where_they_are() {
    for (dimensions, spacing) in [CUBES, SLICES] {
        let low = IVec3::new(20, 24, 9);
        let high = IVec3::new(52, 60, 27);
        let inside = |voxel: IVec3| voxel.cmpge(low).all() && voxel.cmplt(high).all();
        let segment = Segment::from_fn(dimensions, inside);
        let fractions = worked_out(segment.occupancy(), spacing);
        // edges are rounded
        for x in low.x + 4..high.x - 4 {
            for y in low.y + 4..high.y - 4 {
                let top = IVec3::new(x, y, high.z - 1);
                let count = fractions.fraction(top, true).unwrap()
                    + fractions.fraction(top + IVec3::Z, false).unwrap();
                assert!((count - 1.0).abs() < 0.01, "{top}, {spacing}: {count}");
            }
        }
    }
}

#[test]
fn walls_of_one_voxel_stay_closed_where_they_are() {
    let grid = (UVec3::splat(40), DVec3::ONE);
    let slope = plane(15.0);
    let middle = DVec3::splat(20.2) - CENTRE;
    // the voxels of a slope that have a free one above them
    let below = voxelised(grid, |point| slope(point - middle));
    let wall = Segment::from_fn(grid.0, |voxel| {
        below.is_solid(voxel) && !below.is_solid(voxel + IVec3::Z)
    });
    let bits = wall.occupancy();
    let fractions = worked_out(bits, grid.1);
    for voxel in VoxelBox::of_dimensions(grid.0).dilate(-4).voxels() {
        if bits.is_solid(voxel) {
            let fraction = fractions.fraction(voxel, true).unwrap();
            assert!((0.5..=1.0).contains(&fraction), "{voxel}: {fraction}");
        }
    }
}

#[test]
fn what_is_known_around_a_region_stays_and_is_gone_on_from() {
    let spacing = CUBES.1;
    let bits = voxelised(CUBES, plane(5.0));
    let all = worked_out(&bits, spacing);
    // forget a part in the middle and work it out again
    let hole = VoxelBox::new(IVec3::splat(38), IVec3::splat(54));
    let mut holed = all.clone();
    let nothing = Bits::empty(bits.dimensions());
    for mut swap in relaxed_fractions(&nothing, spacing.as_vec3(), &hole, &all) {
        holed.swap(&mut swap);
    }
    assert!(hole.voxels().all(|voxel| holed.byte(voxel) == 0));
    let again = relaxed_fractions(&bits, spacing.as_vec3(), &hole, &holed);
    let mut mended = holed.clone();
    for swap in &again {
        mended.swap(&mut swap.clone());
    }
    for voxel in VoxelBox::of_dimensions(bits.dimensions()).voxels() {
        let (was, is) = (all.byte(voxel), mended.byte(voxel));
        if hole.contains(voxel) {
            assert!(was.abs_diff(is) <= 13, "{voxel}: {was}, now {is} of 252");
        } else {
            assert_eq!(was, is, "{voxel}");
        }
    }
}

fn noise(salt: u64, density: u64) -> Bits {
    let dimensions = UVec3::new(13, 17, 11);
    let segment = Segment::from_fn(dimensions, |voxel| {
        let mut bits = salt ^ (voxel.x as u64) << 40 ^ (voxel.y as u64) << 20 ^ voxel.z as u64;
        for _ in 0..3 {
            bits = (bits ^ bits >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        }
        (bits >> 32) % 100 < density
    });
    segment.occupancy().clone()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Of any mask, all voxels beside the surface have a fraction, which agrees with their bit, and no
    /// other voxel has; whatever is worked out again, and from whatever was known.
    #[test]
    fn fractions_agree_with_bits(salt: u64, density in 1_u64..99, stale: u64, uneven: bool) {
        let bits = noise(salt, density);
        let spacing = if uneven { DVec3::new(0.7, 0.7, 2.5) } else { DVec3::ONE };
        // fractions of other voxels are no reason to disagree
        let before = worked_out(&noise(stale, density), spacing);
        let mut fractions = before.clone();
        let whole = VoxelBox::of_dimensions(bits.dimensions());
        let halves = [
            VoxelBox::new(whole.min, whole.max.with_x(6)),
            VoxelBox::new(whole.min.with_x(6), whole.max),
        ];
        for half in halves {
            let known = fractions.clone();
            let swaps: Vec<BrickSwap<_>> =
                relaxed_fractions(&bits, spacing.as_vec3(), &half, &known);
            swaps.into_iter().for_each(|mut swap| fractions.swap(&mut swap));
        }
        for voxel in whole.voxels() {
            let solid = bits.is_solid(voxel);
            let is_surface = AXES.into_iter().flat_map(|axis| [voxel - axis, voxel + axis])
                .any(|beside| whole.contains(beside) && bits.is_solid(beside) != solid);
            prop_assert_eq!(fractions.byte(voxel) != 0, is_surface);
            prop_assert_eq!(fractions.fraction(voxel, solid).is_some(), is_surface);
        }
    }
}
