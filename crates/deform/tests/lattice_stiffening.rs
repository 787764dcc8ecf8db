//! Strain stiffening: the curve of a block, its energy, and what a press feels of it.

use crate::support::{ball, block, falls_of_energy, half_space, press, solid};
use glam::{DVec3, IVec3, UVec3};
use palpate_deform::lattice::{Border, Lattice, NodeMaterial, RelaxSettings, Relaxer};
use palpate_deform::material::Solid;

/// E = 1 N/mm², with this stiffening.
fn stiffening(poisson: f64, stiffening: f64) -> Solid {
    Solid {
        stiffening,
        ..solid(poisson)
    }
}

/// Energy of a body for its volume at a uniform stretch along an axis and across it [N/mm²], worked
/// out from the energies of the bonds: 1 along, 2 across, 4 edges in planes of the axis and 2 across,
/// edges twice as strong.
fn energy_density(solid: &Solid, along: f64, across: f64) -> f64 {
    let slanted = (0.5 * (along * along + across * across)).sqrt();
    let strained = |stretch: f64| (stretch - 1.0).powi(2);
    let mean = strained(along) + (2.0 + 4.0) * strained(across) + 8.0 * strained(slanted);
    let exponent = solid.stiffening;
    let (mu, volume) = (solid.shear(), solid.lame() - solid.shear());
    let y = exponent * mean;
    let of_bonds = match y.min(3.0) {
        0.0 => 0.5 * mean,
        curved => (curved.exp_m1() + curved.exp() * (y - curved)) / (2.0 * exponent),
    };
    mu * of_bonds + 0.5 * volume * (along * across * across - 1.0).powi(2)
}

/// Energy density at a stretch with free sides [N/mm²].
fn with_free_sides(solid: &Solid, along: f64) -> f64 {
    let energy = |across: f64| energy_density(solid, along, across);
    let (mut low, mut high) = (0.7, 1.5);
    // golden section
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    for _ in 0..80 {
        let [a, b] = [high - golden * (high - low), low + golden * (high - low)];
        if energy(a) < energy(b) {
            high = b
        } else {
            low = a
        }
    }
    energy(0.5 * (low + high))
}

/// Force for the area at first of a body that is stretched with free sides [N/mm²].
fn stress(solid: &Solid, stretch: f64) -> f64 {
    let step = 1e-4;
    let at = |stretch| with_free_sides(solid, stretch);
    (at(stretch + step) - at(stretch - step)) / (2.0 * step)
}

/// The same of Demiray's law with a constant bulk modulus, W = μ / 2b (exp(b (Ī₁ − 3)) − 1) + K/2 (J − 1)².
fn stress_by_demiray(solid: &Solid, stretch: f64) -> f64 {
    let bulk = solid.lame() + 2.0 / 3.0 * solid.shear();
    let energy = |along: f64, across: f64| {
        let volume = along * across * across;
        let strained = volume.powf(-2.0 / 3.0) * (along * along + 2.0 * across * across) - 3.0;
        solid.shear() * (solid.stiffening * strained).exp_m1() / (2.0 * solid.stiffening)
            + 0.5 * bulk * (volume - 1.0).powi(2)
    };
    // the sides are free where the energy is least
    let (mut low, mut high) = (0.7, 1.5);
    for _ in 0..200 {
        let [a, b] = [(2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0];
        if energy(stretch, a) < energy(stretch, b) {
            high = b
        } else {
            low = a
        }
    }
    let (across, step) = (0.5 * (low + high), 1e-5);
    (energy(stretch + step, across) - energy(stretch - step, across)) / (2.0 * step)
}

/// Stress that a block of 7³ nodes, the nodes on its faces, gives between plates without friction [N/mm²].
fn stress_of_block(solid: Solid, stretch: f64) -> f64 {
    let size = UVec3::splat(7);
    let mut lattice = Lattice::new(size, 1.0, Border::Free, |_| NodeMaterial::Deformable(solid));
    let layout = *lattice.layout();
    for (node, index) in layout.nodes() {
        let from_middle = node.as_dvec3() - 3.0;
        let aside = (1.0 - stretch) * solid.poisson;
        lattice.set_moved(index, from_middle * DVec3::new(aside, aside, stretch - 1.0));
        lattice.hold(index, 2, node.z == 0 || node.z == 6);
    }
    let settings = RelaxSettings {
        tolerance: 1e-6,
        iterations: 5000,
        reference: 1.0,
    };
    let report = Relaxer::default().relax(&mut lattice, &[], &settings, &|| false);
    assert!(report.residual <= 1e-6, "{report:?}");
    let top = layout.nodes().filter(|(node, _)| node.z == 6);
    -top.map(|(_, index)| lattice.force(index).z).sum::<f64>() / 36.0
}

#[test]
fn a_block_follows_the_exponential_curve() {
    for (poisson, exponent) in [(0.25, 8.0), (0.45, 2.0), (0.45, 8.0)] {
        let solid = stiffening(poisson, exponent);
        for stretch in [0.7, 0.8, 0.9, 0.99, 1.05, 1.15] {
            let (found, wanted) = (stress_of_block(solid, stretch), stress(&solid, stretch));
            let linear = stress_of_block(stiffening(poisson, 0.0), stretch);
            println!(
                "nu {poisson}, b {exponent}, stretch {stretch}: {found:.5}, in closed form {wanted:.5}, by \
                 Demiray {:.5}, linear {linear:.5}",
                stress_by_demiray(&solid, stretch)
            );
            // what the residual and the closed form's differences leave
            assert!((found / wanted - 1.0).abs() < 1e-3, "{found} {wanted}");
        }
    }
}

#[test]
fn the_curve_is_that_of_demiray_within_a_quarter() {
    for exponent in [1.0, 2.0, 4.0] {
        let solid = stiffening(0.45, exponent);
        for (stretch, most) in [
            (0.8, 0.24),
            (0.9, 0.105),
            (0.95, 0.055),
            (1.05, 0.06),
            (1.1, 0.13),
        ] {
            let error = stress(&solid, stretch) / stress_by_demiray(&solid, stretch) - 1.0;
            assert!(
                error.abs() < most,
                "b {exponent}, stretch {stretch}: {error}"
            );
        }
    }
}

/// Tissue of three kinds and air, moved at random by this at most [mm].
fn shaken(most: f64) -> Lattice {
    let mut random = oorandom::Rand64::new(5);
    let border = Border::Endless {
        load: DVec3::splat(2.0),
    };
    let mut lattice = Lattice::new(UVec3::splat(6), 1.0, border, |node| match node {
        IVec3 { z: 5.., .. } => NodeMaterial::Empty,
        IVec3 { x: ..3, .. } => NodeMaterial::Deformable(stiffening(0.4, 20.0)),
        IVec3 { y: ..3, .. } => NodeMaterial::Deformable(Solid {
            young: 7.0,
            ..stiffening(0.3, 3.0)
        }),
        _ => NodeMaterial::Deformable(solid(0.4)),
    });
    let nodes: Vec<usize> = lattice.matter_nodes().collect();
    for &index in &nodes {
        let mut number = || 2.0 * most * (random.rand_float() - 0.5);
        lattice.set_moved(index, DVec3::new(number(), number(), number()));
    }
    lattice
}

#[test]
fn stiffened_forces_are_the_gradient_of_the_energy() {
    // where the exponential goes on straight too
    for most in [0.05, 0.1, 0.4] {
        let mut lattice = shaken(most);
        falls_of_energy(&mut lattice, 5, |force, axis, fall| {
            // the third order of the step, and rounding of an energy of about 100
            let error = (force.dot(axis) - fall).abs();
            let allowed = 1e-6 * force.length().max(1.0);
            assert!(error < allowed, "{most}: {force} {fall}");
        });
    }
}

#[test]
fn tissue_that_does_not_stiffen_is_the_same_to_the_bit() {
    let forces = |far: f64| {
        let mut lattice = block(UVec3::splat(7), solid(0.4));
        if far > 0.0 {
            let inside =
                |node: IVec3| node.cmpge(IVec3::ZERO).all() && node.cmplt(IVec3::splat(7)).all();
            lattice = Lattice::new(UVec3::splat(7), 1.0, Border::Free, |node| match node.x {
                _ if !inside(node) => NodeMaterial::Empty,
                6 => NodeMaterial::Deformable(stiffening(0.4, far)),
                _ => NodeMaterial::Deformable(solid(0.4)),
            });
        }
        let mut random = oorandom::Rand64::new(9);
        let layout = *lattice.layout();
        for (_, index) in layout.nodes() {
            let mut number = || 0.3 * (random.rand_float() - 0.5);
            lattice.set_moved(index, DVec3::new(number(), number(), number()));
        }
        lattice.evaluate();
        let at = |(node, index): (UVec3, usize)| (node, lattice.force(index));
        layout.nodes().map(at).collect::<Vec<_>>()
    };
    let (plain, beside) = (forces(0.0), forces(30.0));
    for ((node, force), (_, other)) in plain.iter().zip(&beside) {
        match node.x {
            ..5 => assert_eq!(
                force.to_array().map(f64::to_bits),
                other.to_array().map(f64::to_bits)
            ),
            _ => assert!(force != other, "{node}: nodes beside what stiffens feel it"),
        }
    }
}

#[test]
fn a_press_gets_harder_with_depth_and_never_softer() {
    let forces = |exponent: f64| -> Vec<f64> {
        let one = stiffening(0.45, exponent);
        let mut lattice = half_space(15, true, one, 1000, one);
        let mut relaxer = Relaxer::default();
        let depths = (1..=12).map(|step| 0.25 * f64::from(step));
        depths
            .map(|depth| {
                let (force, report) =
                    press(&mut relaxer, &mut lattice, ball(15, depth, 0.0), 1e-4, 4000);
                assert!(
                    report.residual <= 1e-4,
                    "b {exponent}, {depth} mm: {report:?}"
                );
                force.z
            })
            .collect()
    };
    let (linear, soft, hard) = (forces(0.0), forces(2.0), forces(8.0));
    println!("{linear:?}\n{soft:?}\n{hard:?}");
    for curve in [&linear, &soft, &hard] {
        assert!(curve.windows(2).all(|pair| pair[1] > pair[0]), "{curve:?}");
    }
    let over =
        |curve: &[f64]| -> Vec<f64> { curve.iter().zip(&linear).map(|(a, b)| a / b).collect() };
    // a little pressed it is as it was, far pressed far stiffer
    for ratios in [over(&soft), over(&hard)] {
        assert!(
            ratios.windows(2).all(|pair| pair[1] > pair[0] - 1e-3),
            "{ratios:?}"
        );
    }
    assert!(
        over(&soft)[0] < 1.1 && over(&soft)[11] > 1.2,
        "{:?}",
        over(&soft)
    );
    assert!(over(&hard)[11] > over(&soft)[11]);
}

#[test]
fn tissue_that_is_pressed_flat_or_torn_wide_stays_finite() {
    for (exponent, stretch) in [
        (100.0, 0.0),
        (100.0, -1.0),
        (100.0, 5.0),
        (1.0, 0.0),
        (8.0, 1e3),
    ] {
        let mut lattice = block(UVec3::splat(4), stiffening(0.45, exponent));
        let layout = *lattice.layout();
        for (node, index) in layout.nodes() {
            let height = f64::from(node.z);
            lattice.set_moved(index, DVec3::Z * ((stretch - 1.0) * height));
        }
        lattice.evaluate();
        let mut most = 0.0f64;
        for (_, index) in layout.nodes() {
            most = most.max(lattice.force(index).length());
        }
        assert!(
            most.is_finite() && lattice.energy().is_finite(),
            "{exponent} {stretch}"
        );
        let mut linear = block(UVec3::splat(4), solid(0.45));
        for (_, index) in layout.nodes() {
            linear.set_moved(index, lattice.moved(index));
        }
        assert!(
            lattice.energy() <= 20.1 * linear.energy(),
            "no more than 20 times the springs'"
        );
    }
}

/// What the servo is told: the next force, and never stiffer than the contacts of the nodes touched.
#[test]
fn the_stiffness_told_is_that_of_the_next_step_and_bounded() {
    for (exponent, deepest) in [(2.0, 1.0), (8.0, 1.0), (100.0, 2.0)] {
        let one = stiffening(0.45, exponent);
        let mut lattice = half_space(15, true, one, 1000, one);
        let mut relaxer = Relaxer::default();
        let (mut force, mut told, mut depth) = (0.0, 0.0, 0.0);
        while depth < deepest {
            depth += 0.25;
            let tool = ball(15, depth, 0.0);
            force = press(&mut relaxer, &mut lattice, tool, 1e-5, 6000).0.z;
            told = relaxer.stiffness(&mut lattice, &[tool], 0, 400, &|| false);
            // four times a bond's stiffness, 6.76 times that where it is linear
            let most = 4.0 * 6.77 * one.shear() * f64::from(relaxer.felt()[0].nodes);
            assert!(told > 0.0 && told <= most, "b {exponent}: {told} of {most}");
        }
        let tool = ball(15, depth + 0.05, 0.0);
        let next = press(&mut relaxer, &mut lattice, tool, 1e-5, 6000).0.z;
        let found = (next - force) / 0.05;
        println!("b {exponent}, {depth} mm: told {told}, found {found}");
        if exponent < 100.0 {
            assert!(
                (told / found - 1.0).abs() < 0.1,
                "b {exponent}: {told} {found}"
            );
        }
    }
}
