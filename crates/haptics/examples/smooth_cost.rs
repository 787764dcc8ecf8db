#![allow(missing_docs, clippy::print_stdout)]
use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_haptics::proxy::Proxy;
use palpate_haptics::scene::TouchScene;
use palpate_haptics::smooth::cache::SmoothCache;
use palpate_haptics::smooth::field::Field;
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::segment::Segment;
use std::hint::black_box;
use std::time::Instant;
fn main() {
    for spacing in [DVec3::ONE, DVec3::new(0.7, 0.7, 2.5)] {
        let dims = (DVec3::splat(121.0) / spacing).as_uvec3() + UVec3::ONE;
        let grid = Grid::new(dims, spacing, spacing * 0.5, DMat3::IDENTITY).unwrap();
        let c = DVec3::splat(60.0);
        let seg = Segment::from_fn(dims, |v: IVec3| {
            let o = (v.as_dvec3() + 0.5) * spacing - c;
            let waves = (o * 0.15).to_array().map(f64::sin);
            o.length() < 40.0 + 2.0 * waves.iter().sum::<f64>()
        });
        // free surface points
        let mut pts = Vec::new();
        for i in 0..2000 {
            let a = i as f64 * 0.37;
            let b = (i as f64 * 0.113).sin();
            let dir = DVec3::new(
                a.cos() * (1.0 - b * b).sqrt(),
                a.sin() * (1.0 - b * b).sqrt(),
                b,
            );
            let mut r = 55.0;
            loop {
                let p = (c + dir * (r - 0.2)) / spacing;
                if seg.occupancy().is_solid(p.floor().as_ivec3()) {
                    break;
                }
                r -= 0.2;
            }
            pts.push((c + dir * r) / spacing);
        }
        let best = |name: &str, f: &mut dyn FnMut() -> usize| {
            let mut best = f64::INFINITY;
            for _ in 0..15 {
                let t = Instant::now();
                let n = f();
                best = best.min(t.elapsed().as_secs_f64() / n as f64);
            }
            println!("{name}: {:.0} ns", best * 1e9);
        };
        let mut cache = SmoothCache::default();
        let scene = TouchScene::of_world(seg.occupancy(), &grid);
        best("block", &mut || {
            for p in &pts {
                black_box(seg.occupancy().block(p.floor().as_ivec3() - 4));
            }
            pts.len()
        });
        let mut e = 0;
        best("prepare", &mut || {
            for p in &pts {
                e += 1;
                black_box(cache.near(&scene, e, &Proxy::at(*p).unwrap()));
            }
            pts.len()
        });
        let p = pts[7];
        let proxy = Proxy::at(p).unwrap();
        let near = cache.near(&scene, 0, &proxy);
        let field = near.iter().next().unwrap().field;
        best("sample", &mut || {
            let mut q = p;
            for _ in 0..1000 {
                let s = field.sample(q);
                q = p + s.wide.gradient * 1e-9 + s.fine.gradient * 1e-9;
                black_box(s);
            }
            1000
        });
    }
}
