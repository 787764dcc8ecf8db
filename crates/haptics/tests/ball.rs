//! The ball probe: the space of its centres, and what must hold while it moves.

use std::cell::Cell;

use crate::support::{
    Body, Random, SPACINGS, advance, distance_to_solid, grid, hard, noise, probe_solid,
};
use glam::{DVec3, IVec3, UVec3};
use palpate_haptics::admission::nearest_free;
use palpate_haptics::ball::{
    Ball, BallError, BallShape, MAX_REACH, ProbeSolid, ball_limits, most_bricks,
};
use palpate_haptics::contact::{ContactModel, Exact, Proxy};
use palpate_haptics::scene::TouchScene;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use proptest::prelude::*;

/// Radii in smallest spacings: touching the next voxels or just not, round ones, large ones.
const RADII: [f64; 9] = [0.0, 0.4, 1.0, 1.2, 2.0, 3.3, 5.0, 8.7, 16.0];

/// Distance between two voxels [mm], by their nearest points.
fn between_boxes(offset: IVec3, spacing: DVec3) -> f64 {
    ((offset.abs() - 1).max(IVec3::ZERO).as_dvec3() * spacing).length()
}

/// The definition, voxel by voxel.
fn blocked_plainly(
    inner: &impl Occupancy,
    cell: IVec3,
    blocks: impl Fn(IVec3) -> bool,
    reach: i32,
) -> bool {
    let around = VoxelBox::of_voxel(cell).dilate(reach);
    around
        .voxels()
        .any(|voxel| inner.is_solid(voxel) && blocks(voxel - cell))
}

/// Noise of several densities, a diagonal wall one voxel thick, a sparse scatter.
fn bodies() -> Vec<Segment> {
    let wall = Segment::from_fn(UVec3::new(30, 21, 27), |v| {
        (v.x + v.y - v.z - 20).abs() <= 1
    });
    vec![
        noise(25, 0.001, 3),
        noise(25, 0.02, 4),
        noise(25, 0.3, 5),
        wall,
    ]
}

#[test]
fn blocked_cells_are_those_nearer_than_the_radius_also_across_the_border() {
    let mut random = Random::new(1);
    let mut found = [0; 2];
    for body in bodies() {
        for spacing in SPACINGS.into_iter().chain([DVec3::new(1.0, 2.0, 0.6)]) {
            for radius in RADII {
                let radius_mm = radius * spacing.min_element();
                let hard = hard(radius, spacing);
                // touching exactly is free, to within the rounding of such lengths
                let hard_rule = |offset: IVec3| {
                    offset == IVec3::ZERO || between_boxes(offset, spacing) < radius_mm - 1e-9
                };
                let rounds = if radius > 6.0 { 4 } else { 40 };
                for _ in 0..rounds {
                    let cell = random.point(-9.0, 34.0).floor().as_ivec3();
                    let expected = blocked_plainly(&body, cell, hard_rule, MAX_REACH + 1);
                    let hard = hard.dilate(&body);
                    assert_eq!(hard.is_solid(cell), expected);
                    found[usize::from(expected)] += 1;
                    // blocks anywhere say the same as single cells
                    let block = hard.block(cell);
                    for offset in VoxelBox::of_dimensions(UVec3::splat(8)).voxels() {
                        assert_eq!(block.contains(offset), hard.is_solid(cell + offset));
                    }
                }
            }
        }
    }
    assert!(found.iter().all(|&count| count > 500), "{found:?}");
}

/// Every cell around one voxel, for every radius: where dilation by rows could go wrong.
#[test]
fn the_cells_around_a_single_voxel_have_the_shape_of_the_ball() {
    let voxel = IVec3::new(3, -5, 9);
    let body = Body(move |v| v == voxel);
    for spacing in SPACINGS {
        for radius in RADII {
            let radius_mm = radius * spacing.min_element();
            let ball = hard(radius, spacing);
            let dilated = ball.dilate(&body);
            for cell in VoxelBox::of_voxel(voxel).dilate(MAX_REACH + 3).voxels() {
                let offset = cell - voxel;
                let blocked =
                    offset == IVec3::ZERO || between_boxes(offset, spacing) < radius_mm - 1e-9;
                assert_eq!(
                    dilated.is_solid(cell),
                    blocked,
                    "{offset} {radius} {spacing}"
                );
                assert_eq!(ball.shape().blocks(offset), blocked);
            }
        }
    }
}

#[test]
fn a_ball_that_cannot_be_is_refused_with_what_is_allowed() {
    let spacing = DVec3::new(0.7, 0.7, 2.5);
    let largest = BallShape::largest_radius(spacing);
    let shape = BallShape::new(largest, spacing).expect("the largest radius is allowed");
    assert_eq!(shape.reach(), IVec3::new(16, 16, 5));

    let error = BallShape::new(30.0, spacing).expect_err("too large");
    assert!(matches!(error, BallError::TooLarge { .. }));
    let text = error.to_string();
    assert!(
        text.contains("30 mm") && text.contains("[43, 43, 12]"),
        "{text}"
    );
    assert!(
        text.contains("16 voxels") && text.contains("11.2 mm"),
        "{text}"
    );

    for radius in [-1.0, f64::NAN, f64::INFINITY] {
        let error = BallShape::new(radius, spacing).expect_err("no radius");
        assert!(matches!(error, BallError::NotARadius { .. }), "{error}");
    }
    for spacing in [DVec3::ZERO, DVec3::splat(f64::NAN), -DVec3::ONE] {
        let error = BallShape::new(0.0, spacing).expect_err("no spacing");
        assert!(matches!(error, BallError::NotASpacing { .. }), "{error}");
    }
}

/// Guarantee 1, by the distance to every voxel around: 10⁵ moves of up to 50 voxels.
#[test]
fn the_ball_never_overlaps_a_solid_voxel_however_it_moves() {
    const SIZE: u32 = 40;
    let mut touched = 0;
    for (spacing, radius) in [(0, 1.2), (0, 2.0), (0, 5.0), (1, 1.0), (1, 3.3)] {
        let spacing = SPACINGS[spacing];
        let grid = grid(UVec3::splat(SIZE), spacing);
        let reach = hard(radius, spacing).shape().reach().max_element() + 1;
        let share = 2.0 / (2.0 * radius + 1.0).powi(3);
        for seed in 0..20 {
            let body = noise(SIZE, share, seed);
            let probe = probe_solid(body, radius, spacing);
            let mut random = Random::new(seed);
            let mut device = random.point(0.0, f64::from(SIZE));
            let Some(mut proxy) = nearest_free(&probe, &grid, device, 12) else {
                continue;
            };
            for _ in 0..1000 {
                let length = 50.0 * random.between(0.0, 1.0).powi(3);
                device += random.direction() * length;
                device = device.clamp(DVec3::splat(-8.0), DVec3::splat(48.0));
                let contact = advance(&probe, &grid, device, &mut proxy);
                let distance = distance_to_solid(probe.inner(), spacing, proxy.point(), reach);
                // rounding of lengths of some 10 mm
                assert!(distance >= radius * spacing.min_element() - 1e-9);
                touched += u32::from(contact.touching);
                if let Some(cell) = contact.stopped_by {
                    check_solid_near(&probe, cell.voxel, spacing);
                }
            }
        }
    }
    assert!(touched > 40_000, "{touched}");
}

/// What a cell is blocked by is solid, blocks it, and nothing that blocks it is nearer.
fn check_solid_near(probe: &ProbeSolid<Segment>, cell: IVec3, spacing: DVec3) {
    let shape = probe.shape();
    let voxel = probe.solid_near(cell).expect("the cell is blocked");
    assert!(probe.inner().is_solid(voxel) && shape.blocks(voxel - cell));
    let distance = |voxel: IVec3| ((voxel - cell).as_dvec3() * spacing).length();
    let reach = shape.reach().max_element();
    for other in VoxelBox::of_voxel(cell).dilate(reach).voxels() {
        let blocks = probe.inner().is_solid(other) && shape.blocks(other - cell);
        assert!(!blocks || distance(other) >= distance(voxel));
    }
}

#[test]
fn a_free_cell_is_blocked_by_nothing() {
    let body = Body(|v: IVec3| v == IVec3::ZERO);
    let ball = probe_solid(body, 2.0, DVec3::ONE);
    assert_eq!(ball.solid_near(IVec3::new(3, 0, 0)), None);
    assert_eq!(ball.solid_near(IVec3::new(2, 1, 0)), Some(IVec3::ZERO));
    let point = probe_solid(Body(|v: IVec3| v == IVec3::ZERO), 0.0, DVec3::ONE);
    assert_eq!(point.solid_near(IVec3::X), None);
    assert_eq!(point.solid_near(IVec3::ZERO), Some(IVec3::ZERO));
}

/// The same moves and edits with a ball that remembers, and with one that forgets all before
/// every single update, give the same to the bit.
#[test]
fn what_is_kept_never_changes_an_answer() {
    for spacing in SPACINGS {
        let grid = grid(UVec3::splat(80), spacing);
        let mut warm = probe_solid(noise(80, 0.002, 7), 2.0, spacing);
        let mut random = Random::new(11);
        let mut device = DVec3::splat(40.0);
        let start = nearest_free(&warm, &grid, device, 12).expect("free");
        let [mut warm_proxy, mut cold_proxy] = [start; 2];
        for update in 0..20_000 {
            let length = 50.0 * random.between(0.0, 1.0).powi(4);
            device += random.direction() * length;
            device = device.clamp(DVec3::splat(-8.0), DVec3::splat(88.0));
            let cold = probe_solid(warm.inner(), 2.0, spacing);
            let answers = [
                advance(&warm, &grid, device, &mut warm_proxy),
                advance(&cold, &grid, device, &mut cold_proxy),
            ];
            assert_eq!(answers[0], answers[1]);
            assert_eq!(warm_proxy, cold_proxy);
            if update % 100 == 0 {
                warm = edited(warm, spacing, warm_proxy, &mut random);
            }
        }
    }
}

/// The voxels with some more solid or free, where the probe allows it.
fn edited(
    mut probe: ProbeSolid<Segment>,
    spacing: DVec3,
    proxy: Proxy,
    random: &mut Random,
) -> ProbeSolid<Segment> {
    let low = (proxy.point() + random.point(-9.0, 6.0)).floor().as_ivec3();
    let changed = VoxelBox::new(low, low + 3);
    let make_solid = random.below(2) == 0;
    let old = probe.inner();
    let new = Segment::from_fn(old.dimensions(), |v| {
        if changed.contains(v) {
            make_solid
        } else {
            old.is_solid(v)
        }
    });
    let new_ball = hard(2.0, spacing);
    if !new_ball.dilate(&new).is_solid(proxy.voxel()) {
        probe.change(&changed, |voxels| *voxels = new);
    }
    probe
}

#[test]
fn at_rest_the_ball_stays_to_the_bit() {
    let mut random = Random::new(31);
    for spacing in SPACINGS {
        let grid = grid(UVec3::splat(40), spacing);
        let probe = probe_solid(noise(40, 0.01, 3), 1.2, spacing);
        let mut proxy = nearest_free(&probe, &grid, DVec3::splat(20.0), 12).expect("free");
        for _ in 0..2000 {
            let device = random.point(-5.0, 45.0);
            for _ in 0..16 {
                advance(&probe, &grid, device, &mut proxy);
            }
            let resting = (proxy, advance(&probe, &grid, device, &mut proxy));
            for _ in 0..5 {
                let contact = advance(&probe, &grid, device, &mut proxy);
                assert_eq!((proxy, contact), resting);
            }
        }
    }
}

/// 2 ⌈r/h⌉ + 1 voxels let a ball through, one less does not, though it may be round enough.
#[test]
fn a_channel_lets_through_the_balls_that_cells_have_room_for() {
    let grid = grid(UVec3::splat(64), DVec3::ONE);
    for (radius, width, passes) in [(1.2, 5, true), (1.2, 4, false), (2.0, 5, true)] {
        let channel = Body(move |v: IVec3| {
            (20..40).contains(&v.z) && (v.truncate() - 30).max_element() >= width
                || (20..40).contains(&v.z) && (v.truncate() - 30).min_element() < 0
        });
        let probe = probe_solid(channel, radius, DVec3::ONE);
        let middle = 30.0 + 0.5 * f64::from(width);
        let mut proxy = Proxy::at(DVec3::new(middle, middle, 50.0)).expect("finite");
        for _ in 0..10 {
            advance(&probe, &grid, DVec3::new(middle, middle, 10.0), &mut proxy);
        }
        assert_eq!(proxy.point().z < 15.0, passes, "{radius} {width}");
    }
}

/// Counts the bricks that are read.
struct Counted<'a, O> {
    inner: &'a O,
    blocks: Cell<u32>,
}

impl<O: Occupancy> Occupancy for Counted<'_, O> {
    fn is_solid(&self, voxel: IVec3) -> bool {
        self.inner.is_solid(voxel)
    }
    fn block(&self, min: IVec3) -> BitBrick {
        self.blocks.set(self.blocks.get() + 1);
        self.inner.block(min)
    }
}

/// The wildest moves, with nothing kept from tick to tick.
#[test]
fn a_tick_fills_no_more_bricks_than_stated() {
    for (radius, bricks_read) in [(1.0_f64, 27), (5.0, 27), (12.0, 125)] {
        let grid = grid(UVec3::splat(160), DVec3::ONE);
        let body = noise(160, 0.002 / radius.powi(3), 7);
        let limits = ball_limits(hard(radius, DVec3::ONE).shape());
        let mut random = Random::new(5);
        let mut most = 0;
        let mut proxy = Proxy::at(DVec3::splat(-30.0)).expect("finite");
        for _ in 0..300 {
            let device = random.point(-30.0, 190.0);
            let counted = Counted {
                inner: &body,
                blocks: Cell::new(0),
            };
            let probe = probe_solid(&counted, radius, DVec3::ONE);
            let scene = TouchScene::of_world(&probe, &grid);
            let contact = Exact { limits }.advance(&scene, device, &mut proxy);
            assert!(!contact.violation);
            most = most.max(counted.blocks.get() / bricks_read);
        }
        assert!(most <= most_bricks(&limits), "{most}");
        assert!(most >= 20, "the moves were tame: {most}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// The definition for any spacing, radius and scatter of voxels, on both sides of 0.
    #[test]
    fn a_cell_is_blocked_by_the_voxels_nearer_than_the_radius(
        spacing in prop::array::uniform3(0.3..3.0_f64),
        share in 0.0..=1.0_f64,
        voxels in prop::collection::vec(prop::array::uniform3(-12..12_i32), 1..6),
        cells in prop::collection::vec(prop::array::uniform3(-30..30_i32), 40),
    ) {
        let spacing = DVec3::from_array(spacing);
        let radius = share * BallShape::largest_radius(spacing);
        let ball = Ball::new(BallShape::new(radius, spacing).expect("within the window"));
        let voxels: Vec<IVec3> = voxels.into_iter().map(IVec3::from_array).collect();
        let body = Body(|voxel| voxels.contains(&voxel));
        for cell in cells.into_iter().map(IVec3::from_array) {
            let blocked = voxels.iter().any(|&voxel| {
                voxel == cell || between_boxes(voxel - cell, spacing) < radius - 1e-9
            });
            prop_assert_eq!(ball.dilate(&body).is_solid(cell), blocked);
        }
    }
}
