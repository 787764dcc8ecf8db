//! Nearly incompressible tissue, whose cells' pressures are eased on their own.

use crate::support::{ball, block, expect_stiffness_told, half_space, press, solid};
use glam::{DVec3, UVec3};
use palpate_deform::lattice::{LatticeTool, Relaxer};
use palpate_deform::material::Solid;

#[test]
fn nearly_incompressible_tissue_comes_to_rest_in_few_iterations() {
    let iterations = |poisson: f64| -> u32 {
        let one = solid(poisson);
        let mut lattice = half_space(21, true, one, 1000, one);
        let mut relaxer = Relaxer::default();
        // four answers that press, the rest slide
        let answers = (1..=16).map(|answer: u32| {
            let depth = 0.25 * f64::from(answer.min(4));
            let aside = 0.25 * f64::from(answer.saturating_sub(4));
            let tool = ball(21, depth, aside);
            let (_, report) = press(&mut relaxer, &mut lattice, tool, 1e-3, 2000);
            assert!(report.residual <= 1e-3, "nu {poisson}: {report:?}");
            report.iterations
        });
        let sum = answers.sum();
        println!("nu {poisson}: {sum} iterations in 16 answers");
        sum
    };
    // up to 0.45 nothing is eased but by each node's own stiffness
    let [usual, more, most] = [0.45, 0.47, 0.49].map(iterations);
    assert!(more < usual, "{usual} {more}");
    assert!(f64::from(most) < 1.5 * f64::from(usual), "{usual} {most}");
}

/// Deeper than 0.6 of a ball of four spacings, tissue of 0.49 gives way at once.
#[test]
fn nearly_incompressible_tissue_pushes_the_harder_up_to_half_the_radius_of_a_ball() {
    for radius in [2.0, 4.0] {
        let one = solid(0.49);
        let mut lattice = half_space(21, true, one, 99, one);
        let mut relaxer = Relaxer::default();
        let mut last = -1e-9;
        for step in 0..=(10.0 * radius) as u32 {
            let up = 0.5 + radius - 0.05 * f64::from(step);
            let tool = LatticeTool::ball(DVec3::new(10.0, 10.0, 10.0 + up), radius);
            let (force, report) = press(&mut relaxer, &mut lattice, tool, 1e-3, 300);
            assert!(report.residual <= 1e-3, "{report:?}");
            assert!(force.z > last, "{} N after {last} N, step {step}", force.z);
            last = force.z;
        }
    }
}

#[test]
fn the_stiffness_of_nearly_incompressible_tissue_is_the_one_of_the_next_step() {
    for (layers, ratio) in [(99, 1.0), (3, 1e5)] {
        expect_stiffness_told(solid(0.49), layers, ratio);
    }
}

#[test]
fn nearly_incompressible_tissue_under_absurd_tools_stays_finite() {
    let mut lattice = block(UVec3::splat(9), solid(0.49));
    let mut relaxer = Relaxer::default();
    let mut random = oorandom::Rand64::new(11);
    for _ in 0..60 {
        let mut number = || 20.0 * (random.rand_float() - 0.3);
        let centre = DVec3::new(number(), number(), number());
        let tool = LatticeTool::ball(centre, number().abs() + 0.1);
        let (force, _) = press(&mut relaxer, &mut lattice, tool, 1e-4, 30);
        let mut nodes = lattice.matter_nodes();
        assert!(force.is_finite() && nodes.all(|node| lattice.moved(node).is_finite()));
    }
    let absurd = [DVec3::NAN, DVec3::INFINITY, DVec3::splat(1e300)];
    for centre in absurd {
        let tool = LatticeTool::ball(centre, 1.0);
        let (force, _) = press(&mut relaxer, &mut lattice, tool, 1e-4, 30);
        assert!(force.is_finite(), "{centre}: {force}");
    }
}

#[test]
fn soft_tissue_that_is_nearly_incompressible_rests_on_bone_and_beside_tissue_that_is_not() {
    let near = solid(0.49);
    for below in [
        Solid {
            young: 1e5 * near.young,
            ..near
        },
        Solid {
            young: 30.0 * near.young,
            ..solid(0.3)
        },
        solid(0.3),
    ] {
        let mut lattice = half_space(21, true, near, 5, below);
        let tool = ball(21, 0.5, 0.0);
        let (_, report) = press(&mut Relaxer::default(), &mut lattice, tool, 3e-3, 5000);
        assert!(
            report.residual <= 3e-3 && report.iterations < 300,
            "{report:?}"
        );
    }
}
