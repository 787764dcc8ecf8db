//! A box holds only what is around the tool, and stands for the whole body all the same.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_deform::lattice::{InelasticSettings, LatticeModel, LatticeSettings, Prony};
use palpate_deform::material::{MaterialLaw, Materials, SegmentMaterial, SolidSi};
use palpate_deform::model::{Budget, DeformationModel, ModelAnswer};
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::voxels::Voxels;

use crate::model_support::answer_to_ball;

/// Upper face of the block [mm].
const TOP: i32 = 48;
/// Ball in voxels: as a finger of 3 mm in a scan of 0.7 mm.
const RADIUS: f64 = 4.3;

/// A block of soft tissue in voxels of 1 mm, and a model that presses it.
struct Block {
    voxels: Voxels,
    materials: Materials,
    model: LatticeModel,
}

impl Block {
    fn new(poisson: f64, nodes: u32) -> Self {
        let settings = LatticeSettings {
            nodes,
            ..LatticeSettings::default()
        };
        Self::with(poisson, f64::INFINITY, settings)
    }

    fn with(poisson: f64, fracture_energy: f64, settings: LatticeSettings) -> Self {
        let dimensions = UVec3::splat(72);
        let grid =
            Grid::new(dimensions, DVec3::ONE, DVec3::splat(0.5), DMat3::IDENTITY).expect("a grid");
        let values: Arc<[i16]> = vec![0; grid.voxel_count()].into();
        let values = Intensities::new(dimensions, values, 1.0, 0.0).expect("intensities");
        let mut voxels = Voxels::new(grid, values).expect("one grid");
        let block = Segment::from_fn(dimensions, |voxel| voxel.z < TOP);
        let segment = voxels.add_segment(block).expect("a free number");
        let soft = SolidSi {
            young: 5500.0,
            poisson,
            density: 1060.0,
            fracture_energy,
            friction: 0.0,
            stiffening: 0.0,
        };
        Self {
            voxels,
            materials: Materials {
                segments: vec![SegmentMaterial {
                    segment,
                    law: MaterialLaw::constant(soft).expect("matter"),
                    regions: Vec::new(),
                }],
            },
            model: LatticeModel::new(settings),
        }
    }

    /// An answer with the ball so deep below the face, somewhere beside the middle of a voxel.
    fn answer(&mut self, depth: f64) -> ModelAnswer {
        self.answer_within(depth, None)
    }

    /// The same from a box of so many nodes along each edge at most.
    fn answer_within(&mut self, depth: f64, edge: Option<u32>) -> ModelAnswer {
        let place = DVec3::new(36.3, 36.4, f64::from(TOP) + RADIUS - depth);
        let budget = Budget {
            edge,
            ..Budget::iterations(300)
        };
        let (model, ball) = (&mut self.model, (place, RADIUS));
        answer_to_ball(model, &mut self.voxels, &self.materials, ball, budget)
    }

    /// Force at each half voxel down to a depth [N].
    fn press(&mut self, deepest: f64) -> Vec<f64> {
        (1..=(2.0 * deepest) as u32)
            .map(|half| force(&self.answer(0.5 * f64::from(half))))
            .collect()
    }
}

fn force(answer: &ModelAnswer) -> f64 {
    let contact = answer.contacts[0].contact;
    contact.map_or(0.0, |contact| contact.force.z)
}

/// Largest difference of two presses after their first half millimetre, where the force is small, as a share.
fn apart(one: &[f64], other: &[f64]) -> f64 {
    let pairs = one.iter().zip(other).skip(1);
    pairs.fold(0.0, |most, (one, other)| {
        f64::max(most, (one / other - 1.0).abs())
    })
}

#[test]
fn a_ball_feels_in_its_box_what_it_feels_in_a_far_larger_one() {
    for poisson in [0.45, 0.49] {
        // to 1.4 times its radius
        let [usual, large] = [21, 41].map(|nodes| Block::new(poisson, nodes).press(6.0));
        let error = apart(&usual, &large);
        assert!(error < 0.03, "ν {poisson}: {error}\n{usual:?}\n{large:?}");
    }
}

/// Below some three radii the face of the tissue is beyond the cube of the box.
#[test]
fn force_grows_with_depth_down_to_four_radii_and_the_dent_is_seen_to_its_rim() {
    let mut block = Block::new(0.45, 21);
    let forces = block.press(4.0 * RADIUS);
    assert!(
        forces.windows(2).all(|pair| pair[1] > pair[0]),
        "{forces:?}"
    );
    // voxels above the ball's lower end, in its axis, are air
    let (_, segment) = block.voxels.segments().next().expect("the block");
    let bottom = f64::from(TOP) - 4.0 * RADIUS;
    let in_axis = |z: i32| segment.contains(IVec3::new(36, 36, z));
    let highest = (0..TOP).rev().find(|z| in_axis(*z)).expect("tissue");
    assert!((f64::from(highest + 1) - bottom).abs() <= 1.0, "{highest}");
}

#[test]
#[ignore = "takes long: make test-long"]
fn at_four_radii_a_ball_feels_in_its_box_what_it_feels_in_a_far_larger_one() {
    let [usual, large] = [21, 41].map(|nodes| Block::new(0.45, nodes).press(4.0 * RADIUS));
    let error = apart(&usual, &large);
    assert!(error < 0.04, "{error}\n{usual:?}\n{large:?}");
}

/// Nearly incompressible tissue gives way to a turn as easily as its border lets it.
#[test]
fn tissue_does_not_roll_out_from_below_the_ball() {
    let mut block = Block::new(0.49, 21);
    let forces = block.press(6.0);
    assert!(
        forces.windows(2).all(|pair| pair[1] > pair[0]),
        "{forces:?}"
    );
    let parts = block.model.parts().places;
    let middle = DVec3::new(36.3, 36.4, 0.0);
    for axis in [DVec3::X, DVec3::Y] {
        let beside = |[rest, now]: &[DVec3; 2]| (*now - *rest).dot(axis);
        let below = parts.iter().filter(|[rest, _]| {
            let from = (*rest - middle).truncate();
            from.length() < 2.0 && rest.z < f64::from(TOP) - 8.0
        });
        let (sum, count) = below.fold((0.0, 0.0), |(sum, count), part| {
            (sum + beside(part), count + 1.0)
        });
        assert!(
            count > 0.0 && f64::abs(sum / count) < 0.1,
            "{axis}: {}",
            sum / count
        );
    }
}

#[test]
fn a_box_that_goes_on_starts_its_new_tissue_near_where_it_comes_to_rest() {
    // the small box down to two radii: it is for one
    for (nodes, deepest) in [(13, 17), (21, 24)] {
        let mut block = Block::new(0.45, nodes);
        let mut last = 0.0;
        let mut goes = 0;
        for half in 1..=deepest {
            let answer = block.answer(0.5 * f64::from(half));
            goes += u32::from(answer.report.effort.built > 0);
            assert!(answer.report.residual < 0.01, "{:?}", answer.report);
            let now = force(&answer);
            assert!(now < 2.0 * last + 0.02, "{last} N, then {now}");
            last = now;
        }
        assert!(goes > 2, "the box went on");
    }
}

/// Nodes along each edge of the box where a computer can't keep up.
const SMALL: Option<u32> = Some(13);

#[test]
fn a_small_box_gives_nearly_the_same_force_down_to_the_radius_of_the_ball() {
    for poisson in [0.3, 0.45, 0.49] {
        let usual = Block::new(poisson, 21).press(RADIUS);
        let small = Block::new(poisson, 13).press(RADIUS);
        // where few nodes are touched it matters a little where they stand in the box
        for (from, most) in [(0, 0.06), (2, 0.05)] {
            let error = apart(&small[from..], &usual[from..]);
            assert!(error < most, "ν {poisson}: {error}\n{small:?}\n{usual:?}");
        }
    }
}

#[test]
#[ignore = "takes long: make test-long"]
fn a_small_box_is_a_third_too_soft_at_most_down_to_four_radii() {
    for (poisson, most) in [(0.3, 0.21), (0.45, 0.21), (0.49, 0.33)] {
        let usual = Block::new(poisson, 21).press(4.0 * RADIUS);
        let small = Block::new(poisson, 13).press(4.0 * RADIUS);
        let error = apart(&small, &usual);
        assert!(error < most, "ν {poisson}: {error}\n{small:?}\n{usual:?}");
    }
}

#[test]
fn a_box_gets_smaller_under_the_tool_and_larger_without_it() {
    let fades = InelasticSettings {
        prony: Some(Prony {
            share: 0.5,
            time: 0.1,
        }),
        ..InelasticSettings::default()
    };
    for inelastic in [InelasticSettings::default(), fades] {
        let settings = LatticeSettings {
            inelastic,
            ..LatticeSettings::default()
        };
        let mut block = Block::with(0.45, f64::INFINITY, settings);
        let picture = block.voxels.clone();
        let mut before = ModelAnswer::default();
        for _ in 0..20 {
            before = block.answer(4.0);
        }
        assert!(!before.report.small_box && !before.report.settling);
        for _ in 0..5 {
            let small = block.answer_within(4.0, SMALL);
            assert!(small.report.small_box && small.report.nodes < 13 * 13 * 13);
            let error = force(&small) / force(&before) - 1.0;
            assert!(error.abs() < 0.05, "{error}");
        }
        // without a tool in it all is as it was, also what the small box has left
        for _ in 0..20 {
            block.answer_within(-3.0, SMALL);
        }
        let usual = block.answer(-3.0);
        assert!(!usual.report.small_box && usual.report.moved_voxels == 0);
        let differ = |voxel: &IVec3| block.voxels.state(*voxel) != picture.state(*voxel);
        assert_eq!(picture.grid().bounds().voxels().find(differ), None);
    }
}

#[test]
fn tissue_that_yields_keeps_its_box() {
    let settings = LatticeSettings {
        inelastic: InelasticSettings {
            yield_strain: Some(0.02),
            ..InelasticSettings::default()
        },
        ..LatticeSettings::default()
    };
    let mut block = Block::with(0.45, f64::INFINITY, settings);
    let report = block.answer_within(2.0, SMALL).report;
    assert!(!report.small_box && report.nodes > 13 * 13 * 13);
}

#[test]
fn what_broke_in_a_large_box_stays_broken_in_a_small_one_and_back() {
    let mut block = Block::with(0.3, 0.05, LatticeSettings::default());
    for half in 1..=12 {
        block.answer(0.5 * f64::from(half));
    }
    // those that hold where the ball was, wherever the box stands
    let pairs = |block: &Block| {
        let lattice = block.model.lattice().expect("a box");
        let places = block.model.parts().places;
        let rest: BTreeMap<_, _> = lattice.matter_nodes().zip(places).collect();
        let near = |node: &usize| {
            let from = rest[node][0] - DVec3::new(36.0, 36.0, f64::from(TOP));
            from.truncate().abs().max_element() < 5.0 && from.z > -3.0
        };
        let pairs = lattice.bonded_pairs();
        pairs.filter(|pair| pair.iter().all(near)).count()
    };
    for _ in 0..10 {
        block.answer(-4.0);
    }
    let broken = block.answer(-4.0).report.bonds_broken;
    assert!(broken > 0);
    let whole = pairs(&block);
    let small = block.answer_within(-4.0, SMALL).report;
    assert!(small.small_box && small.bonds_broken == broken);
    assert!(!block.answer(-4.0).report.small_box);
    assert_eq!(pairs(&block), whole);
}
