//! Smoothed spheres keep their area and volume.

mod support;

use std::f64::consts::PI;

use glam::{DVec3, UVec3};
use support::{ball, cubes, settings, surface};

#[test]
#[ignore]
fn explore() {
    for radius in [20.0f64, 5.0, 3.0] {
        let size = (2.0 * radius) as u32 + 8;
        let dimensions = UVec3::splat(size);
        for degree in 0..9 {
            let mut values: [Vec<f64>; 4] = Default::default();
            for i in 0..40 {
                let mut random = oorandom::Rand64::new(i);
                let c = DVec3::splat(size as f64 / 2.0)
                    + DVec3::new(
                        random.rand_float(),
                        random.rand_float(),
                        random.rand_float(),
                    )
                    - 0.5;
                let bits = ball(dimensions, c, radius);
                let s = surface(&cubes(dimensions), &bits, settings(degree));
                let count = palpate_volume::segment::Segment::from_bits(bits).count() as f64;
                let mean: Vec<f64> = s
                    .patches()
                    .flat_map(|(_, p)| {
                        p.vertices
                            .iter()
                            .map(|v| DVec3::from_array(v.map(f64::from)).distance(c) - radius)
                    })
                    .collect();
                values[0].push(100.0 * (s.area() / (4.0 * PI * radius * radius) - 1.0));
                let v = 4.0 / 3.0 * PI * radius.powi(3);
                values[1].push(100.0 * (s.volume() / v - 1.0));
                values[2].push(100.0 * (count / v - 1.0));
                values[3].push(100.0 * mean.iter().sum::<f64>() / mean.len() as f64);
            }
            let told = values.map(|v| {
                let m = v.iter().sum::<f64>() / v.len() as f64;
                let sd = (v.iter().map(|x| (x - m) * (x - m)).sum::<f64>() / v.len() as f64).sqrt();
                let w = v
                    .iter()
                    .fold(0.0f64, |a, b| if b.abs() > a.abs() { *b } else { a });
                format!("{m:.2}±{sd:.2} ({w:.2})")
            });
            println!(
                "r {radius} d {degree}: area {} volume {} count {} radial {}",
                told[0], told[1], told[2], told[3]
            );
        }
    }
}
