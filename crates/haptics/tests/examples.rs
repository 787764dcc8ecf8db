//! The example of `docs/extend/adding-a-contact-model.md` does what the page says.

#[path = "../examples/simple_model.rs"]
mod simple_model;

use crate::support::{Body, Components, Random, SPACINGS, grid, noise};
use glam::{DVec3, IVec3, UVec3};
use palpate_haptics::contact::{ContactModel, Proxy};
use palpate_haptics::scene::TouchScene;
use palpate_volume::occupancy::Occupancy;
use simple_model::HardStop;

#[test]
fn the_example_of_a_contact_model_runs() {
    simple_model::main();
}

/// The guarantees that the page asks a model to be tested for, on the example itself.
#[test]
fn the_example_never_enters_a_solid_voxel_nor_leaves_its_connected_space() {
    let dimensions = UVec3::splat(20);
    let solid = noise(20, 0.3, 1);
    let components = Components::of(&solid, dimensions);
    for spacing in SPACINGS {
        let grid = grid(dimensions, spacing);
        let scene = TouchScene::of_world(&solid, &grid);
        let mut random = Random::new(2);
        let mut proxy = Proxy::at(DVec3::splat(-3.0)).expect("a finite point");
        for _ in 0..20_000 {
            let contact = HardStop.advance(&scene, random.point(-4.0, 24.0), &mut proxy);
            assert!(!contact.violation && !solid.is_solid(proxy.voxel()));
            assert!(contact.visits <= HardStop.visit_bound());
            assert_eq!(components.label(proxy.voxel()), Components::OUTSIDE);
        }
    }
}

/// What the page says it lacks.
#[test]
fn the_example_does_not_slide_around_an_edge_that_exact_slides_around() {
    let step = Body(|voxel: IVec3| voxel.z < if voxel.x < 10 { 10 } else { 12 });
    let grid = grid(UVec3::splat(32), DVec3::ONE);
    let scene = TouchScene::of_world(&step, &grid);
    let start = Proxy::at(DVec3::new(5.5, 5.5, 10.5)).expect("a finite point");
    let device = DVec3::new(14.5, 5.5, 9.0);
    let (mut stopped, mut slid) = (start, start);
    for _ in 0..100 {
        HardStop.advance(&scene, device, &mut stopped);
        palpate_haptics::contact::Exact::default().advance(&scene, device, &mut slid);
    }
    assert!(stopped.point().x < 10.0 && slid.point().x > 14.0);
}
