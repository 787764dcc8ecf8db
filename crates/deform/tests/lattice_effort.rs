//! What an answer of the lattice costs, by counts: a ball that slides over soft tissue.

use std::time::{Duration, Instant};

use glam::{DMat3, DVec3, UVec3};
use palpate_deform::lattice::{LatticeModel, LatticeSettings};
use palpate_deform::material::{MaterialLaw, Materials, SegmentMaterial, SolidSi};
use palpate_deform::model::{Budget, Effort, ModelAnswer};
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::voxels::Voxels;

use crate::model_support::answer_to_ball;

/// Nodes along each edge of the box.
const NODES: u64 = 21;
const ITERATIONS: u32 = 80;
/// Way of the ball in an answer [nodes].
const WAY: f64 = 0.5;
/// How far the box lets the tool go before it follows [nodes].
const LEASH: u64 = 3;

/// Soft tissue up to half the height, and its materials.
fn body() -> (Voxels, Materials) {
    let size = UVec3::new(80, 40, 40);
    let grid = Grid::new(size, DVec3::ONE, DVec3::splat(0.5), DMat3::IDENTITY).expect("a grid");
    let values = vec![0; grid.voxel_count()];
    let intensities = Intensities::new(size, values, 1.0, 0.0).expect("intensities");
    let mut voxels = Voxels::new(grid, intensities).expect("one grid");
    let segment = Segment::from_fn(size, |voxel| voxel.z < 20);
    let id = voxels.add_segment(segment).expect("a free number");
    let solid = SolidSi {
        young: 1e4,
        poisson: 0.4,
        density: 1000.0,
        fracture_energy: f64::INFINITY,
        friction: 0.0,
        stiffening: 0.0,
    };
    let materials = Materials {
        segments: vec![SegmentMaterial {
            segment: id,
            law: MaterialLaw::constant(solid).expect("matter"),
            regions: Vec::new(),
        }],
    };
    (voxels, materials)
}

/// An answer to a ball 1.5 mm deep at a place along the body; its edit is applied.
fn answer_at(
    model: &mut LatticeModel,
    (voxels, materials): &mut (Voxels, Materials),
    along: f64,
    budget: Budget,
) -> ModelAnswer {
    let ball = (DVec3::new(along, 20.0, 20.5), 2.0);
    answer_to_ball(model, voxels, materials, ball, budget)
}

#[test]
fn an_answer_builds_only_what_is_new_and_looks_only_at_what_moves() {
    let mut body = body();
    let mut model = LatticeModel::new(LatticeSettings::default());
    let efforts: Vec<Effort> = (0..80)
        .map(|frame| {
            let along = 20.0 + WAY * f64::from(frame);
            let budget = Budget::iterations(ITERATIONS);
            let answer = answer_at(&mut model, &mut body, along, budget);
            assert!(answer.report.moved_voxels > 0 || frame < 3);
            answer.report.effort
        })
        .collect();
    for effort in &efforts {
        println!("{effort:?}");
    }
    let face = NODES * NODES;
    let all = NODES * face;
    // the first one builds the box, its nodes and what is behind its faces, and leads it into the tissue
    let first = efforts[0];
    assert!(first.sampled > all && first.sampled < 3 * all / 2);
    assert!(first.built > all && first.built < 3 * all / 2);
    let goes: Vec<_> = efforts[1..]
        .iter()
        .filter(|effort| effort.built > 0)
        .collect();
    let way = (WAY * 79.0) as usize;
    assert!(
        (way / 4..=way / 2).contains(&goes.len()),
        "{} ways",
        goes.len()
    );
    for effort in &efforts[1..] {
        if effort.built == 0 {
            assert_eq!(effort.sampled, 0);
        }
        // what is new, behind it, and behind the other end
        assert!(
            effort.sampled <= (LEASH + 2) * face + 4 * LEASH * NODES,
            "{effort:?}"
        );
        // with the nodes that hang on it
        assert!(effort.built <= (LEASH + 3) * face, "{effort:?}");
        assert!(effort.looked_at < all / 3, "{effort:?}");
        assert!(
            effort.evaluations <= u64::from(ITERATIONS) + 20,
            "{effort:?}"
        );
    }
    // what eases the iterations is worked out again after several ways only
    let anew = goes
        .iter()
        .filter(|effort| effort.evaluations > u64::from(ITERATIONS) + 6);
    println!("{} of {} ways with all anew", anew.count(), goes.len());
}

/// A time that is over leaves the least that an answer can be: by counts, whatever the clock says.
#[test]
fn an_answer_that_is_late_from_the_start_hardly_works() {
    let mut body = body();
    let mut model = LatticeModel::new(LatticeSettings::default());
    answer_at(&mut model, &mut body, 20.0, Budget::iterations(ITERATIONS));
    let late = Budget {
        deadline: Instant::now().checked_sub(Duration::from_secs(1)),
        ..Budget::iterations(ITERATIONS)
    };
    assert!(late.deadline.is_some());
    let answer = answer_at(&mut model, &mut body, 20.3, late);
    assert!(answer.report.iterations <= 3, "{:?}", answer.report);
    assert!(answer.report.effort.evaluations <= 8, "{:?}", answer.report);
    let contact = answer.contacts[0].contact.expect("it still presses");
    assert!(contact.force.z > 0.0);
}
