//! Which rule of sliding? The experiment behind `docs/decisions/sliding.md`.
//!
//! Rules differ in the distance that has to fall (from the device to the centre of a voxel,
//! or to its box) and in the window that is searched for a nearer voxel. Each follows a
//! device that moves 0.2 voxel per update under planes, a sphere and a torus, and then
//! rests; and each is pressed beside a hole of one voxel in a plate. Lengths are in parts
//! of the smallest spacing h. Takes some 20 seconds:
//!
//!     cargo run --release -p palpate-haptics --example sliding
#![expect(clippy::print_stdout, reason = "a table is what this example is for")]

#[path = "../tests/support/mod.rs"]
mod support;

use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_haptics::contact::{ContactModel, Exact, Proxy};
use palpate_haptics::scene::TouchScene;
use palpate_volume::first_solid::first_solid;
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::voxel_box::VoxelBox;
use support::{Body, SPACINGS, grid};

/// The distance that a slide has to lower.
#[derive(Clone, Copy)]
enum Measure {
    ToCentre,
    ToBox,
}

/// How a proxy that is stopped slides on.
#[derive(Clone, Copy)]
enum Rule {
    /// Written out plainly here: a window of so many voxels away from the device and toward
    /// it, and, where `between`, never more than `behind` past the voxels between the two.
    Plain {
        measure: Measure,
        behind: i32,
        toward: i32,
        between: bool,
    },
    /// The contact model of this crate.
    Exact,
}

const fn plain(measure: Measure, behind: i32, toward: i32, between: bool) -> Rule {
    Rule::Plain {
        measure,
        behind,
        toward,
        between,
    }
}

const RULES: [(&str, Rule); 6] = [
    ("centre, 3³", plain(Measure::ToCentre, 1, 1, false)),
    ("box, 3³", plain(Measure::ToBox, 1, 1, false)),
    ("centre, 7³", plain(Measure::ToCentre, 3, 3, false)),
    ("box, 7³", plain(Measure::ToBox, 3, 3, false)),
    ("centre, 2 + 5", plain(Measure::ToCentre, 2, 5, true)),
    ("exact: box, 2 + 5", Rule::Exact),
];

impl Rule {
    fn advance(&self, body: &impl Occupancy, grid: &Grid, device: DVec3, proxy: &mut Proxy) {
        let Self::Plain { .. } = self else {
            Exact::default().advance(&TouchScene::of_world(body, grid), device, proxy);
            return;
        };
        for _ in 0..9 {
            let Some(hit) = first_solid(body, proxy.point(), device) else {
                *proxy = Proxy::at(device).expect("a finite point");
                return;
            };
            *proxy = Proxy::nearest_in(hit.last_free, device);
            let Some(voxel) = self.slide(body, grid, device, proxy.voxel()) else {
                return;
            };
            *proxy = Proxy::nearest_in(voxel, device);
        }
    }

    /// The nearest voxel of the window that is reached face to face, if it is nearer.
    fn slide(
        &self,
        body: &impl Occupancy,
        grid: &Grid,
        device: DVec3,
        from: IVec3,
    ) -> Option<IVec3> {
        let Self::Plain { measure, .. } = *self else {
            return None;
        };
        let distance = |voxel: IVec3| {
            let low = voxel.as_dvec3();
            let offset = match measure {
                Measure::ToCentre => low + 0.5 - device,
                Measure::ToBox => (low - device).max(device - (low + 1.0)).max(DVec3::ZERO),
            };
            (offset * grid.spacing()).length()
        };
        let mut best = (distance(from) - 1e-6 * grid.smallest_spacing(), None);
        let window = self.window(from, device);
        let mut seen = vec![from];
        let mut next = 0;
        while let Some(&voxel) = seen.get(next) {
            next += 1;
            if distance(voxel) < best.0 {
                best = (distance(voxel), Some(voxel));
            }
            for face in IVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]) {
                let voxel = voxel + face;
                if window.contains(voxel) && !body.is_solid(voxel) && !seen.contains(&voxel) {
                    seen.push(voxel);
                }
            }
        }
        best.1
    }

    fn window(&self, from: IVec3, device: DVec3) -> VoxelBox {
        let Self::Plain {
            behind,
            toward,
            between,
            ..
        } = *self
        else {
            return VoxelBox::EMPTY;
        };
        let goal = device.floor().as_ivec3();
        let [behind, toward] = [IVec3::splat(behind), IVec3::splat(toward)];
        let down = goal.cmplt(from);
        let below = IVec3::select(down, toward, behind);
        let above = IVec3::select(down, behind, toward);
        let window = VoxelBox::new(from - below, from + above + 1);
        let corridor = VoxelBox::new(from.min(goal) - behind, from.max(goal) + behind + 1);
        if between {
            window.intersect(&corridor)
        } else {
            window
        }
    }
}

/// Foot points on the surface with their normals [mm], 0.2 h from one to the next.
type Path = Vec<(DVec3, DVec3)>;

/// What is measured along paths.
#[derive(Default)]
struct Figures {
    /// Of the proxy behind the foot point, sideways.
    lags: Vec<f64>,
    /// Longest way of the foot point while the proxy stood still.
    held: f64,
    /// Motion per tick from the 16th tick after the device came to rest.
    jitter: f64,
}

impl Figures {
    fn follow(
        &mut self,
        rule: Rule,
        body: &impl Occupancy,
        spacing: DVec3,
        path: &Path,
        depth: f64,
    ) {
        let grid = grid(UVec3::splat(128), spacing);
        let h = grid.smallest_spacing();
        let (first, normal) = path[0];
        let mut proxy = Proxy::at((first + normal * 5.0 * h) / spacing).expect("a finite point");
        let device = |(foot, normal): (DVec3, DVec3)| (foot - normal * depth * h) / spacing;
        let mut stood_since = first;
        for (update, &(foot, normal)) in path.iter().enumerate() {
            let before = proxy.voxel();
            rule.advance(body, &grid, device((foot, normal)), &mut proxy);
            assert!(!body.is_solid(proxy.voxel()));
            if proxy.voxel() != before || update < 50 {
                stood_since = foot;
            }
            self.held = self.held.max((foot - stood_since).length() / h);
            if update >= 50 {
                let off = proxy.point() * spacing - foot;
                self.lags
                    .push((off - normal * off.dot(normal)).length() / h);
            }
        }
        for tick in 0..50 {
            let before = proxy.point();
            rule.advance(body, &grid, device(path[path.len() - 1]), &mut proxy);
            if tick >= 16 {
                let moved = ((proxy.point() - before) * spacing).length() / h;
                self.jitter = self.jitter.max(moved);
            }
        }
    }

    /// Mean, 95 % and largest lag.
    fn lag(&mut self) -> [f64; 3] {
        self.lags.sort_by(f64::total_cmp);
        let count = self.lags.len();
        let mean = self.lags.iter().sum::<f64>() / count as f64;
        [mean, self.lags[count * 95 / 100], self.lags[count - 1]]
    }
}

const CENTRE: DVec3 = DVec3::new(60.3, 60.1, 60.2);

fn planes(rule: Rule, spacing: DVec3, depth: f64) -> Figures {
    let mut figures = Figures::default();
    let slopes = [
        (0, 0),
        (5, 0),
        (10, 3),
        (20, 7),
        (30, 15),
        (45, 0),
        (45, 20),
        (0, 10),
    ];
    for (about_x, about_y) in slopes {
        let turn = DMat3::from_rotation_x(f64::to_radians(about_x.into()))
            * DMat3::from_rotation_y(f64::to_radians(about_y.into()));
        let normal = turn * DVec3::Z;
        let body = Body(move |v: IVec3| normal.dot((v.as_dvec3() + 0.5) * spacing - CENTRE) < 0.0);
        let step = 0.2 * spacing.min_element();
        let circle = |i: i32| {
            DVec3::new(
                (0.004 * f64::from(i)).sin(),
                -(0.004 * f64::from(i)).cos(),
                0.0,
            )
        };
        let path = (0..2000).map(|i| (CENTRE + turn * circle(i) * step / 0.004, normal));
        figures.follow(rule, &body, spacing, &path.collect(), depth);
    }
    figures
}

fn tilt() -> DMat3 {
    DMat3::from_rotation_x(0.6) * DMat3::from_rotation_y(0.4)
}

fn sphere(rule: Rule, spacing: DVec3, depth: f64) -> Figures {
    let body = Body(move |v: IVec3| ((v.as_dvec3() + 0.5) * spacing - CENTRE).length() < 20.0);
    let path = (0..4000).map(|i| {
        let turn = f64::from(i) * 0.2 * spacing.min_element() / 20.0;
        let height = 0.8 * (0.37 * turn).sin();
        let flat = DVec3::new(turn.cos(), turn.sin(), 0.0);
        let normal = tilt() * (flat * height.cos() + DVec3::Z * height.sin());
        (CENTRE + normal * 20.0, normal)
    });
    let mut figures = Figures::default();
    figures.follow(rule, &body, spacing, &path.collect(), depth);
    figures
}

fn torus(rule: Rule, spacing: DVec3, depth: f64) -> Figures {
    let from_scene = tilt().transpose();
    let body = Body(move |v: IVec3| {
        let at = from_scene * ((v.as_dvec3() + 0.5) * spacing - CENTRE);
        (at.truncate().length() - 24.0).hypot(at.z) < 9.0
    });
    let path = (0..6000).map(|i| {
        let turn = 0.9 * f64::from(i) * 0.2 * spacing.min_element() / 33.0;
        let flat = DVec3::new(turn.cos(), turn.sin(), 0.0);
        let normal = flat * (1.7 * turn).cos() + DVec3::Z * (1.7 * turn).sin();
        (
            CENTRE + tilt() * (flat * 24.0 + normal * 9.0),
            tilt() * normal,
        )
    });
    let mut figures = Figures::default();
    figures.follow(rule, &body, spacing, &path.collect(), depth);
    figures
}

/// Share of pressings beside a hole of one voxel that end behind the plate.
fn slips(rule: Rule, beside: f64, depth: f64) -> f64 {
    let plate = Body(|v: IVec3| v.z == 30 && v.truncate() != glam::IVec2::splat(30));
    let grid = grid(UVec3::splat(64), DVec3::ONE);
    let slipped = (0..200).filter(|&i| {
        let angle = 0.01 + f64::from(i) * 0.0314;
        let around = DVec3::new(angle.cos(), angle.sin(), 0.0) * (0.5 + beside);
        let above = DVec3::new(30.5, 30.5, 33.0) + around;
        let mut proxy = Proxy::at(above).expect("a finite point");
        for tick in 0..100 {
            let way = (0.1 * f64::from(tick)).min(2.0 + depth);
            rule.advance(&plate, &grid, above - DVec3::Z * way, &mut proxy);
        }
        proxy.point().z < 30.0
    });
    slipped.count() as f64 / 200.0
}

/// Follows one body's path: spacing [mm], depth [h].
type Follow = fn(Rule, DVec3, f64) -> Figures;

fn main() {
    let bodies: [(&str, Follow); 3] = [("planes", planes), ("sphere", sphere), ("torus", torus)];
    let mut largest_lag = [0.0_f64; RULES.len()];
    for spacing in SPACINGS {
        for depth in [2.0, 5.0] {
            println!("\n{spacing} mm, {depth} h deep: lag mean, 95 %, max; held; jitter [h]");
            for (index, (name, rule)) in RULES.into_iter().enumerate() {
                print!("{name:18}");
                for (body, measure) in bodies {
                    let mut figures = measure(rule, spacing, depth);
                    let [mean, most, max] = figures.lag();
                    let Figures { held, jitter, .. } = figures;
                    largest_lag[index] = largest_lag[index].max(max);
                    print!(" | {body} {mean:5.2} {most:5.2} {max:5.2}; {held:4.1}; {jitter:.2}");
                    assert!(jitter == 0.0, "{name} moves at rest");
                }
                println!();
            }
        }
    }
    println!("\nshare that slips through a hole 0.5, 1.5, 2.5, 3.5 voxels beside, 3 h deep");
    for (name, rule) in RULES {
        let shares = [0.5, 1.5, 2.5, 3.5].map(|beside| slips(rule, beside, 3.0));
        println!("{name:18} {shares:.2?}");
    }

    // what the decision rests on
    let [.., exact] = largest_lag;
    assert!(exact < 7.0, "exact falls {exact} h behind");
    assert!(largest_lag[1] > 3.0 * exact, "steps alone would do");
}
