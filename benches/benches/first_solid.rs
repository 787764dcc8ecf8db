//! Cost of one collision test. Budget: 15 M/s for free moves of 4 voxels near bone.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use palpate_benches::moves::moves_near_surface;
use palpate_benches::scans::bone;
use palpate_volume::first_solid::{first_solid, first_solid_bounded};

/// Moves per case: some 400 KB, which the second-level cache holds.
const MOVES: usize = 8192;

fn first_solid_near_bone(c: &mut Criterion) {
    let (scan, segment) = bone();
    let bone = segment.occupancy();
    let mut group = c.benchmark_group(format!("first_solid/{scan}"));
    group.throughput(Throughput::Elements(MOVES as u64));
    group.warm_up_time(Duration::from_millis(300));
    group.measurement_time(Duration::from_millis(700));

    for (case, hit) in [("free", false), ("hit", true)] {
        for length in [1.0, 4.0, 10.0, 50.0] {
            // the same moves for every run, made before the clock starts
            let moves = moves_near_surface(&segment, length, MOVES, hit);
            group.bench_with_input(BenchmarkId::new(case, length), &moves, |b, moves| {
                b.iter(|| {
                    let met = moves
                        .iter()
                        .filter(|m| first_solid(bone, m.start, m.end).is_some());
                    black_box(met.count())
                });
            });
        }
    }

    // what haptics calls: a bound, and a union of two segments
    let moves = moves_near_surface(&segment, 4.0, MOVES, false);
    let union = [bone, bone];
    group.bench_function("free, union of two/4", |b| {
        b.iter(|| {
            let visits = moves
                .iter()
                .map(|m| first_solid_bounded(&union, m.start, m.end, 4096).visits);
            black_box(visits.sum::<u32>())
        });
    });
    group.finish();
}

criterion_group!(benches, first_solid_near_bone);
criterion_main!(benches);
