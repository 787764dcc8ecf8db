//! The smooth force of a ball: on the body's own surface, a radius above it, and safe everywhere.

use crate::support::{Random, SPACINGS, grid, noise, probe_solid};
use glam::{DVec3, IVec3, UVec3};
use palpate_haptics::ball::{ProbeSolid, ball_limits};
use palpate_haptics::contact::{Exact, Proxy};
use palpate_haptics::force::Uniform;
use palpate_haptics::scene::TouchScene;
use palpate_haptics::smooth::Smoothing;
use palpate_haptics::tick::{TickCache, TickInput, TickOutput, TickState, tick};
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::segment::Segment;

/// A ball that is led about; stiffness 1 N/mm, so that forces are ways.
struct Hand<'a> {
    probe: &'a ProbeSolid<Segment>,
    grid: &'a Grid,
    state: TickState,
    cache: TickCache,
}

impl<'a> Hand<'a> {
    /// From a free place [mm] on.
    fn at(probe: &'a ProbeSolid<Segment>, grid: &'a Grid, start: DVec3) -> Self {
        let start = grid.grid_from_patient().transform_point3(start);
        Self {
            probe,
            grid,
            state: TickState::new(Proxy::at(start).expect("a finite point")),
            cache: TickCache::default(),
        }
    }

    fn tick(&mut self, device: DVec3) -> TickOutput {
        let scene = TouchScene::of_world(self.probe, self.grid);
        let input = TickInput {
            device_in_scene: device,
            velocity_in_scene: DVec3::ZERO,
            damping: 0.0,
            smoothing: Smoothing::Bits,
        };
        let model = Exact {
            limits: ball_limits(self.probe.shape()),
        };
        let (state, cache) = (&mut self.state, &mut self.cache);
        tick(&scene, &model, &Uniform::smooth(1.0), &input, state, cache)
    }

    fn hard(&self, device: DVec3) -> DVec3 {
        let proxy = self.state.proxy.point();
        self.grid.patient_from_grid().transform_point3(proxy) - device
    }
}

/// A hand's way along a line 3 h deep, as a ball's middle is led.
struct Line {
    along: DVec3,
    outward: DVec3,
    /// Where its middle would be on the true surface.
    on_surface: DVec3,
}

/// Errors of direction [degrees] and of depth [h] on it, largest of all and mean square.
fn errors(probe: &ProbeSolid<Segment>, grid: &Grid, line: &Line) -> [f64; 2] {
    let h = grid.smallest_spacing();
    let Line {
        along,
        outward,
        on_surface,
    } = *line;
    let at = |way: f64, depth: f64| on_surface + along * way - outward * (depth * h);
    let mut hand = Hand::at(probe, grid, at(-14.0, -6.0));
    for depth in -30..15 {
        hand.tick(at(-14.0, 0.2 * f64::from(depth)));
    }
    let (mut largest, mut square, mut count) = (0.0_f64, 0.0, 0.0);
    for step in 0..(28.0 / (0.2 * h)) as i32 {
        let force = hand.tick(at(0.2 * h * f64::from(step) - 14.0, 3.0)).force;
        if step > 40 {
            largest = largest.max(force.angle_between(outward).to_degrees());
            square += (force.length() / h - 3.0).powi(2);
            count += 1.0;
        }
    }
    [largest, (square / count).sqrt()]
}

/// Half a space of some 60 mm, and a line on it.
fn slope(spacing: DVec3, radius: f64, normal: DVec3) -> (Grid, Line, impl Fn(IVec3) -> bool) {
    let grid = grid((DVec3::splat(60.0) / spacing).as_uvec3(), spacing);
    let middle = DVec3::splat(30.0);
    let outward = normal.normalize();
    let scene_from_grid = grid.patient_from_grid();
    let line = Line {
        along: outward.cross(DVec3::new(0.3, 1.0, 0.2)).normalize(),
        outward,
        on_surface: middle + outward * (radius * grid.smallest_spacing()),
    };
    let is_below = move |voxel: IVec3| {
        let at = scene_from_grid.transform_point3(voxel.as_dvec3() + 0.5);
        (at - middle).dot(outward) < 0.0
    };
    (grid, line, is_below)
}

/// Before, the ball rested on the corners of the stairs: on thick slices its force erred by 40° and
/// by most of its magnitude.
#[test]
fn a_ball_on_a_slope_feels_the_slope_and_not_its_stairs() {
    for spacing in SPACINGS {
        for radius in [1.0, 2.0, 5.0] {
            for normal in [[0.5, 0.2, 1.0], [0.3, 1.0, 0.8], [1.0, 0.4, 0.3]] {
                let normal = DVec3::from_array(normal);
                let (grid, line, is_below) = slope(spacing, radius, normal);
                let solid = Segment::from_fn(grid.dimensions(), is_below);
                let probe = probe_solid(solid, radius, spacing);
                let [angle, depth] = errors(&probe, &grid, &line);
                let case = format!("r {radius} on {normal}, {spacing} mm");
                // half of the goals (design, section 8) at 95 %, for the largest; depth: 5 %
                let most = if spacing == DVec3::ONE { 4.0 } else { 6.0 };
                assert!(angle < most, "{case}: {angle}°");
                assert!(depth < 0.15, "{case}: {depth} h");
            }
        }
    }
}

/// Holes that it cannot get into are not there for a ball.
#[test]
fn a_ball_hardly_feels_holes_that_are_too_narrow_for_it() {
    for spacing in SPACINGS {
        let radius = 5.0;
        let (grid, line, is_below) = slope(spacing, radius, DVec3::new(0.2, 0.1, 1.0));
        let h = grid.smallest_spacing();
        let is_hole = |voxel: IVec3| {
            // every 7 h, 3 h wide, down through all
            let at = ((voxel.as_dvec3() + 0.5) * spacing / h).truncate();
            at.map(|x| x.rem_euclid(7.0)).max_element() < 3.0
        };
        let pierced = |voxel: IVec3| is_below(voxel) && !is_hole(voxel);
        let solid = Segment::from_fn(grid.dimensions(), pierced);
        let [angle, depth] = errors(&probe_solid(solid, radius, spacing), &grid, &line);
        // stairs of 12° and longer than the kernels on thick slices, see the force of a point
        let most = if spacing == DVec3::ONE {
            [4.0, 0.2]
        } else {
            [8.0, 0.5]
        };
        assert!(angle < most[0], "{spacing}: {angle}°");
        assert!(depth < most[1], "{spacing}: {depth} h");
    }
}

/// All that must hold at every tick, wherever the hand goes: no pull into the obstacle, no step,
/// and at rest nothing that moves.
#[test]
fn a_balls_force_has_no_step_and_no_pull_among_noise_walls_and_steps() {
    let [mut touched, mut ticks] = [0, 0];
    for spacing in SPACINGS {
        let grid = grid(UVec3::splat(48), spacing);
        let h = grid.smallest_spacing();
        for (number, radius) in [1.0, 2.0, 5.0, 1.3].into_iter().enumerate() {
            let solid = match number {
                0 => noise(48, 0.02, 1),
                1 => Segment::from_fn(grid.dimensions(), |v| v.x + v.y == 40),
                2 => Segment::from_fn(grid.dimensions(), |v| v.z < 20 + v.x / 9 * 3 || v.y < 7),
                _ => Segment::from_fn(grid.dimensions(), |v| v.x % 8 == 3 && v.y % 8 == 3),
            };
            let probe = probe_solid(solid, radius, spacing);
            let mut random = Random::new(11 + number as u128);
            for _ in 0..8 {
                let start = loop {
                    let point = random.point(0.0, 48.0);
                    if !probe.is_solid(point.floor().as_ivec3()) {
                        break grid.patient_from_grid().transform_point3(point);
                    }
                };
                let mut hand = Hand::at(&probe, &grid, start);
                let (mut device, mut heading) = (start, random.direction());
                let mut last = hand.tick(device).force;
                for number in 0..500 {
                    heading = (heading + random.direction() * 0.2).normalize();
                    let way = heading * if number % 100 == 50 { 8.0 } else { 0.3 } * h;
                    device += way;
                    let output = hand.tick(device);
                    let hard = hand.hard(device);
                    let push = output.force.dot(hard);
                    // 1e-9: rounding. What must not pull is cut off at once: a fall
                    assert!(push >= -1e-9, "a pull of {push} at {device}");
                    let change = (output.force - last).length();
                    let allowed = way.length() + 0.1 * h + 1e-9;
                    let cut = push < 1e-6 * output.depth * hard.length() || push < 1e-9;
                    assert!(cut || change <= allowed, "{change} for {allowed}");
                    last = output.force;
                    ticks += 1;
                    touched += i32::from(output.depth > 0.0);
                }

                // each tick brings a tenth of the smallest spacing, and the proxy rests in 16
                let left = hand.hard(device).length() + last.length();
                let most = 16 + (left / (0.1 * h)).ceil() as usize;
                (0..most).for_each(|_| {
                    hand.tick(device);
                });
                let rest = hand.tick(device);
                for _ in 0..10 {
                    assert_eq!(hand.tick(device), rest, "r {radius}, {spacing}");
                }
            }
        }
    }
    assert!(touched > ticks / 10, "{touched} of {ticks}");
}

/// What is kept of windows and directions changes no result.
#[test]
fn a_ball_with_a_cold_cache_feels_the_same_to_the_bit() {
    let spacing = DVec3::new(0.7, 0.7, 2.5);
    let grid = grid(UVec3::splat(60), spacing);
    let specks = noise(60, 0.01, 3);
    let solid = Segment::from_fn(grid.dimensions(), |v| {
        let waves = (v.as_dvec3() * 0.2).map(f64::sin);
        f64::from(v.z) < 24.0 + 3.0 * waves.x * waves.y || v.z < 30 && specks.contains(v)
    });
    for radius in [1.0, 4.0] {
        let probe = probe_solid(solid.clone(), radius, spacing);
        let start = grid
            .patient_from_grid()
            .transform_point3(DVec3::new(30.0, 30.0, 38.0));
        let [mut warm, mut cold] = [(); 2].map(|()| Hand::at(&probe, &grid, start));
        let mut random = Random::new(17);
        let (mut device, mut heading, mut touched) = (start, random.direction(), 0);
        for number in 0..3000 {
            heading = (heading + random.direction() * 0.3).normalize();
            device += heading * 0.2;
            // about the surface
            let [low, high] = [DVec3::new(10.0, 10.0, 20.0), DVec3::new(50.0, 50.0, 26.0)];
            let in_grid = grid.grid_from_patient().transform_point3(device);
            device = grid
                .patient_from_grid()
                .transform_point3(in_grid.clamp(low, high));
            cold.cache = TickCache::default();
            let output = warm.tick(device);
            assert_eq!(output, cold.tick(device), "tick {number}");
            touched += i32::from(output.contact);
        }
        assert!(touched > 200, "{touched}");
    }
}
