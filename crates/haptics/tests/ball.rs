//! The ball probe: the space of its centres, and what must hold while it moves.

mod support;

use glam::{DVec3, IVec3, UVec3};
use palpate_haptics::admission::{Admission, admit};
use palpate_haptics::ball::{Ball, BallError, BallShape, MAX_REACH};
use palpate_haptics::ball_probe::ProbeSolid;
use palpate_haptics::contact::{Contact, ContactModel};
use palpate_haptics::exact::Exact;
use palpate_haptics::placement::nearest_free;
use palpate_haptics::proxy::Proxy;
use palpate_haptics::scene::TouchScene;
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use support::{Body, Random, SPACINGS, grid, noise};

/// Radii in smallest spacings: touching the next voxels or just not, round ones, large ones.
const RADII: [f64; 9] = [0.0, 0.4, 1.0, 1.2, 2.0, 3.3, 5.0, 8.7, 16.0];

fn hard(radius: f64, spacing: DVec3) -> Ball {
    let shape = BallShape::new(radius * spacing.min_element(), spacing);
    Ball::new(shape.expect("within the window"))
}

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
                let balls = [
                    BallShape::new(radius_mm, spacing),
                    BallShape::soft(radius_mm, spacing),
                ];
                let [hard, soft] = balls.map(|shape| Ball::new(shape.expect("within the window")));
                // touching exactly is free, to within the rounding of such lengths
                let hard_rule = |offset: IVec3| {
                    offset == IVec3::ZERO || between_boxes(offset, spacing) < radius_mm - 1e-9
                };
                let soft_rule =
                    |offset: IVec3| (offset.as_dvec3() * spacing).length() <= radius_mm + 1e-9;
                let rounds = if radius > 6.0 { 4 } else { 40 };
                for _ in 0..rounds {
                    let cell = random.point(-9.0, 34.0).floor().as_ivec3();
                    let expected = [
                        blocked_plainly(&body, cell, hard_rule, MAX_REACH + 1),
                        blocked_plainly(&body, cell, soft_rule, MAX_REACH + 1),
                    ];
                    let [hard, soft] = [&hard, &soft].map(|ball| ball.dilate(&body));
                    assert_eq!([hard.is_solid(cell), soft.is_solid(cell)], expected);
                    found[usize::from(expected[0])] += 1;
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
        let error = BallShape::soft(0.0, spacing).expect_err("no spacing");
        assert!(matches!(error, BallError::NotASpacing { .. }), "{error}");
    }
}

/// Distance [mm] from a point of the grid to the nearest solid voxel within `reach`.
fn distance_to_solid(inner: &impl Occupancy, spacing: DVec3, point: DVec3, reach: i32) -> f64 {
    let around = VoxelBox::of_voxel(point.floor().as_ivec3()).dilate(reach);
    around
        .voxels()
        .filter(|&voxel| inner.is_solid(voxel))
        .map(|voxel| {
            let low = voxel.as_dvec3();
            let outside = (low - point).max(point - (low + 1.0)).max(DVec3::ZERO);
            (outside * spacing).length()
        })
        .fold(f64::INFINITY, f64::min)
}

fn advance(occupancy: &impl Occupancy, grid: &Grid, device: DVec3, proxy: &mut Proxy) -> Contact {
    let scene = TouchScene::of_world(occupancy, grid);
    let contact = Exact::default().advance(&scene, device, proxy);
    assert!(!contact.violation && !occupancy.is_solid(proxy.voxel()));
    contact
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
            let probe = ProbeSolid::new(body, Some(hard(radius, spacing)));
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
    let shape = probe.ball().expect("a ball").shape();
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
    let ball = ProbeSolid::new(body, Some(hard(2.0, DVec3::ONE)));
    assert_eq!(ball.solid_near(IVec3::new(3, 0, 0)), None);
    assert_eq!(ball.solid_near(IVec3::new(2, 1, 0)), Some(IVec3::ZERO));
    let point = ProbeSolid::new(Body(|v: IVec3| v == IVec3::ZERO), None);
    assert_eq!(point.solid_near(IVec3::X), None);
    assert_eq!(point.solid_near(IVec3::ZERO), Some(IVec3::ZERO));
}

/// The same moves and edits with a ball that remembers, and with one that forgets all before
/// every single update, give the same to the bit.
#[test]
fn what_is_kept_never_changes_an_answer() {
    for spacing in SPACINGS {
        let grid = grid(UVec3::splat(96), spacing);
        let body = || noise(96, 0.002, 7);
        let mut warm = ProbeSolid::new(body(), Some(hard(2.0, spacing)));
        let mut random = Random::new(11);
        let mut device = DVec3::splat(48.0);
        let start = nearest_free(&warm, &grid, device, 12).expect("free");
        let [mut warm_proxy, mut cold_proxy] = [start; 2];
        for update in 0..20_000 {
            let length = 50.0 * random.between(0.0, 1.0).powi(4);
            device += random.direction() * length;
            device = device.clamp(DVec3::splat(-8.0), DVec3::splat(104.0));
            let cold = ProbeSolid::new(warm.inner(), Some(hard(2.0, spacing)));
            let answers = [
                advance(&warm, &grid, device, &mut warm_proxy),
                advance(&cold, &grid, device, &mut cold_proxy),
            ];
            assert_eq!(answers[0], answers[1]);
            assert_eq!(warm_proxy, cold_proxy);
            if update % 50 == 0 {
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
fn an_edit_is_felt_at_the_next_update() {
    let spacing = DVec3::ONE;
    let grid = grid(UVec3::splat(64), spacing);
    let floor = |hole: bool| {
        Segment::from_fn(UVec3::splat(64), move |v| {
            let in_hole = (v - 32).truncate().abs().max_element() <= 5;
            v.z < 30 && !(hole && in_hole && v.z >= 20)
        })
    };
    let changed = VoxelBox::new(IVec3::new(27, 27, 20), IVec3::new(38, 38, 30));
    let mut probe = ProbeSolid::new(floor(false), Some(hard(2.0, spacing)));
    let mut proxy = Proxy::at(DVec3::new(32.5, 32.5, 40.0)).expect("finite");
    let device = DVec3::new(32.5, 32.5, 21.0);
    assert!(advance(&probe, &grid, device, &mut proxy).touching);
    assert_eq!(proxy.voxel().z, 32);

    // the hole is cleared: at once the ball falls to its floor
    probe.change(&changed, |voxels| *voxels = floor(true));
    advance(&probe, &grid, device, &mut proxy);
    assert_eq!(proxy.voxel().z, 22);

    // it is filled again: the ball is in the way, and is pushed no further than 7 voxels
    let filled = floor(false);
    let new_ball = hard(2.0, spacing);
    let admission = admit(&probe, &new_ball.dilate(&filled), &grid, &mut proxy);
    assert_eq!(admission, Admission::Held);

    // out of the hole it is in nobody's way
    advance(&probe, &grid, device.with_z(31.0), &mut proxy);
    let admission = admit(&probe, &new_ball.dilate(&filled), &grid, &mut proxy);
    let voxel = IVec3::new(32, 32, 32);
    assert_eq!(admission, Admission::Pushed { voxel });
    probe.change(&changed, |voxels| *voxels = filled);
    advance(&probe, &grid, device, &mut proxy);
    assert_eq!(proxy.voxel().z, 32);
}

#[test]
fn a_radius_is_raised_only_as_far_as_there_is_room() {
    let grid = grid(UVec3::splat(64), DVec3::ONE);
    // a floor, then a gap between two plates
    let floor = Body(|v: IVec3| v.z < 20);
    let gap = Body(|v: IVec3| v.z < 20 || v.z >= 31);
    let mut proxy = Proxy::at(DVec3::splat(20.5)).expect("finite");
    let voxel = IVec3::new(20, 20, 25);
    let balls = [2.0, 5.0, 6.0].map(|radius| hard(radius, DVec3::ONE));
    let [small, fitting, large] = &balls;
    let raised = admit(&floor, &fitting.dilate(&floor), &grid, &mut proxy);
    assert_eq!(raised, Admission::Pushed { voxel });

    let [small, large] = [small, large].map(|ball| Ball::new(*ball.shape()));
    let raised = admit(&small.dilate(&gap), &large.dilate(&gap), &grid, &mut proxy);
    assert_eq!((raised, proxy.voxel()), (Admission::Held, voxel));
}

#[test]
fn at_rest_the_ball_stays_to_the_bit() {
    let mut random = Random::new(31);
    for spacing in SPACINGS {
        let grid = grid(UVec3::splat(40), spacing);
        let probe = ProbeSolid::new(noise(40, 0.01, 3), Some(hard(1.2, spacing)));
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
        let probe = ProbeSolid::new(channel, Some(hard(radius, DVec3::ONE)));
        let middle = 30.0 + 0.5 * f64::from(width);
        let mut proxy = Proxy::at(DVec3::new(middle, middle, 50.0)).expect("finite");
        for _ in 0..10 {
            advance(&probe, &grid, DVec3::new(middle, middle, 10.0), &mut proxy);
        }
        assert_eq!(proxy.point().z < 15.0, passes, "{radius} {width}");
    }
}
