//! What does not come back: breaking, yield, fading force; and contact of what is not bonded.

use crate::support::{block, solid};
use glam::{DVec3, UVec3};
use palpate_deform::lattice::{
    Border, Inelastic, InelasticSettings, Lattice, NodeMaterial, Prony, RelaxSettings, Relaxer,
};
use palpate_deform::material::Solid;

/// A bar along z, both ends of which are held.
fn bar(solid: Solid) -> Lattice {
    let mut lattice = block(UVec3::new(3, 3, 9), solid);
    for (node, index) in lattice.layout().nodes() {
        if node.z == 0 || node.z == 8 {
            (0..3).for_each(|axis| lattice.hold(index, axis, true));
        }
    }
    lattice
}

/// Pulls the bar to a strain, relaxes, and returns the tension [N].
fn pull(lattice: &mut Lattice, strain: f64) -> f64 {
    let layout = *lattice.layout();
    for (_, index) in layout.nodes().filter(|(node, _)| node.z == 8) {
        lattice.set_moved(index, DVec3::Z * (8.0 * strain));
    }
    let settings = RelaxSettings {
        tolerance: 1e-8,
        iterations: 4000,
        reference: 1.0,
    };
    Relaxer::default().relax(lattice, &[], &settings, &|| false);
    let top = layout.nodes().filter(|(node, _)| node.z == 8);
    -top.map(|(_, index)| lattice.force(index).z).sum::<f64>()
}

/// The fracture energy [N·mm/mm²] with which bonds of this length break at a strain.
fn for_breaking_strain(strain: f64, spacing: f64) -> f64 {
    4.5 * solid(0.25).shear() * spacing * strain * strain
}

/// Tears a block of 24 mm off the plate that it stands on, of which it is or which is rigid, and gives
/// the work for the area [N·mm/mm²].
fn work_of_tearing(spacing: f64, fracture_energy: f64, tissue: Solid, on_rigid: bool) -> f64 {
    let count = (24.0 / spacing) as u32;
    let size = UVec3::new(count, count, 4);
    let mut lattice = Lattice::new(size, spacing, Border::Free, |node| {
        let inside = node.cmpge(glam::IVec3::ZERO).all() && node.cmplt(size.as_ivec3()).all();
        // between the lowest two layers
        let weak = match on_rigid {
            true => 1,
            false => 0,
        };
        let matter = Solid {
            fracture_energy: match node.z == weak {
                true => fracture_energy,
                false => f64::INFINITY,
            },
            ..tissue
        };
        match (inside, node.z) {
            (false, _) => NodeMaterial::Empty,
            (true, 0) if on_rigid => NodeMaterial::Rigid(Solid {
                young: 1e6,
                ..matter
            }),
            (true, _) => NodeMaterial::Deformable(matter),
        }
    });
    let layout = *lattice.layout();
    // on a rigid plate the layer above the weak one is held, so that only bonds to the plate can tear
    let top = |z: u32| {
        if on_rigid {
            (1..=3).contains(&z)
        } else {
            z == 3
        }
    };
    let ends: Vec<_> = layout
        .nodes()
        .filter(|(node, _)| node.z == 0 || top(node.z))
        .collect();
    for (_, index) in &ends {
        (0..3).for_each(|axis| lattice.hold(*index, axis, true));
    }
    let mut inelastic = Inelastic::new(&mut lattice, InelasticSettings::default());
    let strain = (fracture_energy / (4.5 * tissue.shear() * spacing)).sqrt();
    let settings = RelaxSettings {
        tolerance: 1e-4,
        iterations: 1000,
        reference: 1e-3,
    };
    let mut work = 0.0;
    for step in 1..=80 {
        let up = 0.1 * f64::from(step) * strain * spacing;
        for (_, index) in ends.iter().filter(|(node, _)| top(node.z)) {
            lattice.set_moved(*index, DVec3::Z * up);
        }
        loop {
            Relaxer::default().relax(&mut lattice, &[], &settings, &|| false);
            let breaking = inelastic.break_and_yield(&mut lattice, true, |_| false);
            work += breaking.work;
            if breaking.count == 0 {
                break;
            }
        }
    }
    work / (24.0 * 24.0)
}

#[test]
fn a_tear_takes_the_fracture_energy_at_any_spacing() {
    let wanted = for_breaking_strain(0.1, 2.0);
    for spacing in [1.0, 2.0, 4.0] {
        let share = work_of_tearing(spacing, wanted, solid(0.25), false) / wanted;
        // nodes at the sides of the block have fewer bonds
        assert!((0.85..1.15).contains(&share), "{spacing} mm: {share}");
        let from_rigid = work_of_tearing(spacing, wanted, solid(0.25), true) / wanted;
        assert!(
            (0.85..1.15).contains(&from_rigid),
            "{spacing} mm: {from_rigid}"
        );
    }
    // where the volume is nearly kept, its pressure is part of it
    let [fine, middle, coarse] = [1.0, 2.0, 4.0]
        .map(|spacing| work_of_tearing(spacing, wanted, solid(0.45), false) / wanted);
    println!("nu 0.45: {:?}", [fine, middle, coarse]);
    for share in [fine / middle, coarse / middle] {
        assert!((0.85..1.15).contains(&share), "{share}");
    }
    assert!((0.85..1.15).contains(&middle), "{middle}");
}

/// Stiffened bonds hold the same energy at less strain.
#[test]
fn a_tear_of_tissue_that_stiffens_takes_the_fracture_energy_at_any_spacing() {
    let wanted = for_breaking_strain(0.1, 2.0);
    for (poisson, stiffening) in [(0.25, 8.0), (0.45, 8.0)] {
        let tissue = Solid {
            stiffening,
            ..solid(poisson)
        };
        let shares =
            [1.0, 2.0, 4.0].map(|spacing| work_of_tearing(spacing, wanted, tissue, false) / wanted);
        println!("nu {poisson}, b {stiffening}: {shares:?}");
        let [fine, middle, coarse] = shares;
        for share in [fine / middle, coarse / middle] {
            assert!((0.85..1.15).contains(&share), "{shares:?}");
        }
        assert!((0.85..1.2).contains(&middle), "{shares:?}");
    }
}

#[test]
fn bonds_break_at_their_strain_and_their_work_is_what_was_stored_in_them() {
    let brittle = Solid {
        fracture_energy: for_breaking_strain(0.05, 1.0),
        ..solid(0.25)
    };
    let mut lattice = bar(brittle);
    let mut inelastic = Inelastic::new(&mut lattice, InelasticSettings::default());
    pull(&mut lattice, 0.04);
    assert_eq!(
        inelastic
            .break_and_yield(&mut lattice, true, |_| true)
            .count,
        0,
        "not yet"
    );

    let tension = pull(&mut lattice, 0.10);
    let stored = lattice.energy();
    let breaking = inelastic.break_and_yield(&mut lattice, true, |_| true);
    assert!(breaking.count > 0 && tension > 0.0);
    // what broke was in the bonds before; 1e-9 is rounding
    assert!((stored - lattice.energy() - breaking.work).abs() < 1e-9 * stored);
    // edge bonds are stretched half as much as the bar, and hold longer
    for _ in 0..20 {
        pull(&mut lattice, 0.3);
        inelastic.break_and_yield(&mut lattice, true, |_| true);
    }
    let left = pull(&mut lattice, 0.3);
    assert!(
        left.abs() < 0.1 * tension,
        "it is torn: {left} of {tension}"
    );
}

#[test]
fn matter_that_yields_stays_longer_and_elastic_matter_returns() {
    for (yield_strain, stays) in [(None, false), (Some(0.02), true)] {
        let mut lattice = bar(solid(0.25));
        let settings = InelasticSettings {
            yield_strain,
            prony: None,
        };
        let mut inelastic = Inelastic::new(&mut lattice, settings);
        pull(&mut lattice, 0.08);
        inelastic.break_and_yield(&mut lattice, true, |_| true);
        let tension = pull(&mut lattice, 0.0);
        if stays {
            assert!(tension < -0.05, "what became longer pushes back: {tension}");
        } else {
            assert!(tension.abs() < 1e-6, "{tension}");
        }
    }
}

#[test]
fn a_share_of_the_force_fades_and_the_asked_stiffness_stays() {
    let elastic = pull(&mut bar(solid(0.25)), 0.01);
    let mut lattice = bar(solid(0.25));
    let prony = Some(Prony {
        share: 0.5,
        time: 0.2,
    });
    let mut inelastic = Inelastic::new(
        &mut lattice,
        InelasticSettings {
            yield_strain: None,
            prony,
        },
    );
    let first = pull(&mut lattice, 0.01);
    assert!(
        (first / elastic - 2.0).abs() < 0.01,
        "half of it is yet to fade"
    );
    for _ in 0..40 {
        inelastic.fade(&mut lattice, 0.1);
        pull(&mut lattice, 0.01);
    }
    let last = pull(&mut lattice, 0.01);
    // 20 time constants
    assert!((last / elastic - 1.0).abs() < 1e-3, "{last} {elastic}");
}

#[test]
fn bodies_that_are_not_bonded_push_each_other() {
    // two slabs with an empty layer between them; the upper one is moved onto the lower
    let size = UVec3::new(5, 5, 7);
    let mut lattice = Lattice::new(size, 1.0, Border::Free, |node| {
        let inside = node.cmpge(glam::IVec3::ZERO).all() && node.cmplt(size.as_ivec3()).all();
        match inside && node.z != 3 {
            true => NodeMaterial::Deformable(solid(0.25)),
            false => NodeMaterial::Empty,
        }
    });
    let layout = *lattice.layout();
    for (node, index) in layout.nodes() {
        if node.z > 3 {
            lattice.set_moved(index, DVec3::new(0.0, 0.0, -1.3));
        }
        if node.z == 0 || node.z == 6 {
            (0..3).for_each(|axis| lattice.hold(index, axis, true));
        }
    }
    let settings = RelaxSettings {
        tolerance: 1e-7,
        iterations: 4000,
        reference: 1.0,
    };
    Relaxer::default().relax(&mut lattice, &[], &settings, &|| false);
    let height = |z| lattice.place(layout.index(UVec3::new(2, 2, z))).z;
    let gap = height(4) - height(2);
    assert!(
        gap > 0.85,
        "0.7 without contact, 1 where they begin to touch: {gap}"
    );
    let force = |z| -> f64 {
        let layer = layout.nodes().filter(|(node, _)| node.z == z);
        layer.map(|(_, index)| lattice.force(index).z).sum()
    };
    assert!(
        force(6) > 0.1 && (force(6) + force(0)).abs() < 1e-3 * force(6),
        "{}",
        force(6)
    );
}
