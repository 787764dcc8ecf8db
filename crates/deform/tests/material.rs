//! Elastic constants of tissue: checks of what is given, functions of HU, presets.

use palpate_deform::material::{
    MaterialError, MaterialLaw, PRESETS, SolidSi, pair_stiffness, preset,
};

const LIVER: SolidSi = SolidSi {
    young: 5e3,
    poisson: 0.45,
    density: 1060.0,
    fracture_energy: 164.0,
    friction: 0.2,
    stiffening: 0.0,
};

/// Rounding of a few operations on doubles.
const ROUNDING: f64 = 1e-12;

#[test]
fn si_is_taken_to_newtons_and_millimetres_at_the_door() {
    let solid = LIVER.checked().expect("liver");
    assert!(
        (solid.young - 5e-3).abs() < ROUNDING,
        "5 kPa are 0.005 N/mm²"
    );
    assert!((solid.density - 1.06e-6).abs() < ROUNDING, "kg/mm³");
    assert!((solid.fracture_energy - 0.164).abs() < ROUNDING, "N/mm");
}

#[test]
fn impossible_constants_are_refused_with_what_is_allowed() {
    let refused = [
        (
            SolidSi {
                young: 0.0,
                ..LIVER
            },
            "Young",
        ),
        (
            SolidSi {
                young: -1.0,
                ..LIVER
            },
            "Young",
        ),
        (
            SolidSi {
                young: f64::NAN,
                ..LIVER
            },
            "Young",
        ),
        (
            SolidSi {
                poisson: 0.5,
                ..LIVER
            },
            "below 0.5",
        ),
        (
            SolidSi {
                poisson: f64::NAN,
                ..LIVER
            },
            "Poisson",
        ),
        (
            SolidSi {
                density: 0.0,
                ..LIVER
            },
            "density",
        ),
        (
            SolidSi {
                fracture_energy: 0.0,
                ..LIVER
            },
            "fracture",
        ),
        (
            SolidSi {
                friction: -0.1,
                ..LIVER
            },
            "friction",
        ),
        (
            SolidSi {
                stiffening: -0.1,
                ..LIVER
            },
            "stiffening",
        ),
        (
            SolidSi {
                stiffening: 101.0,
                ..LIVER
            },
            "0 to 100",
        ),
        (
            SolidSi {
                stiffening: f64::NAN,
                ..LIVER
            },
            "stiffening",
        ),
        (
            SolidSi {
                stiffening: f64::INFINITY,
                ..LIVER
            },
            "stiffening",
        ),
    ];
    for (solid, word) in refused {
        let error = solid
            .checked()
            .expect_err("an impossible constant was taken");
        let message = error.to_string();
        assert!(
            message.contains(word) && message.contains("allowed"),
            "{message}"
        );
    }
    let backwards = MaterialLaw::linear([60.0, 10.0], LIVER, LIVER);
    assert_eq!(backwards, Err(MaterialError::Interval(60.0, 10.0)));
}

#[test]
fn the_bone_of_the_thesis_is_linear_between_its_ends_and_held_beyond_them() {
    let bone = preset("thesis-bone")
        .and_then(|p| p.law())
        .expect("a preset");
    let young = |hounsfield| bone.at(hounsfield).young;
    assert!((young(700.0) - 5e3).abs() < 1e-9);
    assert!((young(3000.0) - 21e3).abs() < 1e-9);
    assert!((young(1850.0) - 13e3).abs() < 1e-9, "half the way");
    assert_eq!(young(-1000.0), young(700.0));
    assert_eq!(young(f64::INFINITY), young(3000.0));
    assert_eq!(
        young(f64::NAN),
        young(700.0),
        "an unknown intensity is the softest bone"
    );
}

/// Thesis 5.28.3.
#[test]
fn the_materials_of_the_thesis_have_its_constants_at_both_ends() {
    let told = |name: &str, young: [f64; 2], poisson: [f64; 2], density: [f64; 2], hu: [f64; 2]| {
        let law = preset(name).and_then(|p| p.law()).expect("a preset");
        for end in 0..2 {
            let si = law.at(hu[end]).si();
            let near = |found: f64, wanted: f64| assert!((found / wanted - 1.0).abs() < ROUNDING);
            near(si.young, young[end]);
            near(si.poisson, poisson[end]);
            near(si.density, density[end]);
            assert_eq!(law.at(hu[end] + [-1.0, 1.0][end]), law.at(hu[end]));
        }
        assert_ne!(
            law.at(hu[0] + 1.0),
            law.at(hu[0]),
            "{name} follows HU between"
        );
    };
    told(
        "thesis-bone",
        [5e9, 21e9],
        [0.30, 0.32],
        [920.0, 1900.0],
        [700.0, 3000.0],
    );
    told(
        "thesis-soft-tissue",
        [3.4e4, 3.5e4],
        [0.47, 0.48],
        [1100.0, 1200.0],
        [10.0, 60.0],
    );
}

#[test]
fn friction_of_a_surface_is_the_mean_of_the_ends() {
    let rough = |friction: f64| SolidSi { friction, ..LIVER };
    let law = MaterialLaw::linear([0.0, 10.0], rough(0.1), rough(0.4)).expect("a law");
    assert!((law.friction() - 0.25).abs() < ROUNDING);
    let law = MaterialLaw::constant(rough(0.4)).expect("a law");
    assert!((law.friction() - 0.4).abs() < ROUNDING);
}

#[test]
fn trabecular_bone_follows_the_power_of_its_density() {
    let bone = preset("trabecular-bone")
        .and_then(|p| p.law())
        .expect("a preset");
    for hounsfield in [100.0, 400.0, 900.0] {
        let solid = bone.at(hounsfield);
        let expected = 6850.0 * (solid.density * 1e6).powf(1.49);
        assert!((solid.young / expected - 1.0).abs() < ROUNDING);
    }
}

#[test]
fn every_preset_is_matter_and_says_where_its_numbers_come_from() {
    for preset in PRESETS {
        let law = preset.law().expect(preset.name);
        let solid = law.at(500.0);
        assert!(solid.young > 0.0 && solid.poisson < 0.5, "{}", preset.name);
        assert!(preset.source.len() > 20, "{}", preset.name);
        let [least, most] = preset.young_range;
        let within = |young: f64| (0.99 * least..=1.01 * most).contains(&young);
        let ends = law.ends().map(|solid| solid.si().young);
        assert!(
            least < most && ends.into_iter().all(within),
            "{}",
            preset.name
        );
    }
    // what people press
    for organ in [
        "skin",
        "fat",
        "muscle",
        "liver",
        "kidney",
        "spleen",
        "brain",
        "breast",
        "prostate",
        "vessel-wall",
        "lung",
        "cartilage",
        "tumour",
    ] {
        let law = preset(organ).expect(organ).law().expect(organ);
        assert!(!law.needs_hounsfield(), "{organ}");
    }
    assert!(preset("cheese").is_err());
}

#[test]
fn two_half_bonds_in_series_are_as_stiff_as_twice_the_softer_at_most() {
    assert!((pair_stiffness(3.0, 3.0) - 3.0).abs() < ROUNDING);
    let interface = pair_stiffness(21e3, 0.035);
    assert!(
        (interface / 0.07 - 1.0).abs() < 1e-5,
        "twice the soft one beside bone"
    );
    assert_eq!(pair_stiffness(0.0, 5.0), 0.0);
    assert_eq!(pair_stiffness(0.0, 0.0), 0.0);
}
