//! Whether touch is slower in a larger scan: the same body and path in a small and a large grid.
//!
//! Also single updates at random places with nothing of them in the processor's caches, which
//! is what the first contact after a jump costs.

use std::hint::black_box;
use std::time::Instant;

use glam::DVec3;
use palpate_haptics::contact::{ContactModel, Proxy};

use super::ground::Ground;
use super::stroke::touched_point;
use super::{BenchError, Model, TouchBench, Work};
use crate::random::Random;
use crate::timing::{Timing, quantile};

/// Measurements of each of both, by turns, so that a busy machine slows both.
const ROUNDS: usize = 5;
/// More than the caches of a processor hold [bytes].
const LARGER_THAN_CACHES: usize = 64 << 20;
/// What a cache exchanges at once [bytes].
const CACHE_LINE: usize = 64;

/// How two grids compare.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Embedded {
    /// Calls per second in the small grid, the median of some runs.
    pub small_per_second: f64,
    /// In the large one.
    pub large_per_second: f64,
    /// Fraction of the updates in contact in the large one.
    pub contact_fraction: f64,
    /// Single updates of the hard proxy at random places in the small grid, caches cold.
    pub small_cold: Timing,
    /// In the large one.
    pub large_cold: Timing,
}

/// Times the same work in both grids.
///
/// # Errors
/// Where there is nothing to touch.
pub fn compare(
    [small, large]: [&Ground; 2],
    work: Work,
    [count, cold_count]: [usize; 2],
    seed: u64,
) -> Result<Embedded, BenchError> {
    // a large grid has no values of a scan, so the small one must do without them, too
    let grounds = [small, large].map(Ground::of_bits);
    let [in_small, in_large] = grounds.map(|at| TouchBench::new(&at, 0.0, count, seed));
    let (in_small, mut in_large) = (in_small?, in_large?);
    // the same path to the bit, whatever the rounding of another grid's frame would make of it
    in_large.stroke = in_small.stroke.clone();
    let mut rates = [const { Vec::new() }; 2];
    let mut contact_fraction = 0.0;
    for _ in 0..ROUNDS {
        for (bench, rates) in [&in_small, &in_large].into_iter().zip(&mut rates) {
            let report = bench.run(work, Model::Exact)?;
            rates.push(report.timing.per_second);
            contact_fraction = report.contact_fraction;
        }
    }
    let [small_per_second, large_per_second] = rates.map(|mut rates| {
        rates.sort_by(f64::total_cmp);
        quantile(&rates, 0.5)
    });
    let touches = touches(&in_small, cold_count, seed);
    Ok(Embedded {
        small_per_second,
        large_per_second,
        contact_fraction,
        small_cold: cold_starts(&in_small, &touches),
        large_cold: cold_starts(&in_large, &touches),
    })
}

/// Free points at the surface and solid ones beside them, scene.
fn touches(bench: &TouchBench, count: usize, seed: u64) -> Vec<(DVec3, DVec3)> {
    let mut random = Random::of_stream(seed, 1);
    (0..count)
        .filter_map(|_| touched_point(&bench.grid, &bench.touchable.world, &mut random))
        .map(|touch| (touch.free, touch.solid))
        .collect()
}

fn cold_starts(bench: &TouchBench, touches: &[(DVec3, DVec3)]) -> Timing {
    let scene = bench.touchable.scene(&bench.grid);
    let grid_from_scene = bench.grid.grid_from_patient();
    let mut other = vec![0_u8; LARGER_THAN_CACHES];
    let times = touches
        .iter()
        .filter_map(|(free, solid)| {
            let mut proxy = Proxy::at(grid_from_scene.transform_point3(*free))?;
            let device = grid_from_scene.transform_point3(*solid);
            for line in other.iter_mut().step_by(CACHE_LINE) {
                *line = line.wrapping_add(1);
            }
            black_box(&other);
            let start = Instant::now();
            black_box(bench.exact.advance(&scene, device, &mut proxy));
            Some(start.elapsed().as_nanos() as f64)
        })
        .collect();
    Timing::of_times(times)
}
