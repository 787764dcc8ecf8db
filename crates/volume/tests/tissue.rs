//! Tissues that a needle meets.

use palpate_volume::tissue::Tissue;

#[test]
fn every_preset_is_a_tissue_and_is_found_by_its_name() {
    for (name, tissue) in Tissue::PRESETS {
        assert_eq!(tissue.check(), Ok(()), "{name}");
        assert_eq!(Tissue::by_name(name), Some(tissue));
        // the force must fall where the tip goes in
        assert!(tissue.cutting < tissue.puncture, "{name}");
    }
    assert_eq!(Tissue::by_name("bone"), None);
}

#[test]
fn deflection_and_force_are_inverse_to_one_another() {
    let straight = Tissue {
        quadratic: 0.0,
        ..Tissue::FAT
    };
    for tissue in [Tissue::SKIN, Tissue::LIVER, straight] {
        for force in [1e-9, 0.01, 0.5, 2.0, 30.0] {
            let back = tissue.force(tissue.deflection(force));
            // a square root and four products
            assert!((back - force).abs() <= 1e-12 * force, "{force} {back}");
        }
        assert_eq!(tissue.force(-1.0), 0.0);
        assert_eq!(tissue.deflection(-1.0), 0.0);
    }
}

#[test]
fn a_tissue_that_is_none_is_refused_by_name() {
    let skin = Tissue::SKIN;
    for (bad, what) in [
        (
            Tissue {
                linear: 0.0,
                ..skin
            },
            "stiffness",
        ),
        (
            Tissue {
                puncture: f64::NAN,
                ..skin
            },
            "puncture",
        ),
        (
            Tissue {
                cutting: 2.1,
                ..skin
            },
            "cutting",
        ),
        (
            Tissue {
                relaxation: 1.1,
                ..skin
            },
            "relaxation",
        ),
        (
            Tissue {
                friction: -0.1,
                ..skin
            },
            "friction",
        ),
    ] {
        let error = bad.check().expect_err("no tissue");
        assert!(error.what.starts_with(what), "{error}");
    }
}
