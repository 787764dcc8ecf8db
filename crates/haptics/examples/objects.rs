//! How near to the ideal point comes the proxy in wedges and corners of several bodies?
//!
//! One to three ideal planes, each that of a body of its own at an angle of its own, as
//! voxels of cubes and of thick slices. A device moves 0.2 of the smallest spacing h per
//! update, 5 h below the line (or the corner) where they meet, then rests. Printed is how far
//! the proxy is from the nearest point outside the ideal planes, in h: mean, 95 %, largest;
//! the longest way of the device while the proxy stood still; the time of an update and the voxels it reads; and how
//! far the proxy moves once the device has rested for 16 ticks. The figures are those of
//! `docs/decisions/objects.md`. Takes some 20 seconds:
//!
//!     cargo run --release -p palpate-haptics --example objects
#![expect(clippy::print_stdout, reason = "a table is what this example is for")]

#[path = "../tests/support/mod.rs"]
mod support;

use std::time::Instant;

use glam::{DAffine3, DMat3, DVec3, IVec3, UVec3};
use palpate_haptics::contact::{ContactModel, Exact, Proxy};
use palpate_haptics::scene::{Object, ObjectPose, TouchScene};
use palpate_volume::occupancy::Occupancy;
use palpate_volume::voxel_box::VoxelBox;
use support::{Body, Random, SPACINGS, grid, nearest_outside, open_normals, rotation};

/// Updates of one path, and paths of one row.
const UPDATES: usize = 400;
const PATHS: usize = 60;
/// Way of the device per update, and its depth [h].
const STEP: f64 = 0.2;
const DEPTH: f64 = 5.0;

/// Half of the space, as voxels of a grid with its corner at zero: in an object's own axes, or
/// in those of the world.
fn half_space(normal: DVec3, offset: f64, spacing: DVec3) -> Box<dyn Occupancy> {
    Box::new(Body(move |voxel: IVec3| {
        ((voxel.as_dvec3() + 0.5) * spacing).dot(normal) <= offset
    }))
}

/// What was measured.
#[derive(Default)]
struct Figures {
    lags: Vec<f64>,
    stood: f64,
    jitter: f64,
    /// Of single updates.
    seconds: Vec<f64>,
    visits: u64,
    most_visits: u32,
}

/// One path below the planes, which all pass zero; the first body is the world if asked.
fn follow(spacings: &[DVec3], in_world: bool, random: &mut Random, figures: &mut Figures) {
    let h = spacings
        .iter()
        .fold(f64::INFINITY, |h, s| h.min(s.min_element()));
    let normals = open_normals(spacings.len(), random);
    let world_grid = grid(UVec3::splat(8), spacings[0]);
    let grids: Vec<_> = spacings.iter().map(|&s| grid(UVec3::splat(8), s)).collect();
    let turns: Vec<DMat3> = normals.iter().map(|_| rotation(random)).collect();
    let places: Vec<DVec3> = normals.iter().map(|_| random.point(-5.0, 5.0)).collect();
    let bodies: Vec<Box<dyn Occupancy>> = (0..normals.len())
        .map(|i| {
            let offset = -normals[i].dot(places[i]);
            half_space(turns[i].transpose() * normals[i], offset, spacings[i])
        })
        .collect();
    let ground = half_space(normals[0], 0.0, spacings[0]);
    let nothing: Box<dyn Occupancy> = Box::new(Body(|_: IVec3| false));
    let everywhere = VoxelBox::new(IVec3::splat(-900), IVec3::splat(900));
    let objects: Vec<Object<&dyn Occupancy>> = (usize::from(in_world)..normals.len())
        .map(|i| {
            let pose = ObjectPose::new(
                &grids[i],
                &world_grid,
                DAffine3::from_mat3_translation(turns[i], places[i]),
            );
            Object::new(
                &*bodies[i],
                &grids[i],
                everywhere,
                pose.expect("a rigid pose"),
            )
        })
        .collect();
    let world: &dyn Occupancy = if in_world { &*ground } else { &*nothing };
    let scene = TouchScene {
        occupancy: &world,
        grid: &world_grid,
        objects: &objects,
    };

    // along the crease of two planes, else in a circle
    let along = match normals[..] {
        [first, second] => Some(first.cross(second).normalize()),
        _ => None,
    };
    let side = DVec3::Z.any_orthonormal_vector();
    let path = |update: usize| {
        let way = update as f64 * STEP;
        let down = DVec3::Z * -DEPTH;
        let turn = DMat3::from_rotation_z(way / 4.0) * side * 4.0;
        h * (down + along.map_or(turn, |along| along * (way - UPDATES as f64 * STEP / 2.0)))
    };
    let start = path(0) + DVec3::Z * 60.0 * h;
    if scene.solid_at(start / spacings[0]).is_some() {
        return;
    }
    let mut proxy = Proxy::at(start / spacings[0]).expect("a finite point");
    let mut stood_since = path(0);
    for update in 0..UPDATES {
        let device = path(update);
        let before = proxy;
        let clock = Instant::now();
        let contact = Exact::default().advance(&scene, device / spacings[0], &mut proxy);
        figures.seconds.push(clock.elapsed().as_secs_f64());
        figures.visits += u64::from(contact.visits);
        figures.most_visits = figures.most_visits.max(contact.visits);
        assert!(scene.solid_at(proxy.point()).is_none());
        if proxy != before || update < 50 {
            stood_since = device;
        }
        figures.stood = figures.stood.max(device.distance(stood_since) / h);
        if update >= 50 {
            let ideal = nearest_outside(&normals, device);
            figures
                .lags
                .push((proxy.point() * spacings[0]).distance(ideal) / h);
        }
    }
    for tick in 0..40 {
        let before = proxy.point();
        Exact::default().advance(&scene, path(UPDATES - 1) / spacings[0], &mut proxy);
        if tick >= 16 {
            let moved = ((proxy.point() - before) * spacings[0]).length() / h;
            figures.jitter = figures.jitter.max(moved);
        }
    }
}

fn main() {
    let kinds = [
        ("1 mm cubes", [DVec3::ONE; 3]),
        (
            "1, 0.8, 0.7×0.7×2.5",
            [DVec3::ONE, DVec3::splat(0.8), SPACINGS[1]],
        ),
        ("0.7×0.7×2.5 mm", [SPACINGS[1]; 3]),
    ];
    println!(
        "bodies | planes | world holds one | lag [h] mean / 95 % / largest | stood [h] | µs median / 99 % | voxels mean / most | jitter"
    );
    for (name, spacings) in kinds {
        for planes in 1..=3 {
            for in_world in [true, false] {
                let mut random = Random::new(7);
                let mut figures = Figures::default();
                for _ in 0..PATHS {
                    follow(&spacings[..planes], in_world, &mut random, &mut figures);
                }
                let lags = &mut figures.lags;
                lags.sort_by(f64::total_cmp);
                figures.seconds.sort_by(f64::total_cmp);
                let mean = lags.iter().sum::<f64>() / lags.len() as f64;
                println!(
                    "{name} | {planes} | {in_world} | {mean:.2} / {:.2} / {:.2} | {:.1} | {:.1} / {:.1} | {} / {} | {}",
                    lags[lags.len() * 95 / 100],
                    lags[lags.len() - 1],
                    figures.stood,
                    1e6 * figures.seconds[figures.seconds.len() / 2],
                    1e6 * figures.seconds[figures.seconds.len() * 99 / 100],
                    figures.visits / figures.seconds.len() as u64,
                    figures.most_visits,
                    figures.jitter
                );
            }
        }
    }
}
