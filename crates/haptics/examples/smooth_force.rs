//! How true is the smooth force? The experiment behind `docs/decisions/smooth-force.md`.
//!
//! A device moves 0.2 h per update under planes, a sphere, a torus, a cylinder and in a bore,
//! 2 and 5 h deep, on cubes and on thick slices. For the hard proxy and for the smooth contact
//! point: angle to the true normal, mean, 95 % and largest; error of the depth; how far the
//! point is behind the foot point, mean, 95 % and largest; ripple of the depth on the worst
//! path. Lengths are in parts of the smallest spacing h. Takes some 20 seconds:
//!
//!     cargo run --release -p palpate-haptics --example smooth_force
#![expect(clippy::print_stdout, reason = "a table is what this example is for")]

#[path = "../tests/support/mod.rs"]
mod support;

use glam::{DMat3, DVec3, UVec3};
use palpate_haptics::contact::{ContactModel, Exact, Proxy};
use palpate_haptics::scene::TouchScene;
use palpate_haptics::smooth::cache::{SmoothCache, Source};
use palpate_haptics::smooth::{SmoothInput, SmoothState, Smoother};
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;
use support::{SPACINGS, grid};

const CENTRE: DVec3 = DVec3::new(60.3, 60.1, 60.2);

/// Foot points on the surface with their normals [mm], 0.2 h from one to the next.
type Path = Vec<(DVec3, DVec3)>;

/// What is measured of one point.
#[derive(Default)]
struct Figures {
    angles: Vec<f64>,
    lags: Vec<f64>,
    /// Of the depth, as a share, squared.
    errors: Vec<f64>,
    ripple: f64,
}

impl Figures {
    fn print(mut self, body: &str, point: &str) {
        let [angle, angle_95, angle_max] = spread(&mut self.angles);
        let [lag, lag_95, lag_max] = spread(&mut self.lags);
        let error = 100.0 * mean(&self.errors).sqrt();
        println!(
            "{body:14} {point:7} {angle:5.1} {angle_95:5.1} {angle_max:5.1}° | depth {error:5.1} % | \
             lag {lag:4.2} {lag_95:4.2} {lag_max:4.2} | ripple {:5.3}",
            self.ripple
        );
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Mean, 95 % and largest.
fn spread(values: &mut [f64]) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    let count = values.len();
    [mean(values), values[count * 95 / 100], values[count - 1]]
}

/// Follows paths on bodies; figures of the hard proxy and of the smooth point.
fn follow(strokes: &[(Segment, Path)], grid: &Grid, depth: f64) -> [Figures; 2] {
    let mut figures = [Figures::default(), Figures::default()];
    let (spacing, h) = (grid.spacing(), grid.smallest_spacing());
    for (body, path) in strokes {
        let scene = TouchScene::of_world(body.occupancy(), grid);
        let (first, normal) = path[0];
        let mut proxy = Proxy::at((first + normal * 5.0 * h) / spacing).expect("a finite point");
        let mut state = SmoothState::default();
        let mut cache = SmoothCache::default();
        let mut depths = [Vec::new(), Vec::new()];
        for (update, &(foot, normal)) in path.iter().enumerate() {
            let device = foot - normal * depth * h;
            let in_grid = device / spacing;
            let met = Exact::default().advance(&scene, in_grid, &mut proxy);
            let fields = cache.near(
                &scene,
                Source {
                    epoch: 0,
                    fractions: false,
                },
                &proxy,
                in_grid,
            );
            let input = SmoothInput {
                proxy: &proxy,
                device_in_grid: in_grid,
                contact: &met,
            };
            let smooth = Smoother::default().contact_point(&fields, grid, &input, &mut state);
            if update < 60 {
                continue;
            }
            let hard = proxy.point() * spacing - device;
            for (kind, way) in [hard, smooth.offset].into_iter().enumerate() {
                let off = device + way - foot;
                let lag = off.reject_from_normalized(normal).length() / h;
                let deep = way.length() / h;
                depths[kind].push(deep);
                let figures = &mut figures[kind];
                figures.angles.push(way.angle_between(normal).to_degrees());
                figures.lags.push(lag);
                figures.errors.push((deep / depth - 1.0).powi(2));
            }
        }
        for (figures, depths) in figures.iter_mut().zip(depths) {
            let middle = mean(&depths);
            let squares: Vec<f64> = depths.iter().map(|deep| (deep - middle).powi(2)).collect();
            figures.ripple = figures.ripple.max(mean(&squares).sqrt());
        }
    }
    figures
}

fn body(grid: &Grid, inside: impl Fn(DVec3) -> bool + Sync) -> Segment {
    let spacing = grid.spacing();
    Segment::from_fn(grid.dimensions(), |voxel| {
        inside((voxel.as_dvec3() + 0.5) * spacing)
    })
}

fn planes(grid: &Grid, slopes: &[(f64, f64)]) -> Vec<(Segment, Path)> {
    let step = 0.2 * grid.smallest_spacing();
    let plane = |&(about_x, about_y): &(f64, f64)| {
        let turn = DMat3::from_rotation_x(about_x.to_radians())
            * DMat3::from_rotation_y(about_y.to_radians());
        let normal = turn * DVec3::Z;
        let circle = |i: i32| {
            let angle = 0.008 * f64::from(i);
            DVec3::new(angle.sin(), -angle.cos(), 0.0)
        };
        let path = (0..1500).map(|i| (CENTRE + turn * circle(i) * step / 0.008, normal));
        let solid = body(grid, |at| normal.dot(at - CENTRE) < 0.0);
        (solid, path.collect())
    };
    slopes.iter().map(plane).collect()
}

/// Along no axis of the voxels.
fn askew() -> DMat3 {
    DMat3::from_rotation_x(0.6) * DMat3::from_rotation_y(0.4)
}

fn sphere(grid: &Grid) -> Vec<(Segment, Path)> {
    let path = (0..4000).map(|i| {
        let turn = f64::from(i) * 0.2 * grid.smallest_spacing() / 20.0;
        let height = 0.8 * (0.37 * turn).sin();
        let flat = DVec3::new(turn.cos(), turn.sin(), 0.0);
        let normal = askew() * (flat * height.cos() + DVec3::Z * height.sin());
        (CENTRE + normal * 20.0, normal)
    });
    let solid = body(grid, |at| (at - CENTRE).length() < 20.0);
    vec![(solid, path.collect())]
}

fn torus(grid: &Grid) -> Vec<(Segment, Path)> {
    let path = (0..6000).map(|i| {
        let turn = 0.9 * f64::from(i) * 0.2 * grid.smallest_spacing() / 33.0;
        let flat = DVec3::new(turn.cos(), turn.sin(), 0.0);
        let normal = flat * (1.7 * turn).cos() + DVec3::Z * (1.7 * turn).sin();
        (
            CENTRE + askew() * (flat * 24.0 + normal * 9.0),
            askew() * normal,
        )
    });
    let from_scene = askew().transpose();
    let solid = body(grid, |at| {
        let at = from_scene * (at - CENTRE);
        (at.truncate().length() - 24.0).hypot(at.z) < 9.0
    });
    vec![(solid, path.collect())]
}

/// Solid inside (`side` 1) or outside (−1) of a radius of 12 mm.
fn cylinder(grid: &Grid, side: f64) -> Vec<(Segment, Path)> {
    let path = (0..3000).map(|i| {
        let way = f64::from(i) * 0.2 * grid.smallest_spacing();
        let turn = 0.95 * way / 12.0;
        let flat = DVec3::new(turn.cos(), turn.sin(), 0.0);
        let along = DVec3::Z * 10.0 * (0.03 * way).sin();
        (
            CENTRE + askew() * (flat * 12.0 + along),
            askew() * flat * side,
        )
    });
    let from_scene = askew().transpose();
    let solid = body(grid, |at| {
        let at = from_scene * (at - CENTRE);
        side * (at.truncate().length() - 12.0) < 0.0
    });
    vec![(solid, path.collect())]
}

/// From 10 degrees on, and below.
const STEEP: [(f64, f64); 11] = [
    (10.0, 0.0),
    (15.0, 0.0),
    (20.0, 7.0),
    (30.0, 15.0),
    (45.0, 0.0),
    (45.0, 20.0),
    (0.0, 10.0),
    (10.0, 10.0),
    (25.0, 0.0),
    (35.0, 0.0),
    (0.0, 40.0),
];
const FLAT: [(f64, f64); 4] = [(0.0, 0.0), (3.0, 0.0), (5.0, 2.0), (0.0, 7.0)];

fn main() {
    for (spacing, [angle, angle_95]) in SPACINGS.into_iter().zip([[3.0, 8.0], [6.0, 12.0]]) {
        let dimensions = (DVec3::splat(121.0) / spacing).as_uvec3() + UVec3::ONE;
        let grid = grid(dimensions, spacing);
        let bodies = [
            ("planes >= 10°", planes(&grid, &STEEP)),
            ("planes < 10°", planes(&grid, &FLAT)),
            ("sphere", sphere(&grid)),
            ("torus", torus(&grid)),
            ("cylinder", cylinder(&grid, 1.0)),
            ("bore", cylinder(&grid, -1.0)),
        ];
        for depth in [2.0, 5.0] {
            println!("\n{spacing} mm, {depth} h deep");
            for (name, strokes) in &bodies {
                let [hard, mut smooth] = follow(strokes, &grid, depth);
                hard.print(name, "hard");

                // what the decision rests on
                let [mean, most, _] = spread(&mut smooth.angles);
                let flat = name.contains('<');
                assert!(flat || mean < angle, "{name}: {mean}°");
                assert!(flat || most < angle_95, "{name}: {most}°");
                smooth.print("", "smooth");
            }
        }
    }
}
