//! How true is the smooth force? The experiment behind `docs/decisions/smooth-force.md`.
//!
//!     cargo run --release -p palpate-haptics --example smooth_force
#![expect(clippy::print_stdout, reason = "a table is what this example is for")]

#[path = "../tests/support/mod.rs"]
mod support;

use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_haptics::contact::ContactModel;
use palpate_haptics::exact::Exact;
use palpate_haptics::proxy::Proxy;
use palpate_haptics::scene::TouchScene;
use palpate_haptics::smooth::cache::SmoothCache;
use palpate_haptics::smooth::{SmoothInput, SmoothState, Smoother};
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;
use std::time::Instant;
use support::grid;

const CENTRE: DVec3 = DVec3::new(60.3, 60.1, 60.2);

type Path = Vec<(DVec3, DVec3)>;

#[derive(Default)]
struct Figures {
    angle: [Vec<f64>; 3],
    depth: [Vec<f64>; 3],
    lag: [Vec<f64>; 3],
    ripple: [f64; 3],
    limited: f64,
    weight: f64,
    samples: f64,
    seconds: f64,
    step: f64,
    far: f64,
}

fn stats(values: &[f64]) -> [f64; 3] {
    let mut v = values.to_vec();
    v.sort_by(f64::total_cmp);
    let n = v.len().max(1);
    [v.iter().sum::<f64>() / n as f64, v[n * 95 / 100], v[n - 1]]
}

fn follow(figures: &mut Figures, body: &Segment, grid: &Grid, path: &Path, depth: f64) {
    let spacing = grid.spacing();
    let h = grid.smallest_spacing();
    let (first, normal) = path[0];
    let mut proxy = Proxy::at((first + normal * 5.0 * h) / spacing).expect("finite");
    let smoother = Smoother::default();
    let mut state = SmoothState::default();
    let mut cache = SmoothCache::default();
    let scene = TouchScene::of_world(body.occupancy(), grid);
    let mut before = DVec3::ZERO;
    let mut depths: [Vec<f64>; 3] = Default::default();
    for (update, &(foot, normal)) in path.iter().enumerate() {
        let device = (foot - normal * depth * h) / spacing;
        let met = Exact::default().advance(&scene, device, &mut proxy);
        let clock = Instant::now();
        let fields = cache.near(&scene, 0, &proxy);
        let input = SmoothInput {
            proxy: &proxy,
            device_in_grid: device,
            contact: &met,
        };
        let contact = smoother.contact_point(&fields, grid, &input, &mut state);
        figures.seconds += clock.elapsed().as_secs_f64();
        let device = device * spacing;
        let points = [
            proxy.point() * spacing,
            contact.unlimited_in_grid * spacing,
            contact.point_in_grid * spacing,
        ];
        if update < 60 {
            before = contact.unlimited_in_grid * spacing - device;
            continue;
        }
        for (i, point) in points.into_iter().enumerate() {
            let force = point - device;
            figures.angle[i].push(force.angle_between(normal).to_degrees());
            figures.depth[i].push((force.length() / (depth * h) - 1.0).powi(2));
            let off = point - foot;
            figures.lag[i].push((off - normal * off.dot(normal)).length() / h);
            depths[i].push(force.length() / h - depth);
        }
        figures.far = figures
            .far
            .max(((points[1] - points[0]) / spacing).length());
        figures.step = figures.step.max((points[1] - device - before).length() / h);
        before = points[1] - device;
        figures.limited += f64::from(u8::from((points[1] - points[2]).length() > 1e-9));
        figures.weight += contact.weight;
        figures.samples += f64::from(contact.samples);
    }
    for i in 0..3 {
        let n = depths[i].len() as f64;
        let mean = depths[i].iter().sum::<f64>() / n;
        let ripple = (depths[i].iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt();
        figures.ripple[i] = figures.ripple[i].max(ripple);
    }
}

fn print(name: &str, figures: &Figures) {
    let n = figures.angle[0].len() as f64;
    for (i, which) in ["hard", "target", "force"].into_iter().enumerate() {
        let [a, b, c] = stats(&figures.angle[i]);
        let rmse = (figures.depth[i].iter().sum::<f64>() / n).sqrt() * 100.0;
        let [l, l95, lm] = stats(&figures.lag[i]);
        let r = figures.ripple[i];
        print!(
            "{name:16} {which:7} {a:5.1} {b:5.1} {c:5.1}°  rmse {rmse:5.1} %  lag {l:4.2} {l95:4.2} {lm:4.2}  ripple {r:5.3}"
        );
        if i == 1 {
            print!(
                "  limited {:5.3} w {:.3} n {:.1} {:.0} ns step {:.2} far {:.2}",
                figures.limited / n,
                figures.weight / n,
                figures.samples / n,
                figures.seconds / n * 1e9,
                figures.step,
                figures.far
            );
        }
        println!();
    }
}

fn body(grid: &Grid, inside: impl Fn(DVec3) -> bool + Sync) -> Segment {
    let spacing = grid.spacing();
    Segment::from_fn(grid.dimensions(), |v: IVec3| {
        inside((v.as_dvec3() + 0.5) * spacing)
    })
}

fn plane(figures: &mut Figures, grid: &Grid, depth: f64, about_x: f64, about_y: f64) {
    let turn =
        DMat3::from_rotation_x(about_x.to_radians()) * DMat3::from_rotation_y(about_y.to_radians());
    let normal = turn * DVec3::Z;
    let step = 0.2 * grid.smallest_spacing();
    let body = body(grid, |at| normal.dot(at - CENTRE) < 0.0);
    let circle = |i: i32| {
        DVec3::new(
            (0.008 * f64::from(i)).sin(),
            -(0.008 * f64::from(i)).cos(),
            0.0,
        )
    };
    let path: Path = (0..1500)
        .map(|i| (CENTRE + turn * circle(i) * step / 0.008, normal))
        .collect();
    follow(figures, &body, grid, &path, depth);
}

fn tilt() -> DMat3 {
    DMat3::from_rotation_x(0.6) * DMat3::from_rotation_y(0.4)
}

fn sphere(figures: &mut Figures, grid: &Grid, depth: f64, radius: f64) {
    let body = body(grid, |at| (at - CENTRE).length() < radius);
    let path: Path = (0..4000)
        .map(|i| {
            let turn = f64::from(i) * 0.2 * grid.smallest_spacing() / radius;
            let height = 0.8 * (0.37 * turn).sin();
            let flat = DVec3::new(turn.cos(), turn.sin(), 0.0);
            let normal = tilt() * (flat * height.cos() + DVec3::Z * height.sin());
            (CENTRE + normal * radius, normal)
        })
        .collect();
    follow(figures, &body, grid, &path, depth);
}

fn torus(figures: &mut Figures, grid: &Grid, depth: f64, big: f64, small: f64) {
    let from_scene = tilt().transpose();
    let body = body(grid, |at| {
        let at = from_scene * (at - CENTRE);
        (at.truncate().length() - big).hypot(at.z) < small
    });
    let path: Path = (0..6000)
        .map(|i| {
            let turn = 0.9 * f64::from(i) * 0.2 * grid.smallest_spacing() / (big + small);
            let flat = DVec3::new(turn.cos(), turn.sin(), 0.0);
            let normal = flat * (1.7 * turn).cos() + DVec3::Z * (1.7 * turn).sin();
            (
                CENTRE + tilt() * (flat * big + normal * small),
                tilt() * normal,
            )
        })
        .collect();
    follow(figures, &body, grid, &path, depth);
}

fn cylinder(figures: &mut Figures, grid: &Grid, depth: f64, radius: f64, sign: f64) {
    let from_scene = tilt().transpose();
    let body = body(grid, |at| {
        let at = from_scene * (at - CENTRE);
        sign * (at.truncate().length() - radius) < 0.0
    });
    let path: Path = (0..3000)
        .map(|i| {
            let way = f64::from(i) * 0.2 * grid.smallest_spacing();
            let turn = 0.95 * way / radius;
            let flat = DVec3::new(turn.cos(), turn.sin(), 0.0);
            (
                CENTRE + tilt() * (flat * radius + DVec3::Z * (10.0 * (0.03 * way).sin())),
                tilt() * flat * sign,
            )
        })
        .collect();
    follow(figures, &body, grid, &path, depth);
}

fn main() {
    for spacing in [DVec3::ONE, DVec3::new(0.7, 0.7, 2.5)] {
        // 20 and 24/9 voxels on cubes, the same mm on thick slices
        let grid = grid(
            (DVec3::splat(121.0) / spacing).as_uvec3() + UVec3::ONE,
            spacing,
        );
        for depth in [2.0, 5.0] {
            println!("\n{spacing} mm, {depth} h deep");
            let mut all = Figures::default();
            for (x, y) in [
                (10, 0),
                (15, 0),
                (20, 7),
                (30, 15),
                (45, 0),
                (45, 20),
                (0, 10),
                (10, 10),
                (25, 0),
                (35, 0),
                (0, 40),
            ] {
                plane(&mut all, &grid, depth, x.into(), y.into());
            }
            print("planes >= 10", &all);
            let mut one = Figures::default();
            plane(&mut one, &grid, depth, 10.0, 0.0);
            print("plane 10", &one);
            let mut low = Figures::default();
            for (x, y) in [(0, 0), (3, 0), (5, 2), (0, 7)] {
                plane(&mut low, &grid, depth, x.into(), y.into());
            }
            print("planes < 10", &low);
            let mut one = Figures::default();
            sphere(&mut one, &grid, depth, 20.0);
            print("sphere 20", &one);
            let mut one = Figures::default();
            torus(&mut one, &grid, depth, 24.0, 9.0);
            print("torus 24/9", &one);
            let mut one = Figures::default();
            cylinder(&mut one, &grid, depth, 12.0, 1.0);
            print("cylinder 12", &one);
            let mut one = Figures::default();
            cylinder(&mut one, &grid, depth, 12.0, -1.0);
            print("bore 12", &one);
        }
    }
}
