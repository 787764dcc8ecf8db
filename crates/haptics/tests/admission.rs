//! Voxels may change under the probe only where its body stays free.

use crate::support::{Body, Components, Random, SPACINGS, grid, noise, rotation};
use glam::{DAffine3, DVec3, IVec3, UVec3};
use palpate_haptics::admission::{Admission, PUSH_REACH, admit, admit_scene, nearest_free};
use palpate_haptics::contact::{ContactModel, Exact, Proxy};
use palpate_haptics::scene::{Object, ObjectPose, TouchScene};
use palpate_volume::occupancy::Occupancy;
use palpate_volume::segment::Segment;

const SIZE: u32 = 24;

fn at(x: f64, y: f64, z: f64) -> Proxy {
    Proxy::at(DVec3::new(x, y, z)).expect("a finite point")
}

#[test]
fn a_change_elsewhere_moves_nothing() {
    let floor = Body(|v: IVec3| v.z < 4);
    let higher = Body(|v: IVec3| v.z < 5);
    let grid = grid(UVec3::splat(16), DVec3::ONE);
    let start = at(8.5, 8.5, 5.25);
    let mut proxy = start;
    assert_eq!(admit(&floor, &higher, &grid, &mut proxy), Admission::Free);
    assert_eq!(proxy, start);
}

#[test]
fn a_voxel_filled_where_the_probe_stands_pushes_it_up() {
    let floor = Body(|v: IVec3| v.z < 4);
    let filled = Body(|v: IVec3| v.z < 4 || v == IVec3::new(8, 8, 4));
    let grid = grid(UVec3::splat(16), DVec3::ONE);
    // nearest to the face at x = 9
    let mut proxy = at(8.9, 8.5, 4.3);
    let voxel = IVec3::new(9, 8, 4);
    let admission = admit(&floor, &filled, &grid, &mut proxy);
    assert_eq!(admission, Admission::Pushed { voxel });
    assert_eq!(proxy.voxel(), voxel);
}

#[test]
fn the_way_out_never_leads_through_what_was_solid() {
    // a closed box, 3 wide inside; the change fills it, and outside is free and near
    let within = |v: IVec3, half: i32| (v - 8).abs().max_element() <= half;
    let closed = Body(move |v| within(v, 2) && !within(v, 1));
    let filled = Body(move |v| within(v, 2));
    let grid = grid(UVec3::splat(16), DVec3::ONE);
    let start = at(8.5, 8.5, 8.5);
    let mut proxy = start;
    assert_eq!(admit(&closed, &filled, &grid, &mut proxy), Admission::Held);
    assert_eq!(proxy, start);

    // with a hole of one voxel there is a way
    let open = Body(move |v: IVec3| within(v, 2) && !within(v, 1) && v != IVec3::new(8, 8, 10));
    let admission = admit(&open, &filled, &grid, &mut proxy);
    let voxel = IVec3::new(8, 8, 11);
    assert_eq!(admission, Admission::Pushed { voxel });
}

#[test]
fn the_probe_is_not_pushed_further_than_the_window() {
    let grid = grid(UVec3::splat(64), DVec3::ONE);
    let empty = Segment::empty(UVec3::splat(64));
    for (reach, admitted) in [(PUSH_REACH, true), (PUSH_REACH + 1, false)] {
        let ball = Body(move |v: IVec3| (v - 30).abs().max_element() < reach);
        let mut proxy = at(30.5, 30.5, 30.5);
        let admission = admit(&empty, &ball, &grid, &mut proxy);
        assert_eq!(admission != Admission::Held, admitted, "{admission:?}");
    }
}

/// A wall that grows over the probe near its rim does not carry it to the far side.
#[test]
fn the_probe_is_pushed_along_the_shortest_way_not_to_the_nearest_point() {
    let wall = Body(|v: IVec3| v.z == 8 && v.x < 12);
    let thicker = Body(|v: IVec3| (8..=11).contains(&v.z) && v.x < 12);
    for spacing in SPACINGS {
        let grid = grid(UVec3::splat(16), spacing);
        let mut proxy = at(9.5, 8.5, 9.1);
        // below the wall it would be 1.1 voxels away, above 2.9
        let admission = admit(&wall, &thicker, &grid, &mut proxy);
        assert_ne!(admission, Admission::Held);
        assert!(proxy.voxel().z >= 12 || proxy.voxel().x >= 12, "{proxy:?}");
    }
}

/// 20 000 edits under a moving probe: boxes filled and cleared around it, and whole segments
/// switched. What is admitted leaves it free, on a way that was open before; what is held
/// changes nothing; and no tick ever finds it inside.
#[test]
fn edits_while_touching_never_put_the_probe_inside() {
    let mut random = Random::new(12);
    let mut counts = [0; 3];
    for spacing in SPACINGS {
        let grid = grid(UVec3::splat(SIZE), spacing);
        let mut solid = noise(SIZE, 0.3, 1);
        let other = noise(SIZE, 0.4, 2);
        let mut proxy = nearest_free(&solid, &grid, DVec3::splat(12.0), 9).expect("free");
        for edit in 0..10_000 {
            let device = proxy.point() + random.direction() * random.between(0.0, 6.0);
            let device = device.clamp(DVec3::splat(6.0), DVec3::splat(18.0));
            let contact =
                Exact::default().advance(&TouchScene::of_world(&solid, &grid), device, &mut proxy);
            assert!(!contact.violation && !solid.is_solid(proxy.voxel()));

            let new = changed(&solid, &other, &proxy, edit, &mut random);
            let before = proxy;
            match admit(&solid, &new, &grid, &mut proxy) {
                Admission::Free => {
                    counts[0] += 1;
                    assert_eq!(proxy, before);
                    solid = new;
                }
                Admission::Pushed { voxel } => {
                    counts[1] += 1;
                    assert_eq!(proxy.voxel(), voxel);
                    let components = Components::of(&solid, UVec3::splat(SIZE));
                    let [from, to] = [before, proxy].map(|p| components.label(p.voxel()));
                    assert!(
                        from != 0 && from == to,
                        "no way from {before:?} to {proxy:?}"
                    );
                    solid = new;
                }
                Admission::Held => {
                    counts[2] += 1;
                    assert_eq!(proxy, before);
                }
            }
            assert!(!solid.is_solid(proxy.voxel()));
            assert_eq!(proxy.point().floor().as_ivec3(), proxy.voxel());
        }
    }
    // the test means something only if all three happen
    assert!(counts.iter().all(|&count| count > 100), "{counts:?}");
}

/// The solid voxels after an edit: a box near the probe, or another segment.
fn changed(
    solid: &Segment,
    other: &Segment,
    proxy: &Proxy,
    edit: u32,
    random: &mut Random,
) -> Segment {
    if edit.is_multiple_of(50) {
        return other.clone();
    }
    let centre = (proxy.point() + random.point(-3.0, 3.0)).floor().as_ivec3();
    let half = [0, 1, 2, 3, 9][random.below(5)];
    let fill = random.below(2) == 0;
    Segment::from_fn(UVec3::splat(SIZE), |voxel| {
        if (voxel - centre).abs().max_element() <= half {
            fill
        } else {
            solid.is_solid(voxel)
        }
    })
}

/// Changes of whole scenes under a moving probe: objects come and go, are turned at once, and
/// their voxels change. What is admitted leaves it free in all, on a way that was free in all.
#[test]
fn changes_of_objects_never_put_the_probe_inside() {
    let mut random = Random::new(12);
    let mut counts = [0; 3];
    let size = UVec3::splat(16);
    let solids: Vec<Segment> = (0..6).map(|i| noise(16, 0.25, i)).collect();
    let parts: Vec<_> = solids
        .iter()
        .map(|solid| Components::of(solid, size))
        .collect();
    let references: Vec<&Segment> = solids.iter().collect();
    for spacing in SPACINGS {
        let world_grid = grid(size, spacing);
        let mut chosen = (0, Vec::new());
        let mut proxy = Proxy::at(DVec3::splat(-1.0)).expect("a finite point");
        for _ in 0..6_000 {
            let objects: Vec<_> = chosen.1.clone();
            let old = TouchScene {
                occupancy: &references[chosen.0],
                grid: &world_grid,
                objects: &objects,
            };
            let device = random.point(0.0, 16.0);
            Exact::default().advance(&old, device, &mut proxy);
            assert_eq!(old.solid_at(proxy.point()), None);

            // the world, or what is in it, becomes another
            let mut new = chosen.clone();
            match random.below(4) {
                0 => new.0 = random.below(2),
                1 => new.1.truncate(1),
                _ => {
                    let body = 2 + random.below(4);
                    let own = grid(size, SPACINGS[body % 2] * 0.8);
                    let place = random.point(4.0, 12.0) * spacing;
                    let turn = rotation(&mut random);
                    let middle = DVec3::splat(8.0) * own.spacing();
                    let pose = DAffine3::from_mat3_translation(turn, place - turn * middle);
                    let pose = ObjectPose::new(&own, &world_grid, pose).expect("rigid");
                    new.1
                        .push(Object::new(&solids[body], &own, own.bounds(), pose));
                    new.1.truncate(3);
                }
            }
            let after = TouchScene {
                occupancy: &references[new.0],
                grid: &world_grid,
                objects: &new.1,
            };
            let before = proxy;
            match admit_scene(&old, &after, &mut proxy) {
                Admission::Free => {
                    counts[0] += 1;
                    assert_eq!(proxy, before);
                }
                Admission::Pushed { voxel } => {
                    counts[1] += 1;
                    assert_eq!(proxy.voxel(), voxel);
                    // through what was connected in every body that was there
                    let [from, to] = [before, proxy].map(|p| parts[chosen.0].label(p.voxel()));
                    assert!(from != 0 && from == to);
                    for object in old.objects {
                        let body = solids
                            .iter()
                            .position(|s| std::ptr::eq(s, *object.occupancy()));
                        let part = &parts[body.expect("one of the solids")];
                        let [from, to] =
                            [before, proxy].map(|p| part.label(object.pose().voxel_at(p.point())));
                        assert!(from != 0 && from == to);
                    }
                }
                Admission::Held => {
                    counts[2] += 1;
                    assert_eq!(proxy, before);
                    continue;
                }
            }
            assert_eq!(after.solid_at(proxy.point()), None);
            chosen = new;
        }
    }
    println!("free, pushed, held: {counts:?}");
    assert!(counts.iter().all(|&count| count > 20), "{counts:?}");
}

#[test]
fn changes_of_objects_far_away_are_those_of_the_world_alone() {
    let solids = [noise(16, 0.3, 1), noise(16, 0.5, 2)];
    let grid = grid(UVec3::splat(16), DVec3::ONE);
    let pose = DAffine3::from_translation(DVec3::splat(200.0));
    let pose = ObjectPose::new(&grid, &grid, pose).expect("rigid");
    let objects = [Object::new(solids[0].clone(), &grid, grid.bounds(), pose)];
    let mut random = Random::new(3);
    for _ in 0..2000 {
        let start = Proxy::at(random.point(-1.0, 17.0)).expect("a finite point");
        let mut proxies = [start; 2];
        let [old, new] = [0, 1].map(|i| TouchScene::of_world(&solids[i], &grid));
        let new = TouchScene {
            objects: &objects,
            ..new
        };
        let admissions = [
            admit(&solids[0], &solids[1], &grid, &mut proxies[0]),
            admit_scene(&old, &new, &mut proxies[1]),
        ];
        assert_eq!(admissions[0], admissions[1]);
        assert_eq!(proxies[0], proxies[1]);
    }
}
