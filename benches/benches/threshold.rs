//! Cost of making bone from a scan, all cores: a person drags a slider over it.

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::UVec3;
use palpate_benches::scans::{built_scan, cthead};
use palpate_volume::threshold::threshold;

fn threshold_of_scans(c: &mut Criterion) {
    let mut group = c.benchmark_group("threshold");
    group.sample_size(20);
    group.warm_up_time(Duration::from_millis(300));
    group.measurement_time(Duration::from_secs(2));

    let built = built_scan(UVec3::new(512, 512, 133));
    let cthead = cthead().map(|scan| ("cthead", scan, 1274.0));
    for (name, scan, low) in std::iter::once(("512x512x133", built, 250.0)).chain(cthead) {
        group.throughput(Throughput::Elements(scan.values().len() as u64));
        group.bench_function(name, |b| {
            b.iter(|| black_box(threshold(&scan, None, low, f64::INFINITY).count()));
        });
    }
    group.finish();
}

criterion_group!(benches, threshold_of_scans);
criterion_main!(benches);
