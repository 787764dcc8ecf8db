//! The friction of what a segment is made of, felt by a tool that slides over it.

use glam::{DVec3, IVec3, UVec3};
use palpate_deform::material::{MaterialLaw, SolidSi};
use palpate_engine::servo::TickRecord;
use palpate_engine::touch::TouchFeel;

use super::soft_block::{SIZE, SOFT, TOP, go, lattice_rig};
use crate::common::{OBSTACLE, Rig, box_segment};

/// A probe that slides is held back by this fraction of what holds one that sticks.
const SLIDES: f64 = 0.8;

/// As soft as the block, with a friction.
fn rough(friction: f64) -> Option<MaterialLaw> {
    let gel = SolidSi {
        young: 2e4,
        poisson: 0.45,
        density: 1050.0,
        fracture_energy: f64::INFINITY,
        friction,
        stiffening: 0.0,
    };
    MaterialLaw::constant(gel).ok()
}

fn own(friction_static: f64, friction_kinetic: f64) -> TouchFeel {
    TouchFeel {
        stiffness: None,
        friction_static: Some(friction_static),
        friction_kinetic: Some(friction_kinetic),
    }
}

/// Slides along x at 10 mm/s; gives the lateral force, backward, for that along z.
fn slide(rig: &mut Rig, from: &mut DVec3, way: f64) -> f64 {
    let ticks = (100.0 * way) as u32;
    let mut last = TickRecord::default();
    for tick in 0..ticks {
        from.x += 0.01;
        last = rig.tick_at(*from);
        if tick % 10 == 0 {
            rig.simulation.step();
            rig.deformation.step();
        }
    }
    -last.force.x / last.force.z
}

#[test]
fn hard_matter_holds_a_probe_back_by_its_friction_unless_the_segment_has_its_own() {
    let size = UVec3::new(60, 20, 30);
    let mut rig = Rig::new(size, DVec3::new(5.2, 10.3, 25.0));
    let block = box_segment(size, IVec3::ZERO, IVec3::new(60, 20, TOP as i32));
    rig.simulation.add_segment(block, OBSTACLE, true).unwrap();
    let mut device = DVec3::new(5.2, 10.3, TOP - 1.0);
    for z in 0..600 {
        rig.tick_at(device.with_z(25.0 - 0.01 * f64::from(z)));
    }
    let close = |felt: f64, wanted: f64| assert!((felt - wanted).abs() < 1e-3, "{felt} {wanted}");
    close(slide(&mut rig, &mut device, 3.0), 0.0);

    rig.simulation.set_material(SOFT, rough(0.3), true).unwrap();
    close(slide(&mut rig, &mut device, 3.0), SLIDES * 0.3);
    rig.simulation.set_material(SOFT, rough(0.5), true).unwrap();
    close(slide(&mut rig, &mut device, 3.0), SLIDES * 0.5);
    // a person's own counts more, and leaves the material's behind it
    rig.simulation.set_feel(SOFT, own(0.2, 0.1)).unwrap();
    close(slide(&mut rig, &mut device, 3.0), 0.1);
    rig.simulation.set_feel(SOFT, TouchFeel::default()).unwrap();
    close(slide(&mut rig, &mut device, 3.0), SLIDES * 0.5);
    // what no probe is held back by more
    rig.simulation.set_material(SOFT, rough(9.0), true).unwrap();
    close(slide(&mut rig, &mut device, 6.0), SLIDES * 2.0);

    for before in [0.5, 0.3] {
        assert!(rig.simulation.undo().unwrap());
        close(slide(&mut rig, &mut device, 3.0), SLIDES * before);
    }
    assert!(rig.simulation.undo().unwrap());
    close(slide(&mut rig, &mut device, 3.0), 0.0);
    assert!(rig.simulation.redo().unwrap());
    close(slide(&mut rig, &mut device, 3.0), SLIDES * 0.3);
    rig.simulation.set_material(SOFT, None, true).unwrap();
    close(slide(&mut rig, &mut device, 3.0), 0.0);
    assert_eq!(rig.violations(), 0);
}

#[test]
fn matter_that_gives_way_holds_a_tool_back_by_its_friction() {
    let felt = |friction: f64, feel: TouchFeel| {
        let mut rig = lattice_rig();
        let law = rough(friction);
        rig.simulation.set_material(SOFT, law, false).unwrap();
        rig.simulation.set_feel(SOFT, feel).unwrap();
        go(&mut rig, 30.0, 21.2, 900);
        let mut device = DVec3::new(20.2, 20.3, 21.2);
        let ratio = slide(&mut rig, &mut device, 4.0);
        assert_eq!(rig.violations(), 0);
        assert!(SIZE.x as f64 > device.x + 5.0);
        ratio
    };
    // tissue heaps up before the tool a little
    let smooth = felt(0.0, TouchFeel::default());
    assert!(smooth.abs() < 0.06, "{smooth}");
    for friction in [0.2, 0.4] {
        let rough = felt(friction, TouchFeel::default());
        assert!((rough - smooth - SLIDES * friction).abs() < 0.05, "{rough}");
    }
    let slippery = felt(0.4, own(0.0, 0.0));
    assert!((slippery - smooth).abs() < 1e-9, "{slippery} {smooth}");
}
