//! Tissue around a needle, as it is seen: it dimples under the tip, is carried along the shaft, and comes
//! back.

use glam::{DVec3, IVec3};
use palpate_deform::lattice::{CARRIED, DEEPEST, NeedleDrag, NeedleInput, NeedleTissue};
use palpate_deform::material::{Region, SolidSi, Treatment};
use palpate_deform::model::{Budget, DisplacementField};
use palpate_volume::voxel_box::VoxelBox;

use crate::model_support::{Bench, LIVER, TOP};

/// Where the needle touches [mm].
const ENTRY: DVec3 = DVec3::new(18.0, 18.0, TOP);
/// Of an answer, as of a press.
const ITERATIONS: u32 = 80;

/// A needle that presses the surface in, straight down.
fn pressing(pressed: f64) -> NeedleDrag {
    NeedleDrag {
        entry: ENTRY,
        direction: DVec3::NEG_Z,
        pressed,
        ..Default::default()
    }
}

/// A needle that is in, and carries tissue along its shaft.
fn inside(depth: f64, carried: f64) -> NeedleDrag {
    NeedleDrag {
        depth,
        carried,
        ..pressing(0.0)
    }
}

/// A block and the tissue around a needle in it.
struct Block {
    bench: Bench,
    tissue: NeedleTissue,
    field: Option<DisplacementField>,
}

impl Block {
    fn new(solid: SolidSi) -> Self {
        Self {
            bench: Bench::new(solid),
            tissue: NeedleTissue::default(),
            field: None,
        }
    }

    fn answer(&mut self, drag: Option<NeedleDrag>) -> &mut Self {
        self.field = self.tissue.advance(&NeedleInput {
            voxels: &self.bench.voxels,
            materials: &self.bench.materials,
            drag,
            budget: Budget::iterations(ITERATIONS),
        });
        self
    }

    /// Comes to a drag in ten answers, as a hand does.
    fn go(&mut self, drag: NeedleDrag) -> &mut Self {
        for step in 1..=10 {
            let share = f64::from(step) / 10.0;
            self.answer(Some(NeedleDrag {
                pressed: drag.pressed * share,
                carried: drag.carried * share,
                ..drag
            }));
        }
        self
    }

    /// Displacement at a place [mm], trilinear between nodes.
    fn at(&self, place: DVec3) -> DVec3 {
        let Some(field) = &self.field else {
            return DVec3::ZERO;
        };
        let within = (field.axes.transpose() * (place - field.origin)) / field.spacing;
        let (low, size) = (within.floor(), field.size.as_ivec3());
        let mut sum = DVec3::ZERO;
        for corner in 0..8 {
            let step = IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
            let node = low.as_ivec3() + step;
            if node.cmplt(IVec3::ZERO).any() || node.cmpge(size).any() {
                continue;
            }
            let along = DVec3::select(step.cmpeq(IVec3::ONE), within - low, 1.0 - within + low);
            let index = node.x + size.x * (node.y + size.y * node.z);
            sum += along.element_product() * field.moved[index as usize].as_dvec3();
        }
        sum
    }

    /// How far the place so far from the entry has gone down [mm].
    fn down(&self, from_entry: DVec3) -> f64 {
        -self.at(ENTRY + from_entry).z
    }

    fn farthest(&self) -> f64 {
        let moved = self.field.iter().flat_map(|field| &field.moved);
        moved.fold(0.0, |most, moved| f64::max(most, moved.length().into()))
    }
}

#[test]
fn the_surface_dimples_under_the_tip_by_as_much_as_it_is_pressed_in() {
    for pressed in [0.3, 1.0, 3.0, DEEPEST] {
        for poisson in [0.3, 0.49] {
            let mut block = Block::new(SolidSi { poisson, ..LIVER });
            block.go(pressing(pressed));
            let dimple = block.down(DVec3::ZERO);
            assert!(
                (dimple / pressed - 1.0).abs() < 0.15,
                "{dimple} of {pressed}, {poisson}"
            );
            assert!(block.farthest() <= 1.001 * pressed);
        }
    }
}

#[test]
fn a_dimple_falls_off_evenly_on_all_sides_and_is_not_folded() {
    let mut block = Block::new(LIVER);
    block.go(pressing(4.0));
    for toward in [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::NEG_Z] {
        let line: Vec<f64> = (0..9)
            .map(|n| block.down(2.0 * f64::from(n) * toward))
            .collect();
        let falls = |pair: &[f64]| pair[0] - pair[1] > -0.02 && pair[0] - pair[1] < 0.75 * 2.0;
        assert!(line.windows(2).all(falls), "{toward}: {line:?}");
        assert!(line[5] < 0.3 * line[0], "{toward}: {line:?}");
    }
    for far in [2.0, 4.0, 8.0] {
        let all = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y].map(|way| block.down(far * way));
        for one in all {
            assert!((one - all[0]).abs() < 0.015 * 4.0, "{far}: {all:?}");
        }
    }
}

#[test]
fn a_dimple_under_an_oblique_needle_goes_along_it() {
    let direction = DVec3::new(0.5, 0.0, -1.0).normalize();
    let mut block = Block::new(LIVER);
    block.go(NeedleDrag {
        direction,
        ..pressing(2.0)
    });
    let moved = block.at(ENTRY);
    assert!((moved.dot(direction) / 2.0 - 1.0).abs() < 0.15, "{moved}");
    assert!(moved.normalize().dot(direction) > 0.98, "{moved}");
}

#[test]
fn tissue_comes_back_bit_by_bit_where_the_needle_lets_go() {
    let mut block = Block::new(LIVER);
    let mut last = block.go(pressing(3.0)).down(DVec3::ZERO);
    for answer in 0..12 {
        let now = block.answer(None).down(DVec3::ZERO);
        assert!(
            now < last || now == 0.0 && last == 0.0,
            "{answer}: {now} after {last}"
        );
        assert!(last - now < 0.6 * 3.0, "{answer}: {now} after {last}");
        last = now;
    }
    assert!(block.field.is_none());
    // a puncture too: what is still pressed in stays
    block.go(pressing(3.0));
    let half = block.answer(Some(pressing(1.0))).down(DVec3::ZERO);
    assert!(half > 1.5 && half < 2.5, "{half}");
    for _ in 0..10 {
        block.answer(Some(pressing(1.0)));
    }
    assert!((block.down(DVec3::ZERO) - 1.0).abs() < 0.15);
}

#[test]
fn the_shaft_carries_tissue_and_its_rim_in_and_out() {
    for carried in [0.2, -0.2] {
        let mut block = Block::new(LIVER);
        block.go(inside(8.0, carried));
        for depth in [0.0, 2.0, 4.0, 6.0] {
            let moved = block.down(DVec3::NEG_Z * depth);
            assert!((moved / carried - 1.0).abs() < 0.15, "{moved} at {depth}");
        }
        let aside = block.down(DVec3::X * 8.0);
        assert!(aside.abs() < 0.3 * carried.abs(), "{aside}");
        assert!(block.farthest() <= 1.001 * carried.abs());
    }
}

#[test]
fn a_tip_that_is_in_presses_what_is_ahead_and_hardly_the_rim() {
    let mut block = Block::new(LIVER);
    block.go(NeedleDrag {
        pressed: 3.0,
        ..inside(8.0, 0.2)
    });
    let tip = block.down(DVec3::NEG_Z * 8.0);
    assert!((tip / 3.0 - 1.0).abs() < 0.15, "{tip}");
    let rim = block.down(DVec3::ZERO);
    assert!(rim > 0.1 && rim < 0.6, "{rim}");
}

#[test]
fn nothing_breaks_and_nothing_yields() {
    let brittle = SolidSi {
        fracture_energy: 1e-3,
        ..LIVER
    };
    let fields = [LIVER, brittle].map(|solid| {
        let mut block = Block::new(solid);
        block.go(pressing(4.0)).answer(Some(pressing(4.0)));
        block.field.clone().expect("a dimple")
    });
    assert_eq!(fields[0], fields[1]);
}

#[test]
fn what_is_no_number_moves_nothing() {
    let good = NeedleDrag {
        pressed: 2.0,
        ..inside(4.0, 0.1)
    };
    let numbers = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    let bad = numbers.into_iter().flat_map(|bad| {
        [
            NeedleDrag {
                entry: DVec3::splat(bad),
                ..good
            },
            NeedleDrag {
                direction: DVec3::splat(bad),
                ..good
            },
            NeedleDrag { depth: bad, ..good },
            NeedleDrag {
                pressed: bad,
                ..good
            },
            NeedleDrag {
                carried: bad,
                ..good
            },
        ]
    });
    let no_direction = NeedleDrag {
        direction: DVec3::ZERO,
        ..good
    };
    for bad in bad.chain([no_direction]) {
        let mut block = Block::new(LIVER);
        assert!(block.answer(Some(bad)).field.is_none(), "{bad:?}");
        // and it is like one that is away
        let before = block.go(good).farthest();
        let after = block.answer(Some(bad)).farthest();
        assert!(after > 0.0 && after < 0.7 * before, "{bad:?}: {after}");
    }
    let mut block = Block::new(LIVER);
    let far = NeedleDrag {
        pressed: 1e6,
        carried: 1e6,
        ..good
    };
    assert!(block.go(far).farthest() <= 1.001 * DEEPEST.max(CARRIED));
}

#[test]
fn rigid_tissue_stays_and_tissue_beside_the_needle_alone_moves() {
    let mut block = Block::new(LIVER);
    // the block from x = 22 mm on
    let rigid = Region::Within(VoxelBox::new(IVec3::new(22, 0, 0), IVec3::splat(36)));
    let segment = &mut block.bench.materials.segments[0];
    segment.regions = vec![(rigid, Treatment::Rigid)];
    block.go(pressing(3.0));
    assert!(block.down(DVec3::new(-3.0, 0.0, -1.0)) > 0.8);
    assert_eq!(block.down(DVec3::new(5.0, 0.0, -1.0)), 0.0);
    block.bench.materials.segments[0].regions = vec![(Region::Whole, Treatment::Rigid)];
    assert!(block.answer(Some(pressing(3.0))).field.is_none());
}

#[test]
fn it_follows_edits_and_needles_that_go_elsewhere() {
    let mut block = Block::new(LIVER);
    assert!(block.go(pressing(2.0)).field.is_some());
    block
        .bench
        .cut(&VoxelBox::new(IVec3::ZERO, IVec3::splat(36)));
    assert!(block.answer(Some(pressing(2.0))).field.is_none());

    let mut block = Block::new(LIVER);
    block.go(pressing(2.0));
    let aside = DVec3::new(-8.0, 6.0, 0.0);
    block.go(NeedleDrag {
        entry: ENTRY + aside,
        ..pressing(2.0)
    });
    assert!((block.down(aside) / 2.0 - 1.0).abs() < 0.15);
    assert!(block.down(DVec3::ZERO) < 0.4);
}

#[test]
fn the_same_calls_give_the_same_fields_and_cost_no_more_than_a_press() {
    let [mut one, mut other] = [(); 2].map(|()| Block::new(LIVER));
    for step in 0..30 {
        let drag = NeedleDrag {
            pressed: 3.0 - 0.1 * f64::from(step),
            ..inside(0.4 * f64::from(step), 0.2)
        };
        one.answer(Some(drag));
        other.answer(Some(drag));
        assert!(one.field.is_some());
        assert_eq!(one.field, other.field);
        let report = one.tissue.report();
        assert!(report.iterations <= ITERATIONS, "{report:?}");
    }
}
