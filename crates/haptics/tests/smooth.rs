//! The smooth contact point: true to the surface, without steps, at rest to the bit.

use crate::support::{Random, SPACINGS, Thresholded, grid, noise};
use glam::{DAffine3, DMat3, DQuat, DVec3, IVec3, UVec3};
use palpate_haptics::contact::{Contact, ContactModel, Exact, Proxy};
use palpate_haptics::scene::{Object, ObjectPose, TouchScene};
use palpate_haptics::smooth::cache::{SmoothCache, Source};
use palpate_haptics::smooth::occupancy_fractions::{Around, Limits};
use palpate_haptics::smooth::{SmoothContact, SmoothInput, SmoothState, Smoother};
use palpate_volume::bits::Bits;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::segment::Segment;
use palpate_volume::threshold::threshold;
use palpate_volume::voxel_box::VoxelBox;

const CENTRE: DVec3 = DVec3::new(45.3, 45.1, 45.2);

/// A grid of some 90 mm.
fn room(spacing: DVec3) -> Grid {
    grid(
        (DVec3::splat(91.0) / spacing).as_uvec3() + UVec3::ONE,
        spacing,
    )
}

/// A body by a rule in mm.
fn body(grid: &Grid, inside: impl Fn(DVec3) -> bool + Sync) -> Segment {
    let spacing = grid.spacing();
    Segment::from_fn(grid.dimensions(), |voxel| {
        inside((voxel.as_dvec3() + 0.5) * spacing)
    })
}

/// A hand on a scene.
struct Hand<'a, O = Bits> {
    scene: TouchScene<'a, O>,
    smoother: Smoother,
    proxy: Proxy,
    state: SmoothState,
    cache: SmoothCache,
    epoch: u64,
    met: Contact,
    /// Whether fractions count, where they are known.
    fractions: bool,
}

impl<'a, O: Occupancy> Hand<'a, O> {
    /// From a free point [mm] on.
    fn at(scene: TouchScene<'a, O>, start: DVec3) -> Self {
        Self {
            scene,
            smoother: Smoother::default(),
            proxy: Proxy::at(start / scene.grid.spacing()).expect("a finite point"),
            state: SmoothState::default(),
            cache: SmoothCache::default(),
            epoch: 1,
            met: Contact::default(),
            fractions: true,
        }
    }

    /// One tick with the device at a point [mm].
    fn tick(&mut self, device: DVec3) -> SmoothContact {
        let device = device / self.scene.grid.spacing();
        self.met = Exact::default().advance(&self.scene, device, &mut self.proxy);
        let source = Source {
            epoch: self.epoch,
            fractions: self.fractions,
        };
        let fields = self.cache.near(&self.scene, source, &self.proxy, device);
        let input = SmoothInput {
            proxy: &self.proxy,
            device_in_grid: device,
            contact: &self.met,
        };
        self.smoother
            .contact_point(&fields, self.scene.grid, &input, &mut self.state)
    }

    fn hard(&self, device: DVec3) -> DVec3 {
        self.proxy.point() * self.scene.grid.spacing() - device
    }
}

/// A place on a surface and outward there [mm].
type Foot = (DVec3, DVec3);

/// What a path was like.
struct Felt {
    mean_angle: f64,
    most_angles: f64,
    /// Root mean square of the error of the depth, as a share.
    depth: f64,
    /// Root mean square of its changes [h].
    ripple: f64,
    /// Largest [h].
    lag: f64,
}

/// Follows foot points with the device some depth [h] under them.
fn follow(grid: &Grid, solid: &Segment, path: &[Foot], depth: f64) -> Felt {
    follow_on(grid, solid.occupancy(), path, depth)
}

fn follow_on(grid: &Grid, solid: &impl Occupancy, path: &[Foot], depth: f64) -> Felt {
    let h = grid.smallest_spacing();
    let scene = TouchScene::of_world(solid, grid);
    let (first, outward) = path[0];
    let mut hand = Hand::at(scene, first + outward * 5.0 * h);
    // come down to the surface and into it
    for way in 0..100 {
        let height = 5.0 - (5.0 + depth) * f64::from(way) / 100.0;
        hand.tick(first + outward * height * h);
    }
    let mut angles = Vec::new();
    let mut depths = Vec::new();
    let mut lag = 0.0_f64;
    for &(foot, outward) in path {
        let device = foot - outward * depth * h;
        let contact = hand.tick(device);
        angles.push(contact.normal.angle_between(outward).to_degrees());
        depths.push(contact.depth_mm / h - depth);
        let off = device + contact.offset - foot;
        lag = lag.max(off.reject_from_normalized(outward).length() / h);
    }
    angles.sort_by(f64::total_cmp);
    let count = depths.len() as f64;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let square: f64 = depths.iter().map(|error| error * error).sum::<f64>() / count;
    Felt {
        mean_angle: mean(&angles),
        most_angles: angles[angles.len() * 95 / 100],
        depth: square.sqrt() / depth,
        ripple: (square - mean(&depths).powi(2)).max(0.0).sqrt(),
        lag,
    }
}

/// Along no axis of the voxels.
fn askew() -> DMat3 {
    DMat3::from_rotation_x(0.6) * DMat3::from_rotation_y(0.4)
}

fn sphere_path(h: f64) -> Vec<Foot> {
    let point = |i: i32| {
        let turn = f64::from(i) * 0.2 * h / 20.0;
        let height = 0.9 * (0.37 * turn).sin();
        let flat = DVec3::new(turn.cos(), turn.sin(), 0.0);
        let outward = askew() * (flat * height.cos() + DVec3::Z * height.sin());
        (CENTRE + outward * 20.0, outward)
    };
    (0..2500).map(point).collect()
}

fn torus_path(h: f64) -> Vec<Foot> {
    let point = |i: i32| {
        let turn = 0.9 * f64::from(i) * 0.2 * h / 33.0;
        let flat = DVec3::new(turn.cos(), turn.sin(), 0.0);
        let outward = flat * (1.7 * turn).cos() + DVec3::Z * (1.7 * turn).sin();
        let foot = CENTRE + askew() * (flat * 24.0 + outward * 9.0);
        (foot, askew() * outward)
    };
    (0..2500).map(point).collect()
}

/// Three quarters of a circle on a plane through the middle.
fn plane_path(turn: DMat3, h: f64) -> Vec<Foot> {
    let point = |i: i32| {
        let angle = f64::from(i) * 0.2 * h / 18.0;
        let flat = DVec3::new(angle.cos(), angle.sin(), 0.0) * 18.0;
        (CENTRE + turn * flat, turn * DVec3::Z)
    };
    (0..500).map(point).collect()
}

fn plane(grid: &Grid, turn: DMat3) -> Segment {
    let outward = turn * DVec3::Z;
    body(grid, |at| outward.dot(at - CENTRE) < 0.0)
}

fn turned(about_x: f64, about_y: f64) -> DMat3 {
    DMat3::from_rotation_x(about_x.to_radians()) * DMat3::from_rotation_y(about_y.to_radians())
}

/// The goals of design, section 8, with the figures that this was built to in their place
/// where they are better.
#[test]
fn the_force_is_true_on_spheres_tori_and_planes_of_cubes_and_of_thick_slices() {
    for (spacing, [mean, most]) in SPACINGS.into_iter().zip([[3.0, 8.0], [6.0, 12.0]]) {
        let grid = room(spacing);
        let h = grid.smallest_spacing();
        let sphere = body(&grid, |at| (at - CENTRE).length() < 20.0);
        let from_scene = askew().transpose();
        let torus = body(&grid, |at| {
            let at = from_scene * (at - CENTRE);
            (at.truncate().length() - 24.0).hypot(at.z) < 9.0
        });
        for (depth, share) in [(2.0, 0.10), (5.0, 0.05)] {
            let check = |name: &str, felt: &Felt, lag: f64| {
                let case = format!("{name}, {spacing} mm, {depth} h deep");
                assert!(felt.mean_angle < mean, "{case}: {}° mean", felt.mean_angle);
                assert!(felt.most_angles < most, "{case}: {}°", felt.most_angles);
                assert!(
                    felt.depth < share,
                    "{case}: magnitude off by {}",
                    felt.depth
                );
                assert!(felt.lag < lag, "{case}: {} h behind", felt.lag);
            };
            check(
                "sphere",
                &follow(&grid, &sphere, &sphere_path(h), depth),
                0.5,
            );
            check("torus", &follow(&grid, &torus, &torus_path(h), depth), 1.5);

            // the steepest stairs of thick slices are longer than any kernel here
            let flattest = if spacing == DVec3::ONE { 10.0 } else { 20.0 };
            for (about_x, about_y) in [(flattest, 0.0), (20.0, 7.0), (0.0, 45.0), (30.0, 15.0)] {
                let turn = turned(about_x, about_y);
                let felt = follow(&grid, &plane(&grid, turn), &plane_path(turn, h), depth);
                check(&format!("plane at {about_x}, {about_y}"), &felt, 0.75);
            }
        }
    }
}

#[test]
fn a_plane_has_no_ripple() {
    let grid = room(DVec3::ONE);
    for (about_x, about_y, ripple) in [
        // along the voxels there is nothing to feel; 1e-6 is single precision
        (0.0, 0.0, 1e-6),
        (10.0, 0.0, 0.05),
        (0.0, 10.0, 0.05),
        (15.0, 5.0, 0.05),
        (30.0, 15.0, 0.05),
    ] {
        let turn = turned(about_x, about_y);
        for depth in [2.0, 5.0] {
            let felt = follow(&grid, &plane(&grid, turn), &plane_path(turn, 1.0), depth);
            let case = format!("{about_x}° and {about_y}°, {depth} deep");
            assert!(felt.ripple < ripple, "{case}: {} h", felt.ripple);
        }
    }
}

/// What is behind a wall is not felt through it, however thin the wall.
#[test]
fn a_shell_feels_as_the_full_ball() {
    for spacing in SPACINGS {
        let grid = room(spacing);
        let ball = body(&grid, |at| (at - CENTRE).length() < 20.0);
        for layers in 1..=3 {
            let shell = shell_of(&grid, &ball, layers);
            assert!(shell.count() < ball.count(), "it is hollow");
            let mut hands = [&ball, &shell].map(|solid| {
                let scene = TouchScene::of_world(solid.occupancy(), &grid);
                Hand::at(scene, CENTRE + DVec3::X * 25.0)
            });
            for &(foot, outward) in sphere_path(grid.smallest_spacing()).iter().take(800) {
                let device = foot - outward * 3.0 * grid.smallest_spacing();
                let [full, hollow] = hands.each_mut().map(|hand| hand.tick(device));
                assert_eq!(full.offset, hollow.offset, "{layers} layers at {foot}");
            }
        }
    }
}

/// The voxels of a body from which a walk of so many steps leads out of it.
fn shell_of(grid: &Grid, ball: &Segment, layers: i32) -> Segment {
    Segment::from_fn(grid.dimensions(), |voxel| {
        let near = VoxelBox::new(voxel - layers, voxel + layers + 1);
        let steps = |to: IVec3| (to - voxel).abs().element_sum();
        let mut around = near.voxels().filter(|&to| steps(to) <= layers);
        ball.contains(voxel) && around.any(|to| !ball.contains(to))
    })
}

/// All that must hold at every tick, wherever the hand goes: no pull into the obstacle, no
/// step, never far from the proxy.
#[test]
fn there_is_no_step_and_no_pull_among_noise_walls_and_steps() {
    for spacing in SPACINGS {
        let grid = grid(UVec3::splat(48), spacing);
        let h = grid.smallest_spacing();
        let scenes = [
            noise(48, 0.02, 1),
            noise(48, 0.4, 2),
            Segment::from_fn(grid.dimensions(), |v| v.x + v.y == 40),
            Segment::from_fn(grid.dimensions(), |v| v.z < 20 + v.x / 9 * 3 || v.y < 7),
            Segment::from_fn(grid.dimensions(), |v| v.x % 8 == 3 && v.y % 8 == 3),
        ];
        let mut random = Random::new(11);
        let [mut smooth, mut ticks, mut clipped] = [0, 0, 0];
        for solid in &scenes {
            let scene = TouchScene::of_world(solid.occupancy(), &grid);
            for _ in 0..8 {
                let start = free_point(&mut random, solid) * spacing;
                let mut hand = Hand::at(scene, start);
                let mut device = start;
                let mut heading = random.direction();
                let mut last = hand.tick(device);
                for tick in 0..600 {
                    heading = (heading + random.direction() * 0.2).normalize();
                    let way = if tick % 100 == 50 { 8.0 } else { 0.3 } * h;
                    let before = device;
                    device = (device + heading * way).clamp(DVec3::ZERO, spacing * 48.0);
                    let contact = hand.tick(device);

                    let hard = hand.hard(device);
                    // 1e-12: the way to the proxy is added up in another order here
                    let pull = contact.offset.dot(hard);
                    assert!(pull >= -1e-12, "a pull of {pull} at {device}");
                    let change = (contact.offset - last.offset).length();
                    let allowed = (device - before).length() + 0.1 * h;
                    // 1e-9: rounding. Only what must not pull is cut off at once, and that is
                    // a fall of the force
                    let push = contact.offset.dot(hard);
                    let cut = push < 1e-6 * contact.depth_mm * hard.length() || push < 1e-9;
                    clipped += i32::from(cut && change > allowed + 1e-9);
                    assert!(cut || change <= allowed + 1e-9, "{change} for {allowed}");

                    let goal = contact.unlimited_in_grid - hand.proxy.point();
                    let cell = if spacing == DVec3::ONE { 2.0 } else { 2.5 };
                    // three voxels of a cube, and more on thick slices; 1e-6 is single precision
                    let reach = 1.5 * cell + 0.4 * (spacing.z - spacing.x);
                    assert!((goal * spacing).length() <= hard.length().max(reach) + 1e-6);
                    last = contact;
                    ticks += 1;
                    smooth += i32::from(contact.weight > 0.5 && hand.met.touching);
                }
            }
        }
        assert!(
            smooth > ticks / 30,
            "hardly ever smooth: {smooth} of {ticks}"
        );
        assert!(
            clipped < ticks / 20,
            "too often cut off: {clipped} of {ticks}"
        );
    }
}

fn free_point(random: &mut Random, solid: &Segment) -> DVec3 {
    loop {
        let point = random.point(0.0, 48.0);
        if !solid.contains(point.as_ivec3()) {
            return point;
        }
    }
}

/// The proxy rests within 16 ticks; then each tick brings a tenth of the smallest spacing.
#[test]
fn at_rest_the_force_is_constant_to_the_bit_within_a_stated_number_of_ticks() {
    let grid = grid(UVec3::splat(48), DVec3::new(0.7, 0.7, 2.5));
    let mut random = Random::new(5);
    for share in [0.1, 0.4] {
        let solid = noise(48, share, 7);
        let scene = TouchScene::of_world(solid.occupancy(), &grid);
        for _ in 0..200 {
            let start = free_point(&mut random, &solid) * grid.spacing();
            let mut hand = Hand::at(scene, start);
            let device = start + random.direction() * random.between(0.0, 6.0);
            let way = (0..16).map(|_| hand.tick(device)).last();
            let left = way.map_or(0.0, |contact| {
                let goal = contact.unlimited_in_grid - contact.point_in_grid;
                (goal * grid.spacing()).length()
            });
            let ticks = (left / (0.1 * grid.smallest_spacing())).ceil() as usize + 1;
            (0..ticks).for_each(|_| {
                hand.tick(device);
            });
            let rest = hand.tick(device);
            for _ in 0..20 {
                assert_eq!(hand.tick(device), rest);
            }
        }
    }
}

#[test]
fn a_cold_cache_gives_the_same_to_the_bit() {
    for spacing in SPACINGS {
        let grid = grid(UVec3::splat(48), spacing);
        let specks = noise(48, 0.02, 3);
        let before = Segment::from_fn(grid.dimensions(), |v| {
            let waves = (v.as_dvec3() * 0.3).map(f64::sin);
            f64::from(v.z) < 24.0 + 3.0 * waves.x * waves.y || specks.contains(v)
        });
        // the same with holes, under another epoch
        let after = Segment::from_fn(grid.dimensions(), |v| {
            before.contains(v) && (v.x + 2 * v.y + 3 * v.z) % 7 != 0
        });
        let mut random = Random::new(17);
        let start = DVec3::new(24.0, 24.0, 29.0) * spacing;
        let scene = TouchScene::of_world(before.occupancy(), &grid);
        let mut warm = Hand::at(scene, start);
        let mut cold = Hand::at(scene, start);
        let mut device = start;
        let mut heading = random.direction();
        let mut touched = 0;
        for tick in 0..4000 {
            if tick % 500 == 499 {
                let odd = tick / 500 % 2 == 0;
                let solid = if odd { &after } else { &before };
                if solid.contains(warm.proxy.voxel()) {
                    continue;
                }
                for hand in [&mut warm, &mut cold] {
                    hand.scene = TouchScene::of_world(solid.occupancy(), &grid);
                    hand.epoch += 1;
                }
            }
            cold.cache = SmoothCache::default();
            heading = (heading + random.direction() * 0.3).normalize();
            device += heading * 0.2;
            // about the surface
            let [low, high] = [DVec3::new(4.0, 4.0, 20.0), DVec3::new(44.0, 44.0, 29.0)];
            device = device.clamp(low * spacing, high * spacing);
            let contact = warm.tick(device);
            assert_eq!(contact, cold.tick(device), "tick {tick}");
            touched += i32::from(contact.weight > 0.0 && warm.met.touching);
        }
        assert!(touched > 400, "touched in {touched} ticks only");
    }
}

/// Light touch begins where the smooth surface is, whatever the stairs of the proxy do.
#[test]
fn a_touch_begins_and_ends_without_a_step() {
    let grid = room(DVec3::ONE);
    let turn = turned(20.0, 7.0);
    let solid = plane(&grid, turn);
    let outward = turn * DVec3::Z;
    let scene = TouchScene::of_world(solid.occupancy(), &grid);
    let mut random = Random::new(23);
    for _ in 0..50 {
        let foot = CENTRE + turn * random.point(-10.0, 10.0).with_z(0.0);
        let mut hand = Hand::at(scene, foot + outward * 4.0);
        let heights = (0..120).map(|i| 4.0 - 0.05 * f64::from(i));
        for height in heights.clone().chain(heights.rev()) {
            let contact = hand.tick(foot + outward * height);
            let true_depth = (-height).max(0.0);
            // as far as a plane of voxels is where it should be: a fifth of one
            assert!((contact.depth_mm - true_depth).abs() < 0.2, "at {height}");
            if height > 0.5 {
                assert_eq!(contact.offset, DVec3::ZERO, "at {height}");
            }
        }
    }
}

#[test]
fn stairs_are_felt_on_request_and_come_without_a_step() {
    let grid = room(DVec3::ONE);
    let turn = turned(25.0, 0.0);
    let solid = plane(&grid, turn);
    let path = plane_path(turn, 1.0);
    let scene = TouchScene::of_world(solid.occupancy(), &grid);
    let mut hand = Hand::at(scene, path[0].0 + path[0].1 * 3.0);
    let mut last: Option<(DVec3, DVec3)> = None;
    let mut differs = 0;
    for (tick, &(foot, outward)) in path.iter().enumerate() {
        let was_enabled = hand.smoother.enabled;
        hand.smoother.enabled = !(150..300).contains(&tick);
        let device = foot - outward * 2.0;
        let contact = hand.tick(device);
        let hard = hand.hard(device);
        if let Some((before, offset)) = last {
            let change = (contact.offset - offset).length();
            let allowed = (device - before).length() + 0.1;
            let switched = was_enabled != hand.smoother.enabled;
            if switched || hand.smoother.enabled {
                assert!(
                    change <= allowed + 1e-9,
                    "a step of {change} in tick {tick}"
                );
            }
        }
        if (200..300).contains(&tick) {
            assert_eq!(contact.offset, hard, "the proxy's own force in tick {tick}");
        }
        differs += i32::from((contact.offset - hard).length() > 0.3);
        last = Some((device, contact.offset));
    }
    assert!(
        differs > 50,
        "smooth and hard differ in {differs} ticks only"
    );
}

#[test]
fn a_rod_too_thin_for_any_blur_is_felt_by_the_proxy() {
    let grid = room(DVec3::ONE);
    let rod = Segment::from_fn(grid.dimensions(), |v| v.x == 45 && v.y == 45);
    let scene = TouchScene::of_world(rod.occupancy(), &grid);
    let mut hand = Hand::at(scene, DVec3::new(45.5, 40.5, 45.5));
    let pressed = (0..45).map(|i| DVec3::new(45.5, 41.0 + 0.1 * f64::from(i), 45.5));
    let contact = pressed.map(|device| (device, hand.tick(device))).last();
    let (device, contact) = contact.expect("it was pressed");
    assert!(hand.met.touching, "the proxy is held");
    assert_eq!(contact.weight, 0.0);
    assert_eq!(contact.offset, hand.hard(device));
}

/// A wall that was moved and turned, on a floor that was not: in the wedge both push.
#[test]
fn in_a_wedge_between_bodies_both_push() {
    for spacing in SPACINGS {
        let grid = room(spacing);
        // both faces stand where voxels end
        let edge = (CENTRE / spacing).floor() * spacing;
        let floor = body(&grid, |at| at.z < edge.z);
        let block = body(&grid, |at| at.x < edge.x);
        let turn = DAffine3::from_translation(edge)
            * DAffine3::from_quat(DQuat::from_rotation_z(0.5) * DQuat::from_rotation_y(0.3))
            * DAffine3::from_translation(-edge);
        let pose = ObjectPose::new(&grid, &grid, turn).expect("a rotation");
        let wall = Object::new(block.occupancy().clone(), &grid, grid.bounds(), pose);
        let outward = [DVec3::Z, turn.transform_vector3(DVec3::X)];
        let objects = [wall];
        let scene = TouchScene {
            occupancy: floor.occupancy(),
            grid: &grid,
            objects: &objects,
        };
        let h = grid.smallest_spacing();
        let along = outward[0].cross(outward[1]).normalize();
        let mut hand = Hand::at(scene, edge + (outward[0] + outward[1]) * 6.0);
        for step in 0..400 {
            // into the wedge, then along it
            let into = (0.05 * f64::from(step)).min(9.0);
            let aside = along * (f64::from(step) - 200.0).max(0.0) * 0.05 * h;
            let device = edge + (outward[0] + outward[1]) * (6.0 - into) + aside;
            let contact = hand.tick(device);
            if step < 260 {
                continue;
            }
            // the point on both planes that is nearest to the device
            let depths = outward.map(|outward| (edge - device).dot(outward));
            let cosine = outward[0].dot(outward[1]);
            let fractions = [
                (depths[0] - cosine * depths[1]) / (1.0 - cosine * cosine),
                (depths[1] - cosine * depths[0]) / (1.0 - cosine * cosine),
            ];
            let way = outward[0] * fractions[0] + outward[1] * fractions[1];
            // slices of 2.5 mm do not tell a slope better
            let allowed = if spacing == DVec3::ONE { 6.0 } else { 12.0 };
            let angle = contact.offset.angle_between(way).to_degrees();
            assert!(angle < allowed, "{angle}° off in step {step}, {spacing} mm");
            let ratio = contact.depth_mm / way.length();
            assert!(
                (ratio - 1.0).abs() < 0.15,
                "{ratio} of the depth in step {step}"
            );
        }
    }
}

#[test]
fn a_device_that_is_no_point_gives_no_force() {
    let grid = room(DVec3::ONE);
    let solid = plane(&grid, DMat3::IDENTITY);
    let scene = TouchScene::of_world(solid.occupancy(), &grid);
    for absurd in [DVec3::NAN, DVec3::INFINITY, DVec3::new(1e300, 0.0, 0.0)] {
        let mut hand = Hand::at(scene, CENTRE + DVec3::Z);
        (0..50).for_each(|_| {
            hand.tick(CENTRE - DVec3::Z);
        });
        let contact = hand.tick(absurd);
        assert_eq!(contact.offset, DVec3::ZERO);
        assert!(contact.point_in_grid.is_finite());
        // and the force comes back without a step
        let contact = hand.tick(CENTRE - DVec3::Z);
        assert!(contact.depth_mm <= 0.1 + 1e-9);
    }
}

/// Where the solid changes so that the proxy stands in it, nothing smooth is made up.
#[test]
fn a_proxy_in_a_solid_voxel_gets_no_smooth_point() {
    let grid = room(DVec3::ONE);
    let full = Segment::from_fn(grid.dimensions(), |_| true);
    let scene = TouchScene::of_world(full.occupancy(), &grid);
    let mut hand = Hand::at(scene, CENTRE);
    assert!(scene.occupancy.is_solid(hand.proxy.voxel()));
    let contact = hand.tick(CENTRE + DVec3::ONE);
    assert_eq!(contact.weight, 0.0);
    assert_eq!(contact.offset, DVec3::ZERO);
}

/// Half way between 0 and 1000.
const THRESHOLD: f64 = 500.0;

/// A scan of half a space, as blurred as scanners do and with noise of some per cent.
fn scan_of_plane(grid: &Grid, turn: DMat3) -> Intensities {
    let spacing = grid.spacing();
    let outward = turn * DVec3::Z;
    // one and a half times the width of a voxel across the surface
    let width = 1.5 * (outward.abs() * spacing).element_sum();
    let mut random = Random::new(31);
    let values: Vec<i16> = VoxelBox::of_dimensions(grid.dimensions())
        .voxels()
        .map(|voxel| {
            let distance = outward.dot((voxel.as_dvec3() + 0.5) * spacing - CENTRE);
            let solid = (0.5 - distance / width).clamp(0.0, 1.0);
            (1000.0 * solid + random.between(-30.0, 30.0)) as i16
        })
        .collect();
    Intensities::new(grid.dimensions(), values, 1.0, 0.0).expect("one value per voxel")
}

/// What bits cannot tell: the stairs of planes that hardly rise.
#[test]
fn intensities_take_the_stairs_from_planes_of_any_slope() {
    for spacing in SPACINGS {
        let grid = room(spacing);
        let h = grid.smallest_spacing();
        for (about_x, about_y) in [
            (2.0, 1.0),
            (5.0, 3.0),
            (0.0, 5.0),
            (10.0, 0.0),
            (30.0, 15.0),
        ] {
            let turn = turned(about_x, about_y);
            let scan = scan_of_plane(&grid, turn);
            let solid = threshold(&scan, None, THRESHOLD, f64::INFINITY);
            let range = (THRESHOLD, f64::INFINITY);
            let known = Thresholded::new(solid.occupancy(), &scan, range);
            let path = plane_path(turn, h);
            let bits = follow(&grid, &solid, &path, 2.0);
            let intensities = follow_on(&grid, &known, &path, 2.0);
            let case = format!("{about_x}° and {about_y}°, {spacing} mm");
            // on slices 0.2 h is 0.14 mm, an 18th of their thickness
            let [ripple, angle, lag] = if spacing == DVec3::ONE {
                [0.05, 1.0, 0.1]
            } else {
                [0.2, 2.0, 0.15]
            };
            assert!(
                intensities.ripple < ripple,
                "{case}: {} h",
                intensities.ripple
            );
            assert!(
                intensities.mean_angle < angle,
                "{case}: {}°",
                intensities.mean_angle
            );
            assert!(intensities.lag < lag, "{case}: {} h", intensities.lag);
            let flat = about_x + about_y < 9.0;
            assert!(
                !flat || intensities.ripple < 0.5 * bits.ripple,
                "{case}: bits alone do as well"
            );
        }
    }
}

/// A scan of 4×4×4 voxels whose values are given along x.
fn rising(values: [i16; 4], slope: f64) -> Intensities {
    let values: Vec<i16> = (0..64).map(|i| values[i % 4]).collect();
    Intensities::new(UVec3::splat(4), values, slope, 0.0).expect("one value per voxel")
}

/// Occupancy fractions along x on these thresholds, of a solid and of a free voxel.
fn fractions(scan: &Intensities, thresholds: &[(f64, f64)]) -> [[Option<f32>; 2]; 4] {
    let limits = Limits::new((scan.slope(), scan.intercept()), thresholds.iter().copied());
    std::array::from_fn(|x| {
        let around = Around::of(scan, IVec3::new(x as i32, 1, 1));
        [true, false].map(|solid| limits.fraction(&around, solid))
    })
}

#[test]
fn a_voxel_tells_its_share_where_its_value_agrees_with_its_bit() {
    // 200 below the limit and 100 above: the way between is met two thirds on, and each of the two
    // voxels has half of what that is from the middle. What was edited by hand counts as its bit says
    let expected = [[None, Some(1.0 / 6.0)], [Some(2.0 / 3.0), None]];
    let above = (300.0, 1e9);
    let close_to_expected = |found: &[[Option<f32>; 2]]| {
        for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
            assert_eq!(found.is_some(), expected.is_some());
            // single precision
            assert!((found.unwrap_or(0.0) - expected.unwrap_or(0.0)).abs() < 1e-6);
        }
    };
    close_to_expected(&fractions(&rising([0, 100, 400, 900], 1.0), &[above])[1..3]);
    // also where the slope is below zero
    let falling = rising([0, 100, 400, 900], -1.0);
    close_to_expected(&fractions(&falling, &[(-1e9, -300.0)])[1..3]);
    // nothing rises where all is the same
    assert_eq!(fractions(&rising([7; 4], 1.0), &[(7.0, 7.0)])[1], [None; 2]);
    // the border of a scan cuts a body as its bits do
    let cut = rising([900, 900, 900, 0], 1.0);
    assert_eq!(fractions(&cut, &[above])[0], [None; 2]);
    let beyond = Around::of(&rising([900; 4], 1.0), IVec3::new(-1, 1, 1));
    assert_eq!(
        Limits::new((1.0, 0.0), [above]).fraction(&beyond, false),
        None
    );
}

/// A surface across a column, at any height: what the column counts is what is solid of it.
#[test]
fn a_column_counts_as_much_as_is_solid_of_it_however_wide_the_scanner_blurs() {
    // voxels over which values fall evenly; largest error of a column's height [voxels]. One voxel
    // are partial volumes, two a straight line through both neighbours, which is met exactly; the
    // blend errs where a neighbour is full but the fall is wider than a voxel
    for (width, most) in [(1.0, 0.03), (1.5, 0.08), (2.0, 1e-3), (3.0, 0.06)] {
        let limits = Limits::new((1.0, 0.0), [(0.0, 1e9)]);
        let mut heights: Vec<f32> = (0..=100)
            .map(|step| {
                let height = f64::from(step) / 100.0 - 0.5;
                let value = |voxel: IVec3| {
                    let above = (f64::from(voxel.z) - height) / width;
                    (-20_000.0 * above.clamp(-0.5, 0.5)) as i16
                };
                let counted = |z: i32| {
                    let voxel = IVec3::new(0, 0, z);
                    let solid = value(voxel) >= 0;
                    let fraction = limits.fraction(&Around::from_fn(voxel, value), solid);
                    fraction.unwrap_or(f32::from(u8::from(solid)))
                };
                (-8..=8).map(counted).sum::<f32>() - 8.5 - height as f32
            })
            .collect();
        heights.sort_by(f32::total_cmp);
        let errors = [heights[0], heights[100]].map(f32::abs);
        assert!(errors[0].max(errors[1]) < most, "{width}: {errors:?}");
    }
}

#[test]
fn segments_of_several_thresholds_have_no_surface_where_they_touch() {
    // soft, a voxel at the border of both, bone
    let scan = rising([100, 299, 301, 900], 1.0);
    let [soft, bone] = [(50.0, 300.0), (300.0, 2000.0)];
    for (thresholds, full) in [
        (vec![soft, bone], true),
        (vec![bone, soft], true),
        // no stored value lies between them
        (vec![(50.0, 300.0), (301.0, 2000.0)], true),
        (vec![bone], false),
    ] {
        let fraction = fractions(&scan, &thresholds)[2][0].expect("bone has bone's value");
        assert_eq!(fraction > 0.9, full, "{thresholds:?}: {fraction}");
    }
    // each of two that are apart has its own limits
    let apart = [(50.0, 150.0), (800.0, 2000.0)];
    let solid = fractions(&scan, &apart).map(|[solid, _]| solid.is_some());
    assert_eq!(solid, [true, false, false, true]);
    // more than can be apart: the lowest count, and the others count as their bits say
    let many: Vec<(f64, f64)> = (0..20)
        .map(|i| (100.0 * f64::from(i), 100.0 * f64::from(i) + 5.0))
        .collect();
    let fractions = fractions(&scan, &many);
    assert!(fractions[0][0].is_some() && fractions[3][0].is_none());
}

/// What was made from bits is not taken for what is made from fractions, whatever the cache holds.
#[test]
fn shares_that_are_switched_leave_nothing_in_the_cache() {
    let grid = room(DVec3::ONE);
    let turn = turned(5.0, 3.0);
    let scan = scan_of_plane(&grid, turn);
    let solid = threshold(&scan, None, THRESHOLD, f64::INFINITY);
    let known = Thresholded::new(solid.occupancy(), &scan, (THRESHOLD, f64::INFINITY));
    let scene = TouchScene::of_world(&known, &grid);
    let path = plane_path(turn, 1.0);
    let mut warm = Hand::at(scene, path[0].0 + path[0].1 * 3.0);
    let mut cold = Hand::at(scene, path[0].0 + path[0].1 * 3.0);
    let mut ways = [Vec::new(), Vec::new()];
    for (tick, (foot, outward)) in path.into_iter().take(600).enumerate() {
        let fractions = tick % 5 < 2;
        cold.cache = SmoothCache::default();
        let device = foot - outward;
        let contact = [&mut warm, &mut cold].map(|hand| {
            hand.fractions = fractions;
            hand.tick(device)
        });
        assert_eq!(contact[0], contact[1], "tick {tick}");
        ways[usize::from(fractions)].push(contact[0].unlimited_in_grid.distance(device));
    }
    let mean = |ways: &[f64]| ways.iter().sum::<f64>() / ways.len() as f64;
    let [bits, fractions] = ways.map(|ways| mean(&ways));
    assert!((bits - fractions).abs() > 1e-3, "{bits} mm, {fractions} mm");
}

/// What is kept of cells is taken for what it was made from, and for nothing else.
#[test]
fn a_cold_cache_gives_the_same_shares_to_the_bit() {
    for spacing in [
        DVec3::ONE,
        DVec3::new(0.7, 0.7, 2.5),
        DVec3::new(1.0, 1.0, 2.0),
    ] {
        let grid = grid(UVec3::splat(48), spacing);
        let mut random = Random::new(29);
        let values: Vec<i16> = VoxelBox::of_dimensions(grid.dimensions())
            .voxels()
            .map(|v| {
                let waves = (v.as_dvec3() * 0.3).map(f64::sin);
                let height = f64::from(v.z) - 24.0 - 3.0 * waves.x * waves.y;
                (500.0 - 200.0 * height.clamp(-2.0, 2.0) + random.between(-60.0, 60.0)) as i16
            })
            .collect();
        let scan = Intensities::new(grid.dimensions(), values, 1.0, 0.0).expect("all values");
        let whole = threshold(&scan, None, THRESHOLD, f64::INFINITY);
        // edited by hand, under another epoch
        let cut = Segment::from_fn(grid.dimensions(), |v| {
            whole.contains(v) && (v.x + 2 * v.y + 3 * v.z) % 7 != 0
        });
        let range = (THRESHOLD, f64::INFINITY);
        let bodies = [&whole, &cut].map(|solid| Thresholded::new(solid.occupancy(), &scan, range));
        let scenes = bodies
            .each_ref()
            .map(|body| TouchScene::of_world(body, &grid));
        let start = DVec3::new(24.0, 24.0, 31.0) * spacing;
        let [mut warm, mut cold] = [(); 2].map(|()| Hand::at(scenes[0], start));
        let (mut device, mut heading) = (start, random.direction());
        let mut touched = 0;
        for tick in 0..3000 {
            if tick % 300 == 299 {
                let scene = scenes[tick / 300 % 2];
                if scene.occupancy.is_solid(warm.proxy.voxel()) {
                    continue;
                }
                for hand in [&mut warm, &mut cold] {
                    hand.scene = scene;
                    hand.epoch += 1;
                }
            }
            cold.cache = SmoothCache::default();
            heading = (heading + random.direction() * 0.3).normalize();
            device += heading * 0.4;
            // about the surface
            let [low, high] = [DVec3::new(4.0, 4.0, 20.0), DVec3::new(44.0, 44.0, 30.0)];
            device = device.clamp(low * spacing, high * spacing);
            let contact = warm.tick(device);
            assert_eq!(contact, cold.tick(device), "tick {tick}, {spacing} mm");
            touched += i32::from(contact.weight > 0.0 && warm.met.touching);
        }
        assert!(touched > 300, "touched in {touched} ticks only");
    }
}
