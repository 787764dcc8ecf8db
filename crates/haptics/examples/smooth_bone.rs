//! The smooth contact point on real bone: what it costs, and how much less the force turns.
//!
//! A device presses on the bone of CThead and slides over it, 0.2 voxel an update. The data
//! folder is `PALPATE_DATA`, by default `shared/data` beside the project.
//!
//!     cargo run --release -p palpate-haptics --example smooth_bone
//!
//! With `once` and `bits` or `intensities` it only makes one pass of complete ticks, for tools
//! that count instructions:
//!
//!     valgrind --tool=callgrind --toggle-collect='*complete_ticks*' .../smooth_bone once bits
#![expect(clippy::print_stdout, reason = "a table is what this example is for")]

#[path = "../tests/support/mod.rs"]
mod support;

use glam::{DMat3, DVec3, UVec3};
use palpate_haptics::contact::{ContactModel, Exact, Proxy};
use palpate_haptics::force::{ForceLimits, Safety, Surface, Uniform};
use palpate_haptics::scene::TouchScene;
use palpate_haptics::smooth::cache::{SmoothCache, Source};
use palpate_haptics::smooth::{SmoothInput, SmoothState, Smoother, Smoothing};
use palpate_haptics::tick::{TickCache, TickInput, TickState, tick};
use palpate_volume::first_solid::first_solid;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::threshold::threshold;
use std::hint::black_box;
use std::path::PathBuf;
use std::time::Instant;
use support::{Random, Thresholded};

const DIMENSIONS: UVec3 = UVec3::new(256, 256, 113);
const SPACING: DVec3 = DVec3::new(1.0, 1.0, 2.0);
/// Bone in CThead, whose values are not HU.
const BONE: f64 = 1350.0;
const UPDATES: usize = 20_000;
const STEP: f64 = 0.2;

fn cthead() -> Option<Intensities> {
    let folder = std::env::var_os("PALPATE_DATA").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data")),
        PathBuf::from,
    );
    let mut values = Vec::new();
    for slice in 1..=DIMENSIONS.z {
        let path = folder.join(format!("cthead_stanford/raw/CThead.{slice}"));
        let bytes = std::fs::read(path).ok()?;
        let pairs = bytes.chunks_exact(2);
        values.extend(pairs.map(|pair| i16::from_be_bytes([pair[0], pair[1]])));
    }
    Intensities::new(DIMENSIONS, values, 1.0, 0.0).ok()
}

/// A hand that keeps a depth and turns slowly at random: device points, in the grid.
fn stroke(
    scene: &TouchScene<'_, Thresholded<'_>>,
    depth: f64,
    random: &mut Random,
) -> (Proxy, Vec<DVec3>) {
    let spacing = scene.grid.spacing();
    let middle = DIMENSIONS.as_dvec3() / 2.0;
    let (start, hit) = loop {
        let start = middle + random.direction() * 300.0;
        let goal = middle + random.point(-40.0, 40.0);
        if let Some(hit) = first_solid(scene.occupancy, start, goal) {
            break (start, hit);
        }
    };
    let first = Proxy::nearest_in(hit.last_free, start);
    let mut proxy = first;
    let mut device = (hit.voxel.as_dvec3() + 0.5) * spacing;
    let mut heading = random.direction();
    let mut back = device;
    let mut path = Vec::with_capacity(UPDATES);
    for _ in 0..UPDATES {
        let met = Exact::default().advance(scene, device / spacing, &mut proxy);
        path.push(device / spacing);
        let out = proxy.point() * spacing - device;
        let direction = if met.touching && out.length() > 1e-6 {
            let outward = out.normalize();
            back = device;
            heading = (heading + random.direction() * 0.05)
                .reject_from_normalized(outward)
                .normalize_or(outward.any_orthonormal_vector());
            let too_deep = (out.length() / depth - 1.0).clamp(-1.0, 1.0);
            (heading + outward * (0.5 * too_deep)).normalize()
        } else {
            heading = random.direction();
            (back - device).normalize_or(heading)
        };
        device += direction * STEP;
    }
    (first, path)
}

/// The first of some strokes that is in contact nearly always and gets somewhere.
fn stroke_in_contact(
    scene: &TouchScene<'_, Thresholded<'_>>,
    depth: f64,
    random: &mut Random,
) -> (Proxy, Vec<DVec3>) {
    loop {
        let (first, path) = stroke(scene, depth, random);
        let mut proxy = first;
        let touching = path.iter().filter(|device| {
            let met = Exact::default().advance(scene, **device, &mut proxy);
            met.touching
        });
        let touches = touching.count() as f64 > 0.95 * UPDATES as f64;
        let way = path[0].distance(path[UPDATES - 1]);
        if touches && way > 20.0 {
            return (first, path);
        }
    }
}

/// Seconds per update: the best of some passes for each thousand updates, so that a busy
/// machine hardly counts; a pass is given the number of each update.
fn time<F: FnMut(usize)>(mut pass: impl FnMut() -> F) -> f64 {
    const CHUNK: usize = 1000;
    let mut best = [f64::INFINITY; UPDATES / CHUNK];
    for _ in 0..12 {
        let mut update = pass();
        for (chunk, best) in best.iter_mut().enumerate() {
            let clock = Instant::now();
            (0..CHUNK).for_each(|number| update(chunk * CHUNK + number));
            *best = best.min(clock.elapsed().as_secs_f64());
        }
    }
    best.iter().sum::<f64>() / UPDATES as f64
}

/// Bone, dry.
const ROUGH: Uniform = Uniform(Surface {
    stiffness: 1.0,
    friction_static: 0.3,
    friction_kinetic: 0.2,
});

/// Complete ticks, one for each update: friction, contact model, smooth point, safety stage.
fn complete_ticks<'a>(
    scene: &'a TouchScene<'a, Thresholded<'a>>,
    first: Proxy,
    path: &'a [DVec3],
    smoothing: Smoothing,
) -> impl FnMut(usize) + 'a {
    let mut state = TickState::new(first);
    let mut cache = TickCache::default();
    let mut safety = Safety::new(ForceLimits::default());
    move |update: usize| {
        let input = TickInput {
            device_in_scene: path[update] * SPACING,
            velocity_in_scene: DVec3::ZERO,
            damping: 0.0,
            smoothing,
        };
        let model = Exact::default();
        let output = tick(scene, &model, &ROUGH, &input, &mut state, &mut cache);
        black_box(safety.limit(output.force, 1e-3));
    }
}

fn quantiles(mut values: Vec<f64>) -> [f64; 4] {
    values.sort_by(f64::total_cmp);
    let at = |share: f64| values[((values.len() - 1) as f64 * share) as usize];
    [at(0.5), at(0.95), at(0.999), at(1.0)]
}

fn main() {
    let Some(scan) = cthead() else {
        println!("no CThead in the data folder");
        return;
    };
    let bone = threshold(&scan, None, BONE, f64::INFINITY);
    let grid = Grid::new(DIMENSIONS, SPACING, SPACING * 0.5, DMat3::IDENTITY).expect("valid");
    let bone = Thresholded::new(bone.occupancy(), &scan, (BONE, f64::INFINITY));
    let scene = TouchScene::of_world(&bone, &grid);
    let mut random = Random::new(3);
    for depth in [1.5, 3.0] {
        let (first, path) = stroke_in_contact(&scene, depth, &mut random);
        let is_asked = |name: &str| std::env::args().any(|argument| argument == name);
        if is_asked("once") {
            let smoothing = match is_asked("intensities") {
                true => Smoothing::Intensities,
                false => Smoothing::Bits,
            };
            (0..UPDATES).for_each(complete_ticks(&scene, first, &path, smoothing));
            continue;
        }
        let ticks = Smoothing::ALL
            .map(|smoothing| time(|| complete_ticks(&scene, first, &path, smoothing)));
        let hard = time(|| {
            let (mut proxy, scene, path) = (first, &scene, &path);
            move |update: usize| {
                black_box(Exact::default().advance(scene, path[update], &mut proxy));
            }
        });
        let tick =
            |cache: &mut SmoothCache, proxy: &mut Proxy, device, state: &mut _, fractions| {
                let met = Exact::default().advance(&scene, device, proxy);
                let fields = cache.near(
                    &scene,
                    Source {
                        epoch: 1,
                        fractions,
                    },
                    proxy,
                    device,
                );
                let input = SmoothInput {
                    proxy,
                    device_in_grid: device,
                    contact: &met,
                };
                let contact = Smoother::default().contact_point(&fields, &grid, &input, state);
                (met, contact)
            };
        let [bits, intensities] = [false, true].map(|fractions| {
            time(|| {
                let (mut proxy, mut state) = (first, SmoothState::default());
                let mut cache = SmoothCache::default();
                let path = &path;
                move |update: usize| {
                    black_box(tick(
                        &mut cache,
                        &mut proxy,
                        path[update],
                        &mut state,
                        fractions,
                    ));
                }
            })
        });

        println!(
            "\n{depth} mm deep: hard proxy {:.0} ns, with the smooth point {:.0} ns, by intensities {:.0} ns",
            hard * 1e9,
            bits * 1e9,
            intensities * 1e9,
        );
        println!(
            "complete tick without smoothing, by bits, by intensities {:.0?} ns",
            ticks.map(|seconds| seconds * 1e9)
        );
        for (name, fractions) in [("bits", false), ("intensities", true)] {
            let mut cache = SmoothCache::default();
            let (mut proxy, mut state) = (first, SmoothState::default());
            let mut before = [DVec3::ZERO; 2];
            let mut beyond = 0;
            let mut last_device = path[0];
            let mut turns = [Vec::new(), Vec::new()];
            let mut changes = [Vec::new(), Vec::new()];
            let mut times = Vec::new();
            let [mut limited, mut touching, mut weight, mut samples] = [0.0; 4];
            for device in &path {
                let clock = Instant::now();
                let (met, contact) = tick(&mut cache, &mut proxy, *device, &mut state, fractions);
                times.push(clock.elapsed().as_secs_f64() * 1e6);
                let hard = (proxy.point() - *device) * SPACING;
                let now = [hard, contact.offset];
                for kind in 0..2 {
                    let [a, b] = [before[kind], now[kind]];
                    if a.length() > 0.2 && b.length() > 0.2 {
                        turns[kind].push(a.angle_between(b).to_degrees());
                    }
                    changes[kind].push((a - b).length());
                }
                let allowed =
                    ((*device - last_device) * SPACING).length() + 0.1 * grid.smallest_spacing();
                beyond += u32::from((now[1] - before[1]).length() > allowed + 1e-9);
                last_device = *device;
                before = now;
                touching += f64::from(u8::from(met.touching));
                weight += contact.weight;
                samples += f64::from(contact.samples);
                limited += f64::from(u8::from(
                    (contact.unlimited_in_grid - contact.point_in_grid).length() > 1e-9,
                ));
            }
            let share = |sum: f64| sum / UPDATES as f64;
            println!(
                "by {name}: in contact {:.3}, weight {:.3}, limited {:.3}, steps {beyond}, {:.1} samples; \
                 single ticks, median, 95 %, 99.9 %, max {:.2?} µs",
                share(touching),
                share(weight),
                share(limited),
                share(samples),
                quantiles(times)
            );
            for (name, turns, changes) in [
                ("hard", &turns[0], &changes[0]),
                (name, &turns[1], &changes[1]),
            ] {
                println!(
                    "{name:11} turn per update, median, 95 %, 99.9 %, max {:.2?}°; change of the way {:.2?} mm",
                    quantiles(turns.clone()),
                    quantiles(changes.clone())
                );
            }
        }
    }
}
