//! Cost of one update of the hard proxy. Budget: 2 M/s while pressing 2 to 5 voxels deep and
//! sliding 0.2 voxel per update (one core), point probe.
//!
//! The path repeats no sample; its share of updates in contact is printed.
#![expect(
    clippy::print_stdout,
    reason = "what was measured stands beside the figure"
)]

use std::f64::consts::FRAC_PI_2;
use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_benches::scans::cthead;
use palpate_haptics::contact::{ContactModel, Exact, Proxy};
use palpate_haptics::scene::TouchScene;
use palpate_volume::bits::Bits;
use palpate_volume::first_solid::first_solid;
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;
use palpate_volume::threshold::threshold;

/// Updates per pass.
const UPDATES: usize = 100_000;
/// Way of the device per update [voxels].
const STEP: f64 = 0.2;

/// What is touched, and where it is touched from outside.
struct Scan {
    name: &'static str,
    grid: Grid,
    segment: Segment,
    centre: DVec3,
}

fn grid(dimensions: UVec3, spacing: DVec3) -> Grid {
    Grid::new(dimensions, spacing, DVec3::ZERO, DMat3::IDENTITY).expect("a grid")
}

/// Bone of CThead; its values are not HU, and its voxels are about 1×1×2 mm.
fn bone() -> Option<Scan> {
    let scan = cthead()?;
    Some(Scan {
        name: "cthead bone > 1350",
        grid: grid(scan.dimensions(), DVec3::new(1.0, 1.0, 2.0)),
        segment: threshold(&scan, None, 1350.0, f64::INFINITY),
        // the crown (slice 1 is the vertex): further down orbits and ears let the probe in
        centre: DVec3::new(120.0, 128.0, 20.0),
    })
}

/// A bumpy ball in 256³.
fn blob() -> Scan {
    let dimensions = UVec3::splat(256);
    let centre = dimensions.as_dvec3() / 2.0;
    let solid = |voxel: IVec3| {
        let offset = voxel.as_dvec3() + 0.5 - centre;
        let waves = (offset * 0.15).to_array().map(f64::sin);
        offset.length() < 90.0 + 2.0 * waves.iter().sum::<f64>()
    };
    Scan {
        name: "blob 256³",
        grid: grid(dimensions, DVec3::ONE),
        segment: Segment::from_fn(dimensions, solid),
        centre,
    }
}

/// Surface point that a ray toward the centre meets first.
fn surface(scan: &Scan, outward: DVec3) -> Option<DVec3> {
    let start = scan.centre + outward * 200.0;
    let hit = first_solid(&scan.segment, start, scan.centre)?;
    Some(start + (scan.centre - start) * hit.fraction)
}

/// Device points to and fro around the scan, between 2 and 5 voxels under its surface,
/// each `STEP` from the one before.
fn touch_path(scan: &Scan) -> Vec<DVec3> {
    let mut path = Vec::with_capacity(UPDATES);
    let mut device: Option<DVec3> = None;
    let mut turn = 0.0_f64;
    while path.len() < UPDATES {
        turn += 0.002;
        let height = 0.06 * (turn * 0.011).sin();
        let depth = 3.5 + 1.5 * (turn * 3.7).sin();
        // the side of the face; behind the head is its holder
        let angle = -FRAC_PI_2 + 1.5 * turn.sin();
        let outward = DVec3::new(angle.cos(), angle.sin(), height).normalize();
        let Some(surface) = surface(scan, outward) else {
            continue;
        };
        let goal = surface - outward * depth;

        // walk there in equal steps; what is left is walked with the next goal
        let mut at = device.unwrap_or(goal);
        while (goal - at).length() >= STEP && path.len() < UPDATES {
            at += (goal - at).normalize() * STEP;
            path.push(at);
        }
        device = Some(at);
    }
    path
}

/// Prints the share of updates in contact, mean depth and slides per update.
fn describe(scan: &Scan, path: &[DVec3], start: Proxy) {
    let scene = TouchScene::of_world(&scan.segment, &scan.grid);
    let mut proxy = start;
    let [mut touching, mut slides, mut depth] = [0.0; 3];
    for &device in path {
        let contact = Exact::default().advance(&scene, device, &mut proxy);
        touching += f64::from(u8::from(contact.touching));
        slides += f64::from(contact.slides);
        depth += ((proxy.point() - device) * scan.grid.spacing()).length();
    }
    let count = path.len() as f64;
    println!(
        "{}: {:.1} % in contact, {:.2} mm deep, {:.2} slides per update",
        scan.name,
        100.0 * touching / count,
        depth / touching,
        slides / count
    );
}

fn hard_proxy(c: &mut Criterion) {
    let mut group = c.benchmark_group("contact");
    group.throughput(Throughput::Elements(UPDATES as u64));
    group.sample_size(20);
    group.warm_up_time(Duration::from_millis(500));
    group.measurement_time(Duration::from_secs(3));
    for scan in [Some(blob()), bone()].into_iter().flatten() {
        let path = touch_path(&scan);
        let outside = scan.centre + (path[0] - scan.centre).normalize() * 150.0;
        let start = Proxy::at(outside).expect("a finite point");
        describe(&scan, &path, start);
        let bits: &Bits = scan.segment.occupancy();
        let scene = TouchScene::of_world(bits, &scan.grid);
        group.bench_function(scan.name, |b| {
            b.iter(|| {
                let mut proxy = start;
                let advance = |&device| Exact::default().advance(&scene, device, &mut proxy);
                black_box(path.iter().map(advance).filter(|c| c.touching).count())
            });
        });
    }
    group.finish();
}

criterion_group!(benches, hard_proxy);
criterion_main!(benches);
