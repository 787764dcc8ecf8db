//! A soft block that is pressed, as the tests here share it.

use glam::{DVec3, IVec3, UVec3};
use palpate_deform::material::{MaterialLaw, SolidSi};
use palpate_deform::registry::ModelOptions;
use palpate_engine::servo::TickRecord;
use palpate_engine::touch::Settings;
use palpate_volume::edit::SegmentId;

use crate::common::{OBSTACLE, Rig, box_segment};

pub const SIZE: UVec3 = UVec3::new(40, 40, 40);
/// Upper end of the soft block [mm].
pub const TOP: f64 = 20.0;
/// Of the ball that presses it [mm]: no smaller one does.
pub const RADIUS: f64 = 3.0;
pub const SOFT: SegmentId = SegmentId(1);

/// A soft block pressed by the default model.
pub fn lattice_rig() -> Rig {
    lattice_rig_of(2e4)
}

/// The same of another Young's modulus [Pa].
pub fn lattice_rig_of(young: f64) -> Rig {
    let mut rig = Rig::new(SIZE, DVec3::new(20.0, 20.0, 30.0));
    let soft = box_segment(SIZE, IVec3::ZERO, IVec3::new(40, 40, TOP as i32));
    rig.simulation.add_segment(soft, OBSTACLE, true).unwrap();
    let gel = SolidSi {
        young,
        poisson: 0.45,
        density: 1050.0,
        fracture_energy: f64::INFINITY,
        friction: 0.0,
        stiffening: 0.0,
    };
    let law = MaterialLaw::constant(gel).unwrap();
    rig.simulation.set_material(SOFT, Some(law), false).unwrap();
    rig.simulation
        .set_deformation(Some("lattice"), &ModelOptions::default(), false)
        .unwrap();
    let ball = Settings {
        probe_radius: RADIUS,
        ..rig.simulation.settings()
    };
    rig.simulation.set_settings(ball).unwrap();
    rig
}

/// Goes on for so many ms with the device on a line, as a session does; gives the last tick.
pub fn go(rig: &mut Rig, from: f64, to: f64, ticks: u32) -> TickRecord {
    let mut last = TickRecord::default();
    for tick in 1..=ticks {
        let share = f64::from(tick) / f64::from(ticks);
        let z = from + share * (to - from);
        let before = last.force.length();
        last = rig.tick_at(DVec3::new(20.2, 20.3, z));
        let way = (to - from).abs() / f64::from(ticks);
        // the slope of the coupling, and the hand's way: no step
        assert!(last.force.length() - before <= way + 0.1 || tick == 1);
        if tick % 10 == 0 {
            rig.simulation.step();
            rig.deformation.step();
        }
    }
    last
}

pub fn soft_voxels(rig: &Rig) -> u64 {
    rig.simulation.voxels().segment(SOFT).unwrap().count()
}
