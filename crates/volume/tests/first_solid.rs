//! The first solid voxel against brute force, and walls that must not be passed.

use crate::support::Random;
use assert_no_alloc::assert_no_alloc;
use glam::{DVec3, IVec3, UVec3};
use palpate_volume::bits::Bits;
use palpate_volume::first_solid::{Outcome, first_solid, first_solid_bounded};
use palpate_volume::occupancy::Occupancy;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

/// Stops the test program where a traversal allocates.
const DIMENSIONS: UVec3 = UVec3::splat(16);

/// The thinnest digital plane that no face-connected path crosses: 0 <= n·v + d < max |n|.
struct Wall {
    normal: DVec3,
    offset: f64,
}

impl Wall {
    fn height(&self, voxel: IVec3) -> f64 {
        self.normal.dot(voxel.as_dvec3()) + self.offset
    }
}

impl Occupancy for Wall {
    fn is_solid(&self, voxel: IVec3) -> bool {
        (0.0..self.normal.abs().max_element()).contains(&self.height(voxel))
    }
}

/// Sparse noise: about one voxel in 30.
fn noise(seed: u128) -> Segment {
    let mut random = Random::new(seed);
    let mask: Vec<u8> = (0..16 * 16 * 16)
        .map(|_| u8::from(random.chance(0.03)))
        .collect();
    Segment::from_mask(DIMENSIONS, &mask).expect("one byte per voxel")
}

/// Where a move enters a voxel box, by cutting it with all planes; none where it does not.
fn entry(voxel: IVec3, start: DVec3, end: DVec3) -> Option<f64> {
    let delta = end - start;
    let planes = [voxel.as_dvec3(), voxel.as_dvec3() + 1.0].map(|plane| (plane - start) / delta);
    let enter = planes[0].min(planes[1]).max_element().max(0.0);
    let exit = planes[0].max(planes[1]).min_element().min(1.0);
    (enter <= exit).then_some(enter)
}

#[test]
fn the_hit_is_the_nearest_of_all_solid_voxels() {
    let solid = noise(5);
    let all = VoxelBox::of_dimensions(DIMENSIONS).voxels();
    let all: Vec<_> = all.filter(|&voxel| solid.contains(voxel)).collect();
    let mut random = Random::new(6);
    let mut hits = 0;
    for _ in 0..5_000 {
        let (start, end) = (random.point(-2.0, 18.0), random.point(-2.0, 18.0));
        let entries = all.iter().filter_map(|&voxel| entry(voxel, start, end));
        let nearest = entries.min_by(f64::total_cmp);
        let hit = first_solid(&solid, start, end);

        assert_eq!(hit.is_some(), nearest.is_some(), "{start} {end}");
        if let (Some(hit), Some(nearest)) = (hit, nearest) {
            // 1e-12 is rounding
            assert!((hit.fraction - nearest).abs() < 1e-12, "{start} {end}");
            assert!(solid.contains(hit.voxel));
            assert!(hit.starts_inside() || !solid.contains(hit.last_free));
            hits += 1;
        }
    }
    assert!(hits > 1_000, "only {hits} hits: the test is idle");
}

#[test]
fn the_hit_point_lies_on_the_face_it_names() {
    let solid = noise(8);
    let mut random = Random::new(9);
    for _ in 0..5_000 {
        let (start, end) = (random.point(0.0, 16.0), random.point(0.0, 16.0));
        let Some(hit) = first_solid(&solid, start, end).filter(|hit| !hit.starts_inside()) else {
            continue;
        };
        assert_eq!(hit.voxel + hit.face.normal(), hit.last_free);
        let point = start.lerp(end, hit.fraction);
        let centre = hit.voxel.as_dvec3() + 0.5;
        let face = centre[hit.face.axis] + 0.5 * f64::from(hit.face.sign);
        // 1e-12 is rounding
        assert!((point[hit.face.axis] - face).abs() < 1e-12, "{hit:?}");
        assert!(
            (point - centre).abs().max_element() < 0.5 + 1e-12,
            "{hit:?}"
        );
    }
}

/// A move from one side of a wall to the other always meets it (sampling misses 35 %).
#[test]
fn no_move_passes_a_thin_wall_of_any_direction() {
    let mut random = Random::new(7);
    for number in 0..200 {
        let normal = match number % 4 {
            0 => DVec3::new(1.0, 1.0, 0.0),
            1 => DVec3::new(1.0, -1.0, 1.0),
            2 => DVec3::Y,
            _ => random.point(-1.0, 1.0),
        };
        let wall = Wall {
            normal,
            offset: random.number(-3.0, 3.0),
        };
        let mut crossings = 0;
        while crossings < 200 {
            let (start, end) = (random.point(-15.0, 15.0), random.point(-15.0, 15.0));
            let [before, after] = [start, end].map(|p| wall.height(p.floor().as_ivec3()));
            let apart = before < 0.0 && after > 0.0 || before > 0.0 && after < 0.0;
            if !apart || wall.is_solid(start.floor().as_ivec3()) {
                continue;
            }
            crossings += 1;
            assert!(first_solid(&wall, start, end).is_some(), "{start} {end}");
        }
    }
}

#[test]
fn a_move_that_starts_inside_is_hit_at_once() {
    let wall = Wall {
        normal: DVec3::X,
        offset: 0.0,
    };
    let hit = first_solid(&wall, DVec3::splat(0.5), DVec3::splat(7.5)).expect("solid at x = 0");
    assert!(hit.starts_inside());
    assert_eq!((hit.voxel, hit.last_free), (IVec3::ZERO, IVec3::ZERO));
    assert_eq!(hit.fraction, 0.0);
    assert_eq!(hit.face.normal(), IVec3::ZERO);
}

#[test]
fn the_end_point_is_tested_however_short_the_move() {
    let wall = Wall {
        normal: DVec3::X,
        offset: 0.0,
    };
    let at = |x: f64| DVec3::new(x, 0.5, 0.5);
    let hit = first_solid(&wall, at(1.0), at(1.0 - 1e-15)).expect("ends inside");
    assert_eq!((hit.voxel.x, hit.last_free.x, hit.fraction), (0, 1, 0.0));
    assert_eq!(hit.face.normal(), IVec3::X);
    assert!(first_solid(&wall, at(1.5), at(1.0)).is_none());
    assert!(first_solid(&wall, at(-0.5), at(0.0)).is_some());
}

/// Cut into pieces by its bound, a traversal finds the same voxel.
#[test]
fn a_bounded_traversal_stays_in_its_bound_and_can_be_continued() {
    let solid = noise(10);
    let mut random = Random::new(11);
    for _ in 0..2_000 {
        let (start, end) = (random.point(-20.0, 36.0), random.point(-20.0, 36.0));
        let whole = first_solid(&solid, start, end);
        let bound = random.integer(1, 30) as u32;
        let part = first_solid_bounded(&solid, start, end, bound);
        assert!(part.visits >= 1 && part.visits <= bound);
        match part.outcome {
            Outcome::Free => assert_eq!(whole, None),
            Outcome::Hit(hit) => assert_eq!(whole, Some(hit)),
            Outcome::OutOfVisits { voxel, fraction } => {
                assert_eq!(part.visits, bound);
                assert!(!solid.contains(voxel));
                // what was seen is free: the hit, if any, comes no sooner
                assert!(whole.is_none_or(|hit| hit.fraction >= fraction));
                // from inside the last voxel the rest meets the same voxel; a point on its
                // border may be rounded to the other side, 1e-9 keeps clear of that
                let centre = voxel.as_dvec3() + 0.5;
                let from = start.lerp(end, fraction);
                let from = from.clamp(centre - (0.5 - 1e-9), centre + (0.5 - 1e-9));
                let rest = first_solid(&solid, from, end);
                assert_eq!(rest.map(|hit| hit.voxel), whole.map(|hit| hit.voxel));
            }
            Outcome::NotTraversable => panic!("a finite move"),
        }
    }
}

#[test]
fn one_voxel_is_always_visited() {
    let nothing = Bits::empty(DIMENSIONS);
    let part = first_solid_bounded(&nothing, DVec3::splat(0.5), DVec3::splat(5.5), 0);
    assert_eq!(part.visits, 1);
    let expected = Outcome::OutOfVisits {
        voxel: IVec3::ZERO,
        fraction: 0.1,
    };
    assert_eq!(part.outcome, expected);
}

#[test]
fn a_move_that_cannot_be_traversed_says_so_and_is_blocked() {
    let nothing = Bits::empty(DIMENSIONS);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, f64::MIN] {
        let point = DVec3::new(1.0, bad, 1.0);
        for (start, end) in [(point, DVec3::ONE), (DVec3::ONE, point), (point, point)] {
            let part = first_solid_bounded(&nothing, start, end, u32::MAX);
            assert_eq!((part.visits, part.outcome), (0, Outcome::NotTraversable));
            let hit = first_solid(&nothing, start, end).expect("blocked at its start");
            assert!(hit.starts_inside() && hit.fraction == 0.0);
        }
    }
}

#[test]
fn outside_the_grid_nothing_is_solid() {
    let full = Segment::from_fn(DIMENSIONS, |_| true);
    let beside = |x: f64| DVec3::new(x, 16.0, 3.5);
    assert!(first_solid(&full, beside(-5.0), beside(20.0)).is_none());
    let below = |x: f64| DVec3::new(x, -1e-9, 3.5);
    assert!(first_solid(&full, below(-5.0), below(20.0)).is_none());
    assert!(first_solid(&full, DVec3::splat(-3.0), DVec3::splat(20.0)).is_some());
}

#[test]
fn a_traversal_does_not_allocate() {
    let (solid, mut random) = (noise(12), Random::new(13));
    let union = [Some(solid.occupancy()), None];
    let hits = assert_no_alloc(|| {
        let mut moves = (0..1_000).map(|_| (random.point(-9.0, 25.0), random.point(-9.0, 25.0)));
        let found = moves
            .by_ref()
            .map(|(start, end)| first_solid(&union, start, end));
        found.flatten().count()
    });
    assert!(hits > 0);
}

/// Asked voxel by voxel, with nothing looked at together.
struct OneByOne<'a>(&'a Bits);

impl Occupancy for OneByOne<'_> {
    fn is_solid(&self, voxel: IVec3) -> bool {
        self.0.is_solid(voxel)
    }
}

#[test]
fn voxels_that_are_looked_at_together_give_what_they_give_one_by_one() {
    let mut random = Random::new(31);
    let mut together = [0; 3];
    for seed in 0..8 {
        let noise = noise(100 + seed);
        let bits = noise.occupancy();
        for _ in 0..20_000 {
            let start = random.point(-1.0, 17.0);
            let reach = DVec3::splat(6.0);
            let end = random.point(0.0, 12.0) + start - reach;
            let visits = if random.chance(0.3) { 4 } else { u32::MAX };
            let one_by_one = first_solid_bounded(&OneByOne(bits), start, end, visits);
            assert_eq!(
                first_solid_bounded(bits, start, end, visits),
                one_by_one,
                "{start} {end}"
            );
            together[match one_by_one.outcome {
                Outcome::Free => 0,
                Outcome::Hit(_) => 1,
                _ => 2,
            }] += 1;
        }
    }
    assert!(together.iter().all(|count| *count > 5_000), "{together:?}");
}

#[test]
fn a_box_is_free_where_none_of_its_voxels_is_solid() {
    let noise = noise(17);
    let bits = noise.occupancy();
    let mut random = Random::new(18);
    let mut free = 0;
    for _ in 0..20_000 {
        let [a, b] = [(); 2].map(|()| random.point(0.0, 16.0).as_ivec3());
        let (low, high) = (a.min(b), a.max(b).min(a.min(b) + 8));
        let expected = VoxelBox::new(low, high + 1)
            .voxels()
            .all(|voxel| !bits.is_solid(voxel));
        assert_eq!(bits.is_free(low, high), expected, "{low} {high}");
        free += u32::from(expected);
    }
    assert!((1_000..19_000).contains(&free), "{free}");
}
