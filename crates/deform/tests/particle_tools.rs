//! Tools among particles, and how particles come to rest.

use glam::{DMat3, DQuat, DVec3, IVec3};
use palpate_deform::particles::calibration::FADE;
use palpate_deform::particles::integrator::Fire;
use palpate_deform::particles::lattices::{FCC_CHI, fcc};
use palpate_deform::particles::tool_push::{ParticleTool, ToolLaw};
use palpate_deform::particles::{FadedLaw, PairOptions, ParticleSystem, Particles, Site, Space};
use palpate_deform::potential::{LennardJones, PairLaw};

fn force_on(tool: &ParticleTool, place: DVec3) -> DVec3 {
    let mut particles = Particles::at_rest(&[place], 2.0, 1.0);
    let felt = ToolLaw::new(1.0).push(tool, &mut particles);
    // what the tool feels is what it gives
    assert_eq!(felt.force, -particles.forces[0]);
    particles.forces[0]
}

fn ball(radius: f64) -> ParticleTool {
    ParticleTool {
        centre: DVec3::ZERO,
        half_axes: DVec3::splat(radius),
        orientation: DMat3::IDENTITY,
    }
}

fn ellipsoid() -> ParticleTool {
    ParticleTool {
        centre: DVec3::new(0.3, -0.2, 0.1),
        half_axes: DVec3::new(1.0, 2.0, 3.5),
        orientation: DMat3::from_quat(DQuat::from_euler(glam::EulerRot::XYZ, 0.4, -0.7, 1.1)),
    }
}

#[test]
fn a_ball_pushes_by_the_law_of_the_distance_to_its_surface() {
    let law = LennardJones::new(1.0, 2.0).expect("positive");
    for step in 1..200 {
        // half a link beyond the surface it begins
        let distance = 0.8 + 0.002 * f64::from(step);
        let place = (3.0 - 0.5 + distance) * DVec3::new(0.6, 0.0, -0.8);
        let force = force_on(&ball(3.0), place);
        let expected = if distance < 1.0 {
            law.force(distance)
        } else {
            0.0
        };
        // the two ways round differ by rounding of a steep law
        assert!(
            (force.dot(place.normalize()) - expected).abs() < 1e-9 * (1.0 + expected),
            "{distance}"
        );
    }
}

#[test]
fn an_ellipsoid_pushes_outward_and_gains_no_work_on_closed_ways() {
    let tool = ellipsoid();
    let mut random = oorandom::Rand64::new(8);
    let mut any = || 2.0 * random.rand_float() - 1.0;
    let mut pushed = 0;
    for _ in 0..2000 {
        let place = 4.0 * DVec3::new(any(), any(), any());
        let force = force_on(&tool, place);
        assert!(force.is_finite() && force.dot(place - tool.centre) >= 0.0);
        pushed += u32::from(force.length() > 0.0);
    }
    // an eighth of the places lies within reach
    assert!(pushed > 150, "{pushed}");

    // a loop through the outer part of the push, where the law is smooth
    let parts = 20_000;
    let on_loop = |i: f64| {
        let angle = std::f64::consts::TAU * i / f64::from(parts);
        let own = DVec3::new(
            1.35 * angle.cos(),
            2.25 * angle.sin(),
            0.5 * (2.0 * angle).sin(),
        );
        tool.centre + tool.orientation * own
    };
    let (mut work, mut size) = (0.0, 0.0);
    for i in 0..parts {
        let i = f64::from(i);
        let way = on_loop(i + 1.0) - on_loop(i);
        let part = force_on(&tool, on_loop(i + 0.5)).dot(way);
        (work, size) = (work + part, size + part.abs());
    }
    // the middle rule on a law with a kink in its slope
    assert!(size > 0.1 && work.abs() < 1e-5 * size, "{work} of {size}");
}

#[test]
fn no_place_gives_a_push_that_is_no_number() {
    for tool in [ball(1e-3), ball(100.0), ellipsoid()] {
        for place in [
            DVec3::ZERO,
            tool.centre,
            DVec3::splat(1e-200),
            DVec3::NAN,
            DVec3::INFINITY,
            DVec3::splat(1e300),
        ] {
            assert!(force_on(&tool, place).is_finite(), "{tool:?} {place}");
        }
    }
}

/// Steps of FIRE until a shaken crystal has its energy back; half of it of other tissue.
fn steps_to_rest(softer: f64) -> u32 {
    let places = fcc(IVec3::splat(5), FCC_CHI);
    let side = 5.0 * FCC_CHI * std::f64::consts::SQRT_2;
    let mut particles = Particles::at_rest(&places, 1.0, 1.0);
    let mut random = oorandom::Rand64::new(6);
    let mut any = || 0.1 * random.rand_float() - 0.05;
    for (site, home) in particles.sites.iter_mut().zip(&places) {
        let depth = if home.z < 0.5 * side { 1.0 } else { softer };
        *site = Site::new(*home + DVec3::new(any(), any(), any()), depth);
    }
    let inertia: Vec<f64> = particles
        .sites
        .iter()
        .map(|site| 72.0 / site.softness)
        .collect();
    let law = FadedLaw::new(1.0, FADE[0], FADE[1], 300.0).expect("beyond b");
    let mut system = ParticleSystem::new(
        particles,
        law,
        FADE[1],
        0.3,
        Space::Periodic(DVec3::splat(side)),
    );
    system.options = PairOptions {
        sums: true,
        ..PairOptions::default()
    };
    let mut fire = Fire::new(1.0);
    for step in 0..2000 {
        system.evaluate();
        let left = |(force, inertia): (&DVec3, &f64)| force.length() / inertia;
        let left = system
            .particles
            .forces
            .iter()
            .zip(&inertia)
            .map(left)
            .fold(0.0, f64::max);
        if left < 1e-8 {
            return step;
        }
        fire.step(&mut system.particles, &inertia);
    }
    2000
}

#[test]
fn soft_matter_beside_hard_comes_to_rest_about_as_fast_as_one_matter_alone() {
    let (alone, mixed) = (steps_to_rest(1.0), steps_to_rest(1e-5));
    println!("FIRE: {alone} steps for one matter, {mixed} beside one 100 000 times softer");
    assert!(alone < 400, "{alone}");
    // the pairs between them have twice the softness' stiffness, so the soft side is stiffer
    assert!(mixed < 3 * alone, "{alone} {mixed}");
}
