//! The lattice as an elastic body: moduli, isotropy, border.

use crate::support::{ball, block, falls_of_energy, half_space, press, solid};
use std::f64::consts::PI;

use glam::{DMat3, DVec3, UVec3};
use palpate_deform::lattice::{
    Border, Lattice, LatticeModuli, NodeMaterial, RelaxSettings, Relaxer,
};

/// Compresses a block of `count`³ nodes between plates without friction by a thousandth, and
/// returns Young's modulus and Poisson's ratio as seen from outside.
fn compress(count: u32, poisson: f64) -> (f64, f64) {
    let mut lattice = block(UVec3::splat(count), solid(poisson));
    let strain = 1e-3;
    let length = f64::from(count - 1);
    let layout = *lattice.layout();
    for (node, index) in layout.nodes() {
        let height = f64::from(node.z) - 0.5 * length;
        lattice.set_moved(index, DVec3::new(0.0, 0.0, -strain * height));
        if node.z == 0 || node.z == count - 1 {
            lattice.hold(index, 2, true);
        }
    }
    let reference = strain * f64::from(count).powi(2);
    let settings = RelaxSettings {
        tolerance: 1e-6,
        iterations: 5000,
        reference,
    };
    let report = Relaxer::default().relax(&mut lattice, &[], &settings, &|| false);
    assert!(report.residual <= 1e-6, "{report:?}");

    let top = layout.nodes().filter(|(node, _)| node.z == count - 1);
    let force: f64 = top.map(|(_, index)| lattice.force(index).z).sum();
    let side = |x: u32| {
        lattice
            .moved(layout.index(UVec3::new(x, count / 2, count / 2)))
            .x
    };
    let widened = (side(count - 1) - side(0)) / length;
    (
        force.abs() / (f64::from(count).powi(2) * strain),
        widened / strain,
    )
}

/// The free surface counts with 1/n, so that two sizes give the endless body.
fn endless(half: (f64, f64), full: (f64, f64)) -> (f64, f64) {
    (2.0 * full.0 - half.0, 2.0 * full.1 - half.1)
}

#[test]
fn a_compressed_block_gives_back_the_young_modulus_and_the_poisson_ratio_that_were_asked_for() {
    for asked in [0.25, 0.35, 0.45] {
        let (young, poisson) = endless(compress(8, asked), compress(16, asked));
        println!("asked E 1, nu {asked}: E {young:.4}, nu {poisson:.4}");
        // 2 and 3 %: what the issue asks of a virtual compression, extrapolated over size
        assert!((young - 1.0).abs() < 0.02, "E {young} at nu {asked}");
        assert!(
            (poisson / asked - 1.0).abs() < 0.03,
            "nu {poisson}, asked {asked}"
        );
    }
}

/// Energy of a block under a uniform strain [N·mm].
fn energy_of(count: u32, poisson: f64, strain: DMat3) -> f64 {
    let mut lattice = block(UVec3::splat(count), solid(poisson));
    let layout = *lattice.layout();
    for (node, index) in layout.nodes() {
        lattice.set_moved(index, strain * node.as_dvec3());
    }
    lattice.energy()
}

#[test]
fn it_is_equally_stiff_along_edges_face_diagonals_and_space_diagonals() {
    let strain = 1e-4;
    for poisson in [0.25, 0.35, 0.45] {
        for direction in [DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::ONE] {
            let d = direction.normalize();
            let along = DMat3::from_cols(d * d.x, d * d.y, d * d.z);
            let state = (along * (1.0 + poisson) - DMat3::IDENTITY * poisson) * strain;
            // a uniform strain makes the energy a cubic in the size, whose leading term is the
            // body's without its surface
            let [a, b, c, e] = [4, 5, 6, 7].map(|count| energy_of(count, poisson, state));
            let density = (e - 3.0 * c + 3.0 * b - a) / 6.0;
            let young = 2.0 * density / strain.powi(2);
            // 3 % are asked; the lattice is exact but for the strain's second order
            assert!(
                (young - 1.0).abs() < 0.003,
                "E {young} along {d} at nu {poisson}"
            );
        }
    }
}

#[test]
fn forces_are_the_gradient_of_the_energy() {
    let mut random = oorandom::Rand64::new(5);
    let mut lattice = Lattice::new(
        UVec3::splat(5),
        1.0,
        Border::Endless {
            load: DVec3::splat(2.0),
        },
        |node| match node.z {
            ..4 => NodeMaterial::Deformable(solid(0.4)),
            _ => NodeMaterial::Empty,
        },
    );
    let nodes: Vec<usize> = lattice.matter_nodes().collect();
    for &index in &nodes {
        let mut number = || 0.2 * (random.rand_float() - 0.5);
        lattice.set_moved(index, DVec3::new(number(), number(), number()));
    }
    falls_of_energy(&mut lattice, 7, |force, axis, fall| {
        // the third order of the step, and rounding of an energy of about 1
        assert!((force.dot(axis) - fall).abs() < 1e-7, "{force} {fall}");
    });
}

/// A sphere that turns in an endless body takes a moment of 8 π μ a³ for its turn (Chwang & Wu 1974, by
/// analogy). A cube lies between the spheres in it and around it.
#[test]
fn the_border_holds_a_turn_back_as_an_endless_body_does() {
    for poisson in [0.25, 0.45, 0.49] {
        let one = solid(poisson);
        let half = 5.0;
        let border = Border::Endless {
            load: DVec3::splat(half),
        };
        let mut lattice = Lattice::new(UVec3::splat(11), 1.0, border, |_| {
            NodeMaterial::Deformable(one)
        });
        for axis in [DVec3::Z, DVec3::new(0.6, 0.0, 0.8)] {
            let turn = axis * 1e-4;
            for index in lattice.matter_nodes().collect::<Vec<_>>() {
                let arm = lattice.rest_place(index) - DVec3::splat(half);
                lattice.set_moved(index, turn.cross(arm));
            }
            // half of moment times turn; the nodes inside keep their shape
            let stiffness = 2.0 * lattice.energy() / turn.length_squared();
            let sphere = |radius: f64| 8.0 * PI * one.shear() * radius.powi(3);
            let [inner, outer] = [half, 3f64.sqrt() * half].map(sphere);
            assert!(
                (inner..outer).contains(&stiffness),
                "ν {poisson}: {stiffness} of {inner} to {outer} N·mm"
            );
        }
    }
}

#[test]
fn the_border_stands_for_the_body_behind_it() {
    for poisson in [0.25, 0.45] {
        let one = solid(poisson);
        let force = |count: u32, endless: bool| {
            let mut lattice = half_space(count, endless, one, 1000, one);
            let tool = ball(count, 1.0, 0.0);
            press(&mut Relaxer::default(), &mut lattice, tool, 1e-4, 3000)
                .0
                .z
        };
        let (small, large, held) = (force(21, true), force(41, true), force(21, false));
        println!("nu {poisson}: 21³ {small:.4} N, 41³ {large:.4} N, held at 21³ {held:.4} N");
        // 5 % are asked against a large box; `palpate bench deform` has 81³ at nu 0.25
        assert!((small / large - 1.0).abs() < 0.05);
        assert!(held / large > 1.05, "a held border is what this is about");
    }
}

#[test]
fn poisson_ratios_out_of_range_are_taken_to_the_nearest_one() {
    assert_eq!(LatticeModuli::of(&solid(0.495), 1.0).poisson, 0.49);
    assert_eq!(LatticeModuli::of(&solid(0.1), 1.0).poisson, 0.25);
    let quarter = LatticeModuli::of(&solid(0.25), 2.0);
    // E = 2.5 k / h
    assert!(
        (quarter.bond - 0.8).abs() < 1e-12 && quarter.volume < 1e-12,
        "{quarter:?}"
    );
}
