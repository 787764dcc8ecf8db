//! Do the claims of the thesis hold? Collision tests that always find the wall, probes that
//! pass through nothing, and probes that rest.
//!
//! Three tables. *Misses*: the share of rays through a wall of which no sample falls into it,
//! with samples a step apart. *Crossings*: the share of runs in which a contact model gets to
//! the other side of a wall, by which frame half of those have, and frames that end in a solid
//! voxel. *Jitter*: way of the proxy per frame while the device is at rest, after 100 frames.
//!
//! Walls are digital planes: "thin" ones are the thinnest that no path from face to face crosses
//! (thickness max |n|), "thick" ones the thinnest that no path over edges and corners crosses
//! either (thickness |n₁| + |n₂| + |n₃|). Grids of cubes; lengths in voxels; all random numbers
//! have seeds. `docs/understand/touch.md` shows the figures. Takes some 10 seconds:
//!
//!     cargo run --release -p palpate-haptics --example thesis_claims
//!
//! Source of the claims: R. Vlasov, thesis (2016), 4.2, 4.3, 4.8, 4.16.
#![expect(clippy::print_stdout, reason = "a table is what this example is for")]

#[path = "../tests/support/mod.rs"]
mod support;

use glam::{DVec3, IVec3, UVec3};
use palpate_haptics::contact::{ContactModel, Exact, Proxy};
use palpate_haptics::scene::TouchScene;
use palpate_haptics::thesis::{ThesisImproved, ThesisLimits, ThesisOriginal};
use palpate_volume::first_solid::first_solid;
use palpate_volume::occupancy::Occupancy;
use support::{Body, Random, grid};

const RAYS: u32 = 100_000;
const STEPS: [f64; 3] = [1.0, 0.5, 0.1];
const RUNS: u32 = 400;
const FRAMES: u32 = 150;
const REST_POINTS: u32 = 50;
const LONGEST_WAYS: [f64; 4] = [3.0, 5.0, 7.3, 10.0];

/// How thick a digital plane is.
#[derive(Clone, Copy, PartialEq)]
enum Thickness {
    Thin,
    Thick,
}

/// A digital plane through the origin, and the side of it that voxels are on.
struct Wall {
    normal: DVec3,
    half_thickness: f64,
}

impl Wall {
    fn new(normal: DVec3, thickness: Thickness) -> Self {
        let size = normal.abs();
        let whole = match thickness {
            Thickness::Thin => size.max_element(),
            Thickness::Thick => size.element_sum(),
        };
        Self {
            normal,
            half_thickness: 0.5 * whole,
        }
    }

    /// Below −1 or from 1 on beyond the wall, between them in it.
    fn side(&self, voxel: IVec3) -> f64 {
        self.normal.dot(voxel.as_dvec3()) / self.half_thickness
    }
}

impl Occupancy for Wall {
    fn is_solid(&self, voxel: IVec3) -> bool {
        (-1.0..1.0).contains(&self.side(voxel))
    }
}

/// Which walls, and for rays from where.
#[derive(Clone, Copy)]
enum Walls {
    Fixed(DVec3),
    Random,
}

impl Walls {
    fn normal(self, random: &mut Random) -> DVec3 {
        match self {
            Self::Fixed(normal) => normal,
            Self::Random => random.direction(),
        }
    }
}

const WALLS: [(&str, Walls); 4] = [
    ("(1, 0, 0)", Walls::Fixed(DVec3::X)),
    ("(1, 1, 0)", Walls::Fixed(DVec3::new(1.0, 1.0, 0.0))),
    ("(1, 1, 1)", Walls::Fixed(DVec3::ONE)),
    ("random", Walls::Random),
];

fn main() {
    print_misses();
    print_crossings();
    print_jitter();
}

fn print_misses() {
    println!("misses: share [%] of {RAYS} rays whose samples are all free, by step");
    println!("                               1    0.5    0.1  traversal");
    for thickness in [Thickness::Thin, Thickness::Thick] {
        let cases = WALLS.map(|(name, walls)| (name, walls, true));
        let askew = ("random", Walls::Random, false);
        for (name, walls, head_on) in cases.into_iter().chain([askew]) {
            let (samples, traversal) = misses(walls, thickness, head_on);
            let ray = if head_on { "head-on" } else { "any ray" };
            let [one, half, tenth] = samples;
            println!(
                "{:<6}{name:<10}{ray:<10}{one:6.1} {half:6.1} {tenth:6.1} {traversal:9.1}",
                label(thickness)
            );
            assert!(traversal == 0.0, "the traversal missed a wall");
        }
    }
}

fn label(thickness: Thickness) -> &'static str {
    match thickness {
        Thickness::Thin => "thin",
        Thickness::Thick => "thick",
    }
}

/// Share of rays [%] that samples do not see, per step; and that the traversal does not.
fn misses(walls: Walls, thickness: Thickness, head_on: bool) -> ([f64; 3], f64) {
    let mut random = Random::new(1);
    let mut missed = [0_u32; 3];
    let mut traversal_missed = 0;
    for _ in 0..RAYS {
        // not of length 1: those of digital planes are whole numbers, and stay so
        let normal = walls.normal(&mut random);
        let wall = Wall::new(normal, thickness);
        let normal = normal.normalize();
        let direction = if head_on {
            normal
        } else {
            // as straight lines of all directions and places meet a wall: by the cosine
            (normal + random.direction()).normalize()
        };
        let across = direction.dot(normal);
        // nearly along a wall a ray is in it for long: never missed, and long to walk
        if across < 0.02 {
            continue;
        }
        // from 3 voxels on one side to 3 on the other, any phase of the samples
        let middle = random.point(-50.0, 50.0);
        let middle = middle - normal * middle.dot(normal);
        let half_length = 3.0 / across;
        let start = middle - direction * (half_length + random.between(0.0, 1.0));
        let length = 2.0 * half_length + 1.0;

        let end = start + direction * length;
        traversal_missed += u32::from(first_solid(&wall, start, end).is_none());
        for (missed, step) in missed.iter_mut().zip(STEPS) {
            let samples = (length / step) as u32 + 1;
            let seen = (0..=samples).any(|sample| {
                let point = start + direction * f64::min(f64::from(sample) * step, length);
                wall.is_solid(point.floor().as_ivec3())
            });
            *missed += u32::from(!seen);
        }
    }
    let share = |count: u32| 100.0 * f64::from(count) / f64::from(RAYS);
    (missed.map(share), share(traversal_missed))
}

/// What became of the runs of one model against one kind of wall.
#[derive(Default)]
struct Crossings {
    /// Frame of each run that crossed.
    frames: Vec<u32>,
    inside: u32,
    total: u32,
}

fn print_crossings() {
    println!();
    println!("crossings: share of {RUNS} runs, half of them by frame, frames inside");
    println!("                    exact              thesis-original       thesis-improved");
    for thickness in [Thickness::Thin, Thickness::Thick] {
        for (name, walls) in WALLS {
            let exact = crossings(&Exact::default(), walls, thickness);
            assert!(exact.frames.is_empty() && exact.inside == 0, "exact failed");
            let original = crossings(&ThesisOriginal::default(), walls, thickness);
            let improved = crossings(&ThesisImproved::default(), walls, thickness);
            let texts = [exact, original, improved].map(|crossings| text(&crossings));
            println!("{:<6}{name:<10}{}", label(thickness), texts.join(" "));
        }
    }
}

fn text(crossings: &Crossings) -> String {
    let share = 100.0 * crossings.frames.len() as f64 / f64::from(RUNS);
    let inside = 100.0 * f64::from(crossings.inside) / f64::from(crossings.total);
    let mut frames = crossings.frames.clone();
    frames.sort_unstable();
    let half = frames
        .get(frames.len() / 2)
        .map_or_else(|| "-".to_owned(), u32::to_string);
    format!("{share:5.1} % {half:>3} {inside:5.1} %  ")
}

/// The device goes 0.3 to 1 voxel a frame, to 5 voxels behind the wall and then along it; a run
/// ends when the proxy is on the other side.
fn crossings(model: &impl ContactModel, walls: Walls, thickness: Thickness) -> Crossings {
    let grid = grid(UVec3::splat(64), DVec3::ONE);
    let mut random = Random::new(11);
    let mut crossings = Crossings::default();
    for _ in 0..RUNS {
        let normal = walls.normal(&mut random);
        let wall = Wall::new(normal, thickness);
        let across = normal.normalize();
        let side = across.any_orthonormal_vector();
        let start = across * 4.0 + side * random.between(-9.0, 9.0);
        let heading = (random.direction() * 0.8 - across).normalize();
        let along = heading - across * across.dot(heading);
        let mut device = start;
        let mut proxy = Proxy::at(start).expect("a finite point");
        for frame in 1..=FRAMES {
            let deep = device.dot(across) < -5.0;
            device += if deep { along } else { heading } * random.between(0.3, 1.0);
            let contact = model.advance(&TouchScene::of_world(&wall, &grid), device, &mut proxy);
            crossings.inside += u32::from(contact.violation);
            crossings.total += 1;
            if wall.side(proxy.voxel()) < -1.0 {
                crossings.frames.push(frame);
                break;
            }
        }
    }
    crossings
}

fn print_jitter() {
    println!();
    println!(
        "jitter: way per frame at rest, mean over {REST_POINTS} places of the device (largest)"
    );
    println!("              w_max  exact   thesis-original   thesis-improved");
    let floor = Body(|voxel: IVec3| voxel.z < 10);
    let stair = Body(|voxel: IVec3| voxel.x + voxel.z < 40);
    let under_floor = DVec3::new(30.0, 30.0, 2.0);
    let under_stair = DVec3::new(15.0, 30.0, 15.0);
    print_jitter_on("flat floor", &floor, under_floor);
    print_jitter_on("stair, 45°", &stair, under_stair);
}

fn print_jitter_on(name: &str, solid: &impl Occupancy, device: DVec3) {
    for max_path in LONGEST_WAYS {
        let limits = ThesisLimits {
            max_path,
            ..ThesisLimits::default()
        };
        let exact = jitter(&Exact::default(), solid, device);
        assert_eq!(exact, [0.0; 2], "exact does not rest");
        let original = jitter(&ThesisOriginal { limits }, solid, device);
        let improved = jitter(&ThesisImproved { limits }, solid, device);
        println!(
            "{name:<14}{max_path:5}  {:5.2}   {:5.2} ({:5.2})     {:5.2} ({:5.2})",
            exact[0], original[0], original[1], improved[0], improved[1]
        );
    }
}

/// Way of the proxy per frame once it has had time to rest, mean and largest.
fn jitter(model: &impl ContactModel, solid: &impl Occupancy, near: DVec3) -> [f64; 2] {
    let grid = grid(UVec3::splat(64), DVec3::ONE);
    let mut random = Random::new(5);
    let ways: Vec<f64> = (0..REST_POINTS)
        .map(|_| {
            let device = near + random.point(0.0, 1.0);
            let mut proxy = Proxy::at(DVec3::new(30.2, 30.7, 40.0)).expect("a finite point");
            let mut way = 0.0;
            for frame in 0..300 {
                let before = proxy.point();
                model.advance(&TouchScene::of_world(solid, &grid), device, &mut proxy);
                if frame >= 100 {
                    way += proxy.point().distance(before) / 200.0;
                }
            }
            way
        })
        .collect();
    let largest = ways.iter().copied().fold(0.0, f64::max);
    [ways.iter().sum::<f64>() / f64::from(REST_POINTS), largest]
}
