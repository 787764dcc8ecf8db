//! The thesis' forces as printed: with their faults, but bounded and finite.

use crate::support::{Body, Random, SPACINGS, grid, noise};
use glam::{DVec3, IVec3, UVec3};
use palpate_haptics::contact::{Contact, ContactModel, Exact, ForceInput, Proxy, SlidePath};
use palpate_haptics::scene::TouchScene;
use palpate_haptics::thesis::{ThesisImproved, ThesisOriginal};
use palpate_volume::grid::Grid;

const DEVICE: DVec3 = DVec3::new(10.0, 10.0, 8.0);
const PROXY: DVec3 = DVec3::new(10.5, 10.0, 10.0);

fn contact(path: SlidePath) -> Contact {
    Contact {
        touching: true,
        path: Some(path),
        ..Contact::default()
    }
}

fn force(model: &impl ContactModel, grid: &Grid, contact: &Contact, friction: f64) -> DVec3 {
    let input = ForceInput {
        grid,
        device_in_grid: DEVICE,
        proxy_in_grid: PROXY,
        contact,
        stiffness: 2.0,
        friction,
    };
    model.own_force(&input).expect("a force of its own")
}

/// A way of 2 voxels along x, 1.5 of them in two slides.
const SLID: SlidePath = SlidePath {
    moved: DVec3::new(2.0, 0.0, 0.0),
    length: 2.0,
    border_voxels: 2,
    border_length: 1.5,
    border_sum: DVec3::new(1.5, 0.0, 0.0),
};

#[test]
fn both_forces_are_those_of_the_printed_formulas_with_lengths_in_mm() {
    let grid = grid(UVec3::splat(24), SPACINGS[1]);
    // 2 N/mm · (0.5 · 0.7, 0, 2 · 2.5) mm
    let spring = DVec3::new(0.7, 0.0, 10.0);
    let across = spring.length() - 0.7;
    let slid = contact(SLID);
    // two voxels in a way of two, along the motion: the printed sign
    let original = spring + DVec3::X * (0.3 * across);
    // 1.5 of a way of two, against it
    let improved = spring - DVec3::X * (0.3 * across * 0.75);
    // rounding of some products
    let wrong = |a: DVec3, b: DVec3| a.distance(b) > 1e-12;
    assert!(!wrong(
        force(&ThesisOriginal::default(), &grid, &slid, 0.3),
        original
    ));
    assert!(!wrong(
        force(&ThesisImproved::default(), &grid, &slid, 0.3),
        improved
    ));
}

/// The fault of 4.3 that the errata name first, and that 4.9 mends.
#[test]
fn the_original_friction_drives_and_the_improved_one_resists() {
    let grid = grid(UVec3::splat(24), DVec3::ONE);
    let along = |force: DVec3| force.dot(SLID.moved);
    let slid = contact(SLID);
    for (model, sign) in [(0, 1.0), (1, -1.0)] {
        let with = |friction| match model {
            0 => force(&ThesisOriginal::default(), &grid, &slid, friction),
            _ => force(&ThesisImproved::default(), &grid, &slid, friction),
        };
        assert!((along(with(0.5)) - along(with(0.0))) * sign > 0.1);
    }
}

#[test]
fn without_a_way_there_is_the_spring_alone_and_no_quotient_of_zeros() {
    let grid = grid(UVec3::splat(24), DVec3::ONE);
    let spring = (PROXY - DEVICE) * 2.0;
    let late = SlidePath {
        moved: DVec3::X,
        length: 1.0,
        ..SlidePath::default()
    };
    for still in [
        contact(SlidePath::default()),
        contact(late),
        Contact::default(),
    ] {
        assert_eq!(
            force(&ThesisOriginal::default(), &grid, &still, 0.5),
            spring
        );
        assert_eq!(
            force(&ThesisImproved::default(), &grid, &still, 0.5),
            spring
        );
    }
}

#[test]
fn the_count_of_voxels_over_a_tiny_way_is_bounded() {
    let grid = grid(UVec3::splat(24), DVec3::ONE);
    let tiny = contact(SlidePath {
        length: 1e-9,
        border_length: 1e-9,
        ..SLID
    });
    let spring = (PROXY - DEVICE) * 2.0;
    for (friction, most) in [(0.5, 1.0), (2.0, 4.0)] {
        let force = force(&ThesisOriginal::default(), &grid, &tiny, friction);
        assert!((force - spring).length() <= most * spring.length());
    }
}

/// Everything a model can be given: forces are finite, and friction at most twice μ F_c.
fn survive(model: &impl ContactModel, seed: u128) {
    let solid = noise(24, 0.4, seed);
    let grid = grid(UVec3::splat(24), SPACINGS[1]);
    let mut random = Random::new(seed);
    let mut proxy = Proxy::at(DVec3::splat(-2.0)).expect("a point");
    let absurd = [f64::NAN, f64::INFINITY, 1e300, -1.0];
    let mut slid = 0;
    for _ in 0..50_000 {
        let device = proxy.point() + random.direction() * random.between(0.0, 3.0);
        let device = device.clamp(DVec3::splat(-3.0), DVec3::splat(27.0));
        let before = proxy.point();
        let contact = model.advance(&TouchScene::of_world(&solid, &grid), device, &mut proxy);
        let path = contact.path.expect("a way");
        // the sum of up to twelve moves
        assert!(path.moved.distance(proxy.point() - before) < 1e-12);
        assert!(path.border_length <= path.length + 1e-12);
        assert!(path.border_sum.length() <= path.border_length + 1e-12);
        assert_eq!(path.border_voxels, contact.slides);
        slid += contact.slides;

        let input = ForceInput {
            grid: &grid,
            device_in_grid: device,
            proxy_in_grid: proxy.point(),
            contact: &contact,
            stiffness: 1.0,
            friction: 0.4,
        };
        let spring = ((proxy.point() - device) * grid.spacing()).length();
        let force = model.own_force(&input).expect("a force");
        assert!(force.length() <= spring * 1.8 + 1e-12, "{force} {spring}");
        let bad = ForceInput {
            stiffness: absurd[random.below(4)],
            friction: absurd[random.below(4)],
            ..input
        };
        assert!(model.own_force(&bad).expect("a force").is_finite());
    }
    assert!(slid > 1000, "{slid}");
}

#[test]
fn on_random_noise_both_forces_are_finite_and_bounded() {
    survive(&ThesisOriginal::default(), 3);
    survive(&ThesisImproved::default(), 4);
}

#[test]
fn exact_leaves_its_force_to_touch() {
    let grid = grid(UVec3::splat(24), DVec3::ONE);
    let floor = Body(|v: IVec3| v.z < 10);
    let mut proxy = Proxy::at(DVec3::splat(12.0)).expect("a point");
    let contact =
        Exact::default().advance(&TouchScene::of_world(&floor, &grid), DEVICE, &mut proxy);
    assert_eq!(contact.path, None);
    let input = ForceInput {
        grid: &grid,
        device_in_grid: DEVICE,
        proxy_in_grid: proxy.point(),
        contact: &contact,
        stiffness: 1.0,
        friction: 0.5,
    };
    assert_eq!(Exact::default().own_force(&input), None);
}
