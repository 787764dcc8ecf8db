//! How the thesis' local models part the time of an answer.
//!
//! A binary of its own: a test that measures time must not share the processor with others.

mod liver;

use std::time::{Duration, Instant};

use glam::DVec3;
use liver::{H, SIDE, advance, ball, scan};
use palpate_deform::model::{Budget, DeformationModel, ModelInput};
use palpate_deform::particles::{FadedLaw, LocalModel, LocalSettings};

/// Answers that are tried: a busy machine may take all of the time of one.
const TRIES: usize = 5;

/// The first layer alone would come to rest in more than twice the time there is.
#[test]
fn each_layer_has_its_share_of_the_time() {
    assert!((0..TRIES).any(|_| outer_layer_moves_in_time() > 0.0));
}

/// How far the outer layer moves in an answer that ends before the first layer is at rest [mm].
fn outer_layer_moves_in_time() -> f64 {
    let (mut voxels, materials) = scan(DVec3::splat(H));
    let mut model = LocalModel::fcc_lj(LocalSettings {
        box_cells: 25,
        layers: 3,
        ..Default::default()
    });
    let tool = ball(&voxels, 0.6);
    // the box is there, and nothing has moved yet
    advance(&mut model, &mut voxels, &materials, &[tool], 0);
    let outer = |model: &LocalModel<FadedLaw>| {
        let middle = H * f64::from(SIDE / 2);
        let homes = model
            .particles()
            .map(|(place, moved)| (place - moved, moved));
        let outer = homes.filter(|(home, _)| (home.x - middle).abs() > 6.0 * H);
        outer.map(|(_, moved)| moved.length()).fold(0.0, f64::max)
    };
    assert_eq!(outer(&model), 0.0);
    model.advance(&ModelInput {
        voxels: &voxels,
        materials: &materials,
        tools: &[tool],
        dt: 0.03,
        budget: Budget {
            iterations: u32::MAX,
            deadline: Some(Instant::now() + Duration::from_millis(100)),
            edge: None,
        },
    });
    outer(&model)
}
