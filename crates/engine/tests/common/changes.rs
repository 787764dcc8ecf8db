//! What can happen to a session between two ticks, at random.

use glam::{DAffine3, DMat3};
use palpate_deform::material::{MaterialLaw, SolidSi};
use palpate_engine::servo::HandTarget;
use palpate_engine::touch::{Settings, TouchFeel};
use palpate_haptics::smooth::Smoothing;
use palpate_volume::clip::{Clip, Plane};
use palpate_volume::edit::SegmentId;

use super::*;

/// An edit, a root, undo, a move, a clip, a placement, a view, settings, a feel, a material, a hand target, or
/// nothing.
pub fn change_something(rig: &mut Rig, ids: &[SegmentId; 2], random: &mut Random) {
    let id = ids[random.below(2) as usize];
    let dimensions = rig.simulation.voxels().grid().dimensions();
    let simulation = &mut rig.simulation;
    match random.below(60) {
        0 if random.below(2) == 0 => {
            let low = random.between(50.0, 700.0);
            rig.set_threshold(id, (low, low + random.between(100.0, 2000.0)));
        }
        0 => {
            let other = sponge(dimensions, random.below(99), 2 + random.below(9));
            simulation.replace_segment(id, other, None).unwrap();
        }
        1..=9 => {
            let solid = random.below(2) == 0;
            let region = random.voxel_box(dimensions, 40);
            simulation.fill_box(id, &region, solid).unwrap();
        }
        10..=14 => _ = simulation.undo().unwrap(),
        15 => _ = simulation.redo().unwrap(),
        16 => simulation.set_touchable(id, random.below(2) == 0).unwrap(),
        17 => _ = simulation.place(random.point(0.0, 48.0), 0, random.below(2) == 0),
        18 => {
            let angle = random.between(-3.0, 3.0);
            simulation.turn(DMat3::from_rotation_z(angle));
        }
        19 => {
            let friction = random.between(0.0, 0.8);
            let radius = random.between(-2.0, 2.0).max(0.0);
            let settings = Settings {
                stiffness: random.between(0.1, 0.9),
                damping: random.between(0.0, 0.01),
                friction_static: friction,
                friction_kinetic: friction * random.share(),
                smoothing: Smoothing::ALL[random.below(3) as usize],
                probe_radius: radius,
                ..Settings::default()
            };
            simulation.set_settings(settings).unwrap();
        }
        20 => {
            let feel = TouchFeel {
                stiffness: Some(random.between(0.1, 0.9)),
                friction_static: Some(random.share()),
                friction_kinetic: Some(0.0),
            };
            simulation.set_feel(id, feel).unwrap();
        }
        22 => {
            let turn = DMat3::from_rotation_z(random.between(-0.4, 0.4));
            let pose = DAffine3::from_mat3_translation(turn, random.point(-4.0, 4.0));
            simulation.move_segment(id, pose).unwrap();
        }
        23 => {
            let solid = SolidSi {
                young: 1e6,
                poisson: 0.3,
                density: 1000.0,
                fracture_energy: f64::INFINITY,
                friction: random.share(),
                stiffening: 0.0,
            };
            let law = MaterialLaw::constant(solid).ok();
            simulation.set_material(id, law, true).unwrap();
        }
        24 => {
            let normal = random.point(-1.0, 1.0).normalize_or(glam::DVec3::X);
            let offset = normal.dot(random.point(8.0, 40.0));
            let planes = (random.below(3) > 0).then_some(Plane { normal, offset });
            simulation.set_clip(Clip::new(planes.into_iter().collect()).unwrap());
        }
        21 => rig.hand.write(HandTarget {
            point: random.point(0.0, 48.0),
            number: random.below(5),
        }),
        _ => {}
    }
}
