//! Every potential against numerical derivatives of its own energy, and the constants against
//! the corrected numbers of the thesis.
#![expect(clippy::unwrap_used, reason = "a test stops where a law is refused")]

use glam::DVec3;
use palpate_deform::potential::{
    CuboidLennardJones, LennardJones, Limited, Mie, Morse, PairLaw, Potential, PotentialError,
    Repulsive, Shifted, Spline, Stretched, Switched,
};

const A: f64 = 0.71;
const D: f64 = 0.0035;

fn laws() -> Vec<(&'static str, Box<dyn Potential>)> {
    let lj = LennardJones::new(A, D).unwrap();
    let mie = |n, m| Mie::new(A, D, n, m).unwrap();
    vec![
        ("lj", Box::new(lj)),
        ("mie 12-6", Box::new(mie(12.0, 6.0))),
        ("mie 9-6", Box::new(mie(9.0, 6.0))),
        ("mie 8-4", Box::new(mie(8.0, 4.0))),
        ("mie 14-7", Box::new(mie(14.0, 7.0))),
        ("mie 10-5", Box::new(mie(10.0, 5.0))),
        ("morse 6", Box::new(Morse::new(A, D, 6.0).unwrap())),
        ("morse 20", Box::new(Morse::new(A, D, 20.0).unwrap())),
        (
            "switched lj",
            Box::new(Switched::new(lj, 1.9 * A, 2.1 * A).unwrap()),
        ),
        (
            "switched morse",
            Box::new(Switched::new(Morse::new(A, D, 6.0).unwrap(), 1.5 * A, 2.0 * A).unwrap()),
        ),
        ("shifted lj", Box::new(Shifted::new(lj, 2.1 * A).unwrap())),
        (
            "limited lj",
            Box::new(Limited::new(lj, 50.0 * D / A).unwrap()),
        ),
        (
            "limited lj, low",
            Box::new(Limited::new(lj, 3.0 * D / A).unwrap()),
        ),
        (
            "stretched lj, long",
            Box::new(Stretched::new(lj, 0.7).unwrap()),
        ),
        (
            "stretched lj, short",
            Box::new(Stretched::new(lj, 1.5).unwrap()),
        ),
        ("spline lj", Box::new(Spline::new(lj, 1.4 * A).unwrap())),
        (
            "spline mie",
            Box::new(Spline::new(mie(8.0, 4.0), 1.6 * A).unwrap()),
        ),
    ]
}

/// Central difference of fourth order.
fn derivative(function: impl Fn(f64) -> f64, at: f64) -> f64 {
    let h = 2e-4 * A;
    (8.0 * (function(at + h) - function(at - h))
        - (function(at + 2.0 * h) - function(at - 2.0 * h)))
        / (12.0 * h)
}

#[test]
fn the_force_is_the_negative_derivative_of_the_energy() {
    for (name, law) in laws() {
        for step in 0..2000 {
            let r = A * (0.75 + 1.75 * f64::from(step) / 2000.0);
            // where a law has a kink or a step, differences say nothing
            let edges = [1.4, 1.5, 1.6, 1.9, 2.0, 2.1].map(|share| share * A);
            let kinked = Limited::new(LennardJones::new(A, D).unwrap(), 50.0 * D / A)
                .unwrap()
                .reached();
            if edges
                .iter()
                .chain(&[kinked])
                .any(|edge| (r - edge).abs() < 1e-3 * A)
            {
                continue;
            }
            let low = Limited::new(LennardJones::new(A, D).unwrap(), 3.0 * D / A)
                .unwrap()
                .reached();
            if name == "limited lj, low" && (r - low).abs() < 1e-3 * A {
                continue;
            }
            let expected = -derivative(|r| law.energy(r), r);
            // fourth-order differences at h = 2e-4 a: error below 1e-8 of the wall's force
            let tolerance = 1e-7 * (law.force(r).abs() + D / A);
            assert!(
                (law.force(r) - expected).abs() < tolerance,
                "{name} at {r}: {} {expected}",
                law.force(r)
            );
        }
    }
}

#[test]
fn the_characteristics_are_those_of_the_curve() {
    for (name, law) in laws() {
        let known = law.characteristics();
        let scale = known.depth / known.equilibrium;
        assert!(
            law.energy(known.zero).abs() < 1e-9 * known.depth,
            "{name}: energy at sigma"
        );
        assert!(
            law.force(known.equilibrium).abs() < 1e-9 * scale,
            "{name}: force at a"
        );
        assert!(
            (law.energy(known.equilibrium) + known.depth).abs() < 1e-9 * known.depth,
            "{name}: D"
        );
        assert!(
            (law.force(known.critical) + known.strength).abs() < 1e-9 * scale,
            "{name}: f*"
        );
        // no attraction anywhere is greater than f* (the last bits are rounding)
        for step in 1..4000 {
            let r = known.equilibrium * (1.0 + f64::from(step) / 2000.0);
            assert!(
                law.force(r) >= -known.strength * (1.0 + 1e-12),
                "{name}: stronger at {r}"
            );
        }
        let stiffness = -derivative(|r| law.force(r), known.equilibrium);
        // differences of the force: error of fourth order, 1e-7 of C
        if name != "limited lj, low" {
            assert!(
                (stiffness / known.stiffness - 1.0).abs() < 1e-6,
                "{name}: C {stiffness}"
            );
        }
        let k_v = (known.equilibrium.powi(2) * known.stiffness / (2.0 * known.depth)).sqrt();
        assert!((known.dynamics() / k_v - 1.0).abs() < 1e-12, "{name}: k_v");
        let depth = known.depth_for_stiffness(known.stiffness);
        assert!((depth / known.depth - 1.0).abs() < 1e-12, "{name}: 5.51");
    }
}

#[test]
fn the_constants_are_the_corrected_ones_of_the_thesis() {
    let lj = LennardJones::new(1.0, 1.0).unwrap().characteristics();
    // five digits of the errata
    assert!((lj.strength - 2.6899).abs() < 5e-5);
    assert!((lj.stiffness - 72.0).abs() < 1e-12);
    assert!((lj.ultimate_strain() - 0.10868).abs() < 5e-6);
    assert!((lj.nonlinearity() - 2.9091).abs() < 5e-5);
    assert!((lj.dynamics() - 6.0).abs() < 1e-12);

    for (n, m) in [
        (12.0_f64, 6.0_f64),
        (9.0, 6.0),
        (8.0, 4.0),
        (14.0, 7.0),
        (10.0, 5.0),
    ] {
        let mie = Mie::new(1.0, 1.0, n, m).unwrap().characteristics();
        let root = ((n + 1.0).powf(n + 1.0) / (m + 1.0).powf(m + 1.0)).powf(1.0 / (n - m));
        assert!((mie.nonlinearity() / (mie.ultimate_strain() * root) - 1.0).abs() < 1e-12);
        assert!((mie.dynamics() - (m * n / 2.0).sqrt()).abs() < 1e-12);
    }

    let morse = Morse::new(1.0, 1.0, 20.0).unwrap().characteristics();
    assert!((morse.nonlinearity() - 4.0 * std::f64::consts::LN_2).abs() < 1e-12);
    assert!((morse.dynamics() - 20.0).abs() < 1e-12);
}

#[test]
fn a_pair_that_is_too_near_separates_and_one_too_far_comes_together() {
    for (name, law) in laws() {
        assert!(law.force(0.9 * A) > 0.0, "{name}");
        assert!(law.force(1.05 * A) < 0.0, "{name}");
    }
}

#[test]
fn repulsion_alone_never_pulls_and_is_continuous_at_a() {
    let law = Repulsive(LennardJones::new(A, D).unwrap());
    for step in 1..3000 {
        assert!(law.force(A * f64::from(step) / 1000.0) >= 0.0);
    }
    // slope 72 D/a² and 1e-9 a beside it
    assert!(law.force(A * (1.0 - 1e-9)) < 1e-7 * D / A);
    assert!(law.energy(A * (1.0 - 1e-9)).abs() < 1e-14 * D);
    assert!(law.energy(A).abs() < f64::EPSILON * D);
}

/// By energy and force alone: it has no well, and so no characteristics.
#[test]
fn the_force_of_repulsion_alone_is_the_negative_derivative_of_its_energy() {
    let lj = LennardJones::new(A, D).unwrap();
    let checked = |name: &str, law: &dyn PairLaw| {
        for step in 0..2000 {
            let r = A * (0.7 + 0.6 * f64::from(step) / 2000.0);
            let expected = -derivative(|r| law.energy(r), r);
            // the force has a kink at a; differences over 4e-4 a see a slope of 72 D/a² there
            let kink = if (r - A).abs() < 1e-3 * A { 0.03 } else { 0.0 };
            let tolerance = 1e-7 * law.force(r).abs() + (1e-7 + kink) * D / A;
            assert!((law.force(r) - expected).abs() < tolerance, "{name} at {r}");
        }
    };
    checked("lj", &Repulsive(lj));
    checked("mie", &Repulsive(Mie::new(A, D, 9.0, 6.0).unwrap()));
    checked("morse", &Repulsive(Morse::new(A, D, 6.0).unwrap()));
}

/// The true force is the whole gradient of the energy, the thesis' its part along the line between
/// the particles: 5.64 and 5.65.
#[test]
fn both_cuboid_forces_are_derivatives_of_the_energy() {
    let law = CuboidLennardJones::new(A, D).unwrap();
    let mut asked = 0;
    for number in 0..4000_u32 {
        let share = |factor: f64| (f64::from(number) * factor).fract() - 0.5;
        let offset = 4.0 * A * DVec3::new(share(0.618_034), share(0.414_214), share(0.732_051));
        let mut sides = offset.abs().to_array();
        sides.sort_by(f64::total_cmp);
        // where two axes are equally far, and within a wall that is steeper than differences can tell
        if sides[2] - sides[1] < 0.01 * A || sides[2] < 0.7 * A {
            continue;
        }
        asked += 1;
        let along = |way: DVec3| -derivative(|step| law.energy(offset + step * way), 0.0);
        let gradient = law.gradient_force(offset);
        let tolerance = 1e-6 * (gradient.length() + D / A);
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            assert!(
                (gradient.dot(axis) - along(axis)).abs() < tolerance,
                "{offset}"
            );
        }
        let (radial, out) = (law.radial_force(offset), offset.normalize());
        assert!((radial.dot(out) - along(out)).abs() < tolerance, "{offset}");
        assert!(radial.cross(out).length() < 1e-12 * (radial.length() + D / A));
    }
    assert!(asked > 2000, "{asked}");
}

#[test]
fn no_distance_gives_an_infinite_or_undefined_answer() {
    let absurd = [
        0.0,
        -0.0,
        -1.0,
        1e-300,
        1e300,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
    ];
    for (name, law) in laws() {
        for r in absurd {
            assert!(
                law.energy(r).is_finite(),
                "{name}: energy at {r}: {}",
                law.energy(r)
            );
            assert!(
                law.force(r).is_finite(),
                "{name}: force at {r}: {}",
                law.force(r)
            );
        }
    }
    let cuboid = CuboidLennardJones::new(A, D).unwrap();
    for x in absurd {
        for y in absurd {
            let offset = DVec3::new(x, y, 0.1);
            assert!(cuboid.energy(offset).is_finite(), "{offset}");
            assert!(cuboid.radial_force(offset).is_finite(), "{offset}");
            assert!(cuboid.gradient_force(offset).is_finite(), "{offset}");
        }
    }
}

#[test]
fn impossible_potentials_are_refused_with_what_is_allowed() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(LennardJones::new(bad, 1.0).is_err());
        assert!(LennardJones::new(1.0, bad).is_err());
        assert!(Morse::new(1.0, 1.0, bad).is_err());
        assert!(CuboidLennardJones::new(bad, 1.0).is_err());
    }
    let refused = Mie::new(1.0, 1.0, 6.0, 12.0).unwrap_err();
    assert_eq!(refused, PotentialError::Exponents { n: 6.0, m: 12.0 });
    assert!(refused.to_string().contains("allowed: 0 < m < n"));
    let lj = LennardJones::new(1.0, 1.0).unwrap();
    assert!(Switched::new(lj, 1.0, 2.0).is_err());
    assert!(Switched::new(lj, 1.9, 1.8).is_err());
    assert!(Limited::new(lj, 1.0).is_err());
}

/// Work along a closed path: out along an axis, turned, in again, turned back.
fn work_along_a_cycle(force: impl Fn(DVec3) -> DVec3, far: f64, degrees: f64) -> f64 {
    let place = |r: f64, angle: f64| r * DVec3::new(angle.cos(), angle.sin(), 0.0);
    let angle = degrees.to_radians();
    let corners = |t: f64| match t {
        t if t < 1.0 => place(1.0 + (far - 1.0) * t, 0.0),
        t if t < 2.0 => place(far, angle * (t - 1.0)),
        t if t < 3.0 => place(far - (far - 1.0) * (t - 2.0), angle),
        t => place(1.0, angle * (4.0 - t)),
    };
    let parts = 400_000;
    (0..parts)
        .map(|i| {
            let at = |i: f64| corners(4.0 * i / f64::from(parts));
            let (before, after) = (at(f64::from(i)), at(f64::from(i) + 1.0));
            force(at(f64::from(i) + 0.5)).dot(after - before)
        })
        .sum()
}

/// The thesis' cuboid force gains work on closed paths; the gradient of the same energy does
/// not. The three figures are those of the errata, section 6.
#[test]
fn the_cuboid_force_of_the_thesis_is_not_conservative() {
    let law = CuboidLennardJones::new(1.0, 1.0).unwrap();
    for (far, degrees, expected) in [(1.1, 15.0, 0.15), (1.2, 30.0, 2.3), (1.41, 45.0, 49.8)] {
        let gained = work_along_a_cycle(|d| law.radial_force(d), far, degrees).abs();
        // the errata print two or three digits
        assert!(
            (gained / expected - 1.0).abs() < 0.05,
            "{far} {degrees}: {gained}"
        );
        let closed = work_along_a_cycle(|d| law.gradient_force(d), far, degrees).abs();
        // a midpoint rule of 4e5 parts on a path with corners
        assert!(closed < 1e-3, "gradient: {closed}");
    }
}
