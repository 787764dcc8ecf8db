//! Unions of segments.

use std::cell::Cell;
use std::sync::Arc;

use crate::support::Random;
use glam::{DVec3, IVec3, UVec3};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::first_solid::{Outcome, Traversal};
use palpate_volume::occupancy::Occupancy;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

const DIMENSIONS: UVec3 = UVec3::new(12, 10, 9);

#[test]
fn a_union_is_solid_where_any_part_is() {
    let mut random = Random::new(111);
    let parts = [(); 3].map(|()| {
        Segment::from_mask(DIMENSIONS, &random.mask(DIMENSIONS)).expect("one byte per voxel")
    });
    let slots = parts.clone().map(|part| Some(part.occupancy().clone()));
    for voxel in VoxelBox::of_dimensions(DIMENSIONS).dilate(2).voxels() {
        let any = parts.iter().any(|part| part.contains(voxel));
        assert_eq!(parts.is_solid(voxel), any);
        assert_eq!(parts[..].is_solid(voxel), any);
        assert_eq!(parts.to_vec().is_solid(voxel), any);
        assert_eq!(parts.each_ref().is_solid(voxel), any);
        assert_eq!(slots.is_solid(voxel), any);
        assert_eq!(Arc::new(&parts).is_solid(voxel), any);
        assert_eq!(Box::new(&parts).is_solid(voxel), any);
    }
}

#[test]
fn vacant_places_and_empty_unions_are_free() {
    let none: [Option<Segment>; 2] = [None, None];
    for voxel in VoxelBox::of_dimensions(DIMENSIONS).voxels() {
        assert!(!none.is_solid(voxel));
        assert!(!<[Segment; 0]>::default().is_solid(voxel));
    }
}

/// A probe with a radius, whose answers are none of those that `Occupancy` has by default.
struct Probe {
    solid: bool,
    prepared: Cell<bool>,
}

impl Probe {
    const RADIUS: f64 = 1.5;

    fn new(solid: bool) -> Self {
        let prepared = Cell::new(false);
        Self { solid, prepared }
    }

    fn brick(&self, plane: usize) -> BitBrick {
        let mut brick = BitBrick::EMPTY;
        brick.0[plane] = if self.solid { 1 } else { 0 };
        brick
    }
}

impl Occupancy for Probe {
    fn is_solid(&self, voxel: IVec3) -> bool {
        self.solid && voxel == IVec3::ZERO
    }

    fn first_solid(&self, _start: DVec3, _end: DVec3, max_visits: u32) -> Traversal {
        Traversal {
            outcome: Outcome::Free,
            visits: max_visits + 7,
        }
    }

    fn block(&self, _min: IVec3) -> BitBrick {
        self.brick(1)
    }

    fn smooth_block(&self, _min: IVec3) -> BitBrick {
        self.brick(0)
    }

    fn prepare_smooth_brick(&self, _min: IVec3) -> bool {
        !self.prepared.replace(true)
    }

    fn probe_radius_mm(&self) -> f64 {
        Self::RADIUS
    }

    fn knows_fractions(&self) -> bool {
        true
    }

    fn occupancy_fraction(&self, _voxel: IVec3, solid: bool) -> Option<f32> {
        Some(if solid { 0.75 } else { 0.25 })
    }

    fn fraction_changes(&self, _voxels: &[(IVec3, bool)], changes: &mut [f32]) {
        changes.fill(0.125);
    }
}

/// All answers of a wrapped probe are its own; `whole` ones may not even answer a part in another
/// way, as a union of one may.
fn check_wrapped(wrapped: &impl Occupancy, whole: bool) {
    let probe = Probe::new(true);
    assert_eq!(wrapped.is_solid(IVec3::ZERO), probe.is_solid(IVec3::ZERO));
    assert_eq!(wrapped.block(IVec3::ZERO), probe.block(IVec3::ZERO));
    let smooth = wrapped.smooth_block(IVec3::ZERO);
    assert_eq!(smooth, probe.smooth_block(IVec3::ZERO));
    assert!(
        wrapped.prepare_smooth_brick(IVec3::ZERO) && !wrapped.prepare_smooth_brick(IVec3::ZERO)
    );
    assert_eq!(wrapped.probe_radius_mm(), Probe::RADIUS);
    assert!(wrapped.knows_fractions());
    assert_eq!(wrapped.occupancy_fraction(IVec3::ZERO, true), Some(0.75));
    if whole {
        let visits = |of: &dyn Fn() -> Traversal| of().visits;
        let [start, end] = [DVec3::ZERO, DVec3::ONE];
        let expected = visits(&|| probe.first_solid(start, end, 9));
        assert_eq!(visits(&|| wrapped.first_solid(start, end, 9)), expected);
        let mut changes = [0.0];
        wrapped.fraction_changes(&[(IVec3::ZERO, true)], &mut changes);
        assert_eq!(changes, [0.125]);
    }
}

#[test]
fn a_wrapped_probe_keeps_its_radius_and_all_its_answers() {
    let probe = || Probe::new(true);
    check_wrapped(&&probe(), true);
    check_wrapped(&Box::new(probe()), true);
    check_wrapped(&Arc::new(probe()), true);
    check_wrapped(&Some(probe()), true);
    check_wrapped(&[probe()], false);
    check_wrapped(&vec![probe()], false);
    check_wrapped(&[Some(&probe()), None], false);
}

#[test]
fn a_union_takes_the_largest_radius_and_the_largest_fraction() {
    let parts = [Probe::new(false), Probe::new(true)];
    assert_eq!(parts.occupancy_fraction(IVec3::ZERO, true), Some(0.75));
    assert_eq!(
        parts[..1].occupancy_fraction(IVec3::ZERO, false),
        Some(0.25)
    );
    assert_eq!(parts.probe_radius_mm(), Probe::RADIUS);
    let nothing: [Option<Probe>; 2] = [None, None];
    assert!(!nothing.knows_fractions() && nothing.occupancy_fraction(IVec3::ZERO, false).is_none());
    assert_eq!(nothing.probe_radius_mm(), 0.0);
}
