//! Lists of neighbours against all pairs, and how often they are built.

use glam::{DVec3, IVec3};
use palpate_deform::particles::lattices::fcc;
use palpate_deform::particles::{NeighbourList, Particles, Space};
use palpate_volume::simd_dispatch::SimdLevel;

fn random_places(count: usize, size: DVec3, seed: u128) -> Vec<DVec3> {
    let mut random = oorandom::Rand64::new(seed);
    let mut place = || {
        size * DVec3::new(
            random.rand_float(),
            random.rand_float(),
            random.rand_float(),
        )
    };
    (0..count).map(|_| place()).collect()
}

/// Every pair nearer than `reach`, by asking for all.
fn all_pairs(places: &[DVec3], reach: f64, space: Space) -> Vec<Vec<usize>> {
    let near = |i: usize, j: usize| i != j && space.nearest(places[j] - places[i]).length() < reach;
    (0..places.len())
        .map(|i| (0..places.len()).filter(|&j| near(i, j)).collect())
        .collect()
}

fn lists(places: &[DVec3], space: Space, simd: SimdLevel) -> Vec<Vec<usize>> {
    let particles = Particles::at_rest(places, 1.0, 1.0);
    let mut list = NeighbourList::new(1.0, 0.25, space).with_simd(simd);
    list.update(&particles.sites);
    let sorted = |i: usize| {
        let mut members: Vec<usize> = list.neighbours(i).collect();
        members.sort_unstable();
        members
    };
    (0..places.len()).map(sorted).collect()
}

#[test]
fn lists_hold_all_pairs_within_reach_and_no_others() {
    // boxes of 2, 4, 5, 7 and 20 cells of half the reach along an axis, and flat and long ones
    let sizes = [
        DVec3::splat(2.6),
        DVec3::splat(3.2),
        DVec3::splat(4.4),
        DVec3::new(12.6, 2.6, 5.0),
        DVec3::new(2.6, 3.9, 9.0),
    ];
    for (seed, size) in sizes.into_iter().enumerate() {
        let places = random_places(300, size, seed as u128);
        for space in [Space::Open, Space::Periodic(size)] {
            let expected = all_pairs(&places, 1.25, space);
            for simd in [SimdLevel::widest(), SimdLevel::Avx2, SimdLevel::Plain] {
                assert!(
                    lists(&places, space, simd) == expected,
                    "{size} {space:?} {simd:?}"
                );
            }
        }
    }
}

#[test]
fn places_outside_a_periodic_box_count_as_inside() {
    let size = DVec3::splat(5.0);
    let inside = random_places(200, size, 9);
    let outside: Vec<_> = inside
        .iter()
        .enumerate()
        .map(|(i, p)| *p + size * f64::from((i % 5) as u8) - size)
        .collect();
    let space = Space::Periodic(size);
    assert!(lists(&outside, space, SimdLevel::widest()) == all_pairs(&inside, 1.25, space));
}

#[test]
fn scattered_and_absurd_places_are_found_without_a_mountain_of_cells() {
    let mut places = random_places(60, DVec3::splat(3.0), 3);
    places.extend([
        DVec3::splat(1e7),
        DVec3::new(1e7, 1e7, 1e7 + 0.5),
        DVec3::new(-4e5, 0.0, 0.0),
    ]);
    assert!(
        lists(&places, Space::Open, SimdLevel::widest()) == all_pairs(&places, 1.25, Space::Open)
    );
    places.extend([DVec3::NAN, DVec3::INFINITY]);
    let expected = all_pairs(&places, 1.25, Space::Open);
    assert!(lists(&places, Space::Open, SimdLevel::widest()) == expected);
    assert!(lists(&[], Space::Open, SimdLevel::widest()).is_empty());
}

#[test]
fn lists_are_built_again_only_when_a_particle_has_moved_half_the_margin() {
    let mut particles = Particles::at_rest(&fcc(IVec3::splat(3), 1.0), 1.0, 1.0);
    let mut list = NeighbourList::new(1.0, 0.2, Space::Open);
    let start = particles.sites[50].position();
    for (moved, builds) in [
        (0.0, 1),
        (0.05, 1),
        (0.099, 1),
        (0.101, 2),
        (0.19, 2),
        (0.202, 3),
    ] {
        particles.sites[50].set_position(start + DVec3::X * moved);
        list.update(&particles.sites);
        assert_eq!(list.builds(), builds, "moved by {moved}");
    }
    particles.sites[50].set_position(DVec3::NAN);
    list.update(&particles.sites);
    assert_eq!(list.builds(), 4, "what is no number asks for new lists");
    particles.give_back(|_, index| index == 50);
    list.update(&particles.sites);
    assert_eq!(
        list.builds(),
        5,
        "another number of particles asks for new lists"
    );
}
