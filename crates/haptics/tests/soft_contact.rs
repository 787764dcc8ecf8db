//! Soft tissue: the force between two answers of a deformation model.

use glam::{DMat3, DVec3};
use oorandom::Rand64;
use palpate_haptics::force::{Coupling, Friction};
use palpate_haptics::soft_contact::{STALE_SECS, STEP, SoftContact, SoftInput, Stop};
use palpate_haptics::tick::TickOutput;
use palpate_volume::material::LocalContact;

/// Coupling of all tests [N/mm].
const K: f64 = 1.0;
/// Smallest spacing of all tests [mm].
const H: f64 = 0.5;
/// How far beyond what holds the probe tissue is asked about [mm].
const REACH: f64 = 1.5;

/// What a tick gives with the proxy here and a hard spring toward it.
fn hard(proxy: DVec3, device: DVec3, contact: bool) -> TickOutput {
    let spring = if contact { proxy - device } else { DVec3::ZERO };
    let coupling = Coupling {
        stiffness: if contact { K } else { 0.0 },
        damping: 0.0,
    };
    TickOutput {
        proxy_in_scene: proxy,
        contact_point_in_scene: proxy,
        normal: spring.normalize_or_zero(),
        force: spring * K,
        spring,
        coupling,
        sticks: false,
        held_by: None,
        contact,
        depth: spring.length(),
        visits: 0,
        violation: false,
    }
}

fn input(device: DVec3, time: f64, gives_way: bool) -> SoftInput {
    SoftInput {
        device,
        velocity: DVec3::ZERO,
        gives_way,
        coupling: Coupling {
            stiffness: K,
            damping: 0.0,
        },
        friction: Friction::NONE,
        reach: REACH,
        spacing: H,
        time,
    }
}

/// A floor at z = 0 of this stiffness [N/mm], as it answers a tool at this height.
fn floor(stiffness: f64, z: f64) -> LocalContact {
    LocalContact {
        position: DVec3::Z * z,
        force: DVec3::Z * (-stiffness * z).max(0.0),
        stiffness: DMat3::from_diagonal(DVec3::Z * -stiffness),
        validity: 10.0,
    }
}

/// The force after enough ticks with device and answer at rest.
fn settled(soft: &mut SoftContact, contact: &LocalContact, device: DVec3) -> DVec3 {
    let mut output = hard(device, device, false);
    for tick in 0..2000 {
        let time = f64::from(tick) * 0.001;
        soft.take(Some(contact), time);
        output = hard(device, device, false);
        soft.follow(&input(device, time, true), &mut output, |_| None);
    }
    output.force
}

#[test]
fn matter_and_coupling_are_two_springs_in_a_row() {
    for stiffness in [0.05, 0.5, 5.0, 5000.0] {
        let device = DVec3::Z * -2.0;
        let force = settled(&mut SoftContact::default(), &floor(stiffness, -0.1), device);
        let expected = 2.0 * K * stiffness / (K + stiffness);
        // rounding only
        assert!((force - DVec3::Z * expected).length() < 1e-9, "{force}");
    }
}

/// The model is asked about where the tool comes to, and not where its spring is on the way there: answers would tell
/// of the way, and the way follow the answers.
#[test]
fn the_next_answer_is_to_tell_of_where_the_spring_goes_over_to() {
    let device = DVec3::Z * -2.0;
    let asked = |soft: &mut SoftContact, time: f64, gives_way: bool, stop: Option<Stop>| {
        let mut output = hard(DVec3::ZERO, device, true);
        let tool = soft.follow(&input(device, time, gives_way), &mut output, |_| stop);
        (tool, output.spring)
    };
    // while the voxels hold the probe, toward where the hand is: tissue does not give before it is asked
    let mut soft = SoftContact::default();
    let toward = DVec3::Z * -REACH;
    assert_eq!(asked(&mut soft, 0.0, true, None).0, Some(toward));
    assert_eq!(asked(&mut soft, 0.0, false, None).0, None);
    // by an answer, of where hand and tissue are in balance, while the spring has hardly begun to go there
    soft.take(Some(&floor(0.25, -0.1)), 0.0);
    let balance = |stiffness: f64| DVec3::Z * -2.0 / (1.0 + stiffness);
    let (tool, _) = asked(&mut soft, 0.001, true, None);
    assert!((tool.unwrap() - balance(0.25)).length() < 1e-9, "{tool:?}");
    soft.take(Some(&floor(4.0, -0.1)), 0.001);
    let (tool, spring) = asked(&mut soft, 0.002, true, None);
    assert!((tool.unwrap() - balance(4.0)).length() < 1e-9, "{tool:?}");
    assert!((device + spring - balance(4.0)).length() > 1.0, "{spring}");
    // and never beyond what does not give way
    let stop = Stop {
        tool: DVec3::Z * -0.5,
        stiffness: K,
    };
    let (tool, _) = asked(&mut soft, 0.003, true, Some(stop));
    assert_eq!(tool, Some(stop.tool));
}

#[test]
fn the_force_goes_on_from_where_it_is_when_answers_come_and_contacts_change() {
    let mut random = Rand64::new(5);
    let mut soft = SoftContact::default();
    let mut device = DVec3::Z * 2.0;
    let mut last = DVec3::ZERO;
    let mut felt = 0;
    for tick in 0..200_000_u32 {
        let time = f64::from(tick) * 0.001;
        let draw = |random: &mut Rand64| {
            DVec3::from_array([(); 3].map(|()| random.rand_float() * 2.0 - 1.0))
        };
        if random.rand_range(0..30) == 0 {
            let answer = LocalContact {
                position: device + draw(&mut random),
                force: draw(&mut random) * 3.0,
                stiffness: DMat3::from_cols_array(
                    &[(); 9].map(|()| random.rand_float() * 4.0 - 2.0),
                ),
                validity: random.rand_float(),
            };
            soft.take((random.rand_range(0..20) > 0).then_some(&answer), time);
        }
        let before = device;
        device += draw(&mut random) * 0.1 - device * 0.01;
        let moved = (device - before).length();
        // a floor, hard or soft by turns
        let touches = device.z < 0.0;
        let proxy = DVec3::new(device.x, device.y, device.z.max(0.0));
        let mut output = hard(proxy, device, touches);
        let gives_way = !touches || (tick / 5000) % 2 == 0;
        soft.follow(&input(device, time, gives_way), &mut output, |_| None);

        assert!(output.force.is_finite());
        // guarantee 6: never into the obstacle
        assert!(output.force.dot(proxy - device) >= -1e-9);
        let grown = output.force.length() - last.length();
        assert!(
            grown <= K * (moved + 0.1 * H) + 1e-9,
            "tick {tick}: {grown}"
        );
        felt += u32::from(soft.is_felt());
        last = output.force;
    }
    assert!(felt > 50_000, "{felt} ticks were soft");
}

#[test]
fn an_answer_that_is_too_old_leaves_the_hard_contact() {
    let mut soft = SoftContact::default();
    let device = DVec3::Z * -1.0;
    settled(&mut soft, &floor(0.1, -1.0), device);
    let start = 1.999;
    let force = |soft: &mut SoftContact, time: f64| {
        let mut output = hard(DVec3::ZERO, device, true);
        soft.follow(&input(device, time, true), &mut output, |_| None);
        output.force.z
    };
    let still_soft = force(&mut soft, start + STALE_SECS - 0.001);
    assert!(still_soft < 0.1, "{still_soft}");
    let mut last = still_soft;
    for tick in 1..1000 {
        let now = force(&mut soft, start + STALE_SECS + f64::from(tick) * 0.001);
        assert!((last..=last + 0.1 * H * K).contains(&now));
        last = now;
    }
    assert_eq!(last, K);
    assert!(!soft.is_felt());
}

/// Of a law that stays, after a device has settled in it.
fn staying(law: &LocalContact, device: DVec3) -> (SoftContact, DVec3) {
    let mut soft = SoftContact::default();
    let force = settled(&mut soft, law, device);
    soft.take_staying(Some(law), 1.999);
    (soft, force)
}

/// A tick with the hard proxy at the skin, so many seconds after the answer.
fn tick_after(soft: &mut SoftContact, device: DVec3, late: f64) -> TickOutput {
    let mut output = hard(device.with_z(device.z.max(0.0)), device, device.z < 0.0);
    soft.follow(&input(device, 1.999 + late, true), &mut output, |_| None);
    output
}

/// A law that is held whole within a millimetre.
fn near_law() -> LocalContact {
    LocalContact {
        validity: 0.5,
        ..floor(0.1, -1.0)
    }
}

#[test]
fn a_hand_at_rest_feels_a_law_that_stays_however_late_the_next_answer_is() {
    let device = DVec3::Z * -1.0;
    let (mut soft, force) = staying(&near_law(), device);
    assert!(force.z > 0.05);
    for tick in 0..60_000 {
        let late = f64::from(tick) * 0.001;
        assert_eq!(tick_after(&mut soft, device, late).force, force, "{late} s");
    }
}

#[test]
fn a_law_that_stays_is_left_for_good_by_a_hand_that_goes_elsewhere_while_the_answer_is_late() {
    for aside in [DVec3::new(1.5, 0.0, -1.0), DVec3::Z * -3.0, DVec3::Z] {
        let (mut soft, force) = staying(&near_law(), DVec3::Z * -1.0);
        // in time it is followed, as any other
        tick_after(&mut soft, aside, STALE_SECS - 0.01);
        assert!(soft.is_awaited());
        // in small steps, so that each step of the force can be seen
        let mut last = tick_after(&mut soft, DVec3::Z * -1.0, STALE_SECS - 0.005).force;
        let way = (aside - DVec3::Z * -1.0) / 100.0;
        for step in 1..=3000 {
            let device = DVec3::Z * -1.0 + way * f64::from(step.min(100));
            let now = tick_after(&mut soft, device, STALE_SECS + 0.001 * f64::from(step)).force;
            let most = K * (STEP * H + way.length()) + 1e-9;
            assert!(now.length() - last.length() <= most, "{last} {now}");
            last = now;
        }
        // as hard as the voxels
        assert_eq!(last, DVec3::Z * (-aside.z).max(0.0) * K);
        assert!(!soft.is_awaited());
        // and it does not come back before the next answer, wherever the hand goes
        let mut back = DVec3::ZERO;
        for _ in 0..1000 {
            back = tick_after(&mut soft, DVec3::Z * -1.0, 5.0).force;
        }
        assert!(force.z < 0.5 * K && back == DVec3::Z * K, "{force} {back}");
    }
}

#[test]
fn a_hand_that_moves_a_little_under_a_late_law_that_stays_gains_no_energy() {
    let (mut soft, _) = staying(&near_law(), DVec3::Z * -1.0);
    let mut gained = 0.0;
    let mut last = (
        DVec3::Z * -1.0,
        tick_after(&mut soft, DVec3::Z * -1.0, 0.2).force,
    );
    for tick in 1..=20_000 {
        let phase = f64::from(tick) * 0.02;
        let device = DVec3::new(0.2 * phase.sin(), 0.0, -1.0 - 0.3 * (0.7 * phase).sin());
        let force = tick_after(&mut soft, device, 0.2 + 0.001 * f64::from(tick)).force;
        gained += 0.5 * (force + last.1).dot(device - last.0);
        last = (device, force);
    }
    assert!(soft.is_felt());
    // but for what a spring of some 0.1 N/mm holds over these 0.3 mm
    assert!(gained <= 0.05, "{gained} N·mm");
}

#[test]
fn an_answer_by_which_nothing_pushes_stays_no_longer_than_others() {
    let (mut soft, force) = staying(&floor(0.0, 1.0), DVec3::Z * 1.0);
    assert_eq!(force, DVec3::ZERO);
    tick_after(&mut soft, DVec3::Z, STALE_SECS + 0.01);
    assert!(!soft.is_awaited());
}

/// Guarantee 4 where friction leads a probe that is caught in tissue: the spring of the hard contact
/// then pulls past the probe, which is cut off.
#[test]
fn a_hand_at_rest_beside_a_caught_probe_has_a_constant_force_after_a_stated_number_of_ticks() {
    let mut random = Rand64::new(6);
    let mut draw =
        |most: f64| DVec3::from_array([(); 3].map(|()| (random.rand_float() * 2.0 - 1.0) * most));
    let mut pulled = 0;
    for _ in 0..500 {
        let device = draw(1.0);
        let mut soft = SoftContact::default();
        let law = LocalContact {
            force: draw(3.0),
            ..floor(0.0, device.z)
        };
        settled(&mut soft, &law, device);
        // the answer is too old, and what friction holds is the probe's contact
        let (proxy, held) = (device + draw(1.5), draw(6.0));
        let mut tick = || {
            let mut output = hard(proxy, device, true);
            (output.spring, output.force) = (held, held * K);
            soft.follow(&input(device, 10.0, true), &mut output, |_| None);
            output.force
        };
        let way = tick().distance(held) / K;
        let mut last = tick();
        for _ in 0..(way / (STEP * H)).ceil() as u32 {
            let force = tick();
            assert!(force.length() - last.length() <= K * STEP * H + 1e-9);
            assert!(force.dot(proxy - device) >= -1e-9);
            last = force;
        }
        for _ in 0..50 {
            assert_eq!(tick(), last);
        }
        pulled += u32::from(held.dot(proxy - device) < 0.0);
    }
    assert!(pulled > 200, "{pulled} springs pulled");
}

#[test]
fn hard_matter_below_soft_matter_is_hard_at_once() {
    let mut soft = SoftContact::default();
    // above the floor nothing pushes
    soft.take(Some(&floor(0.1, 1.0)), 0.0);
    let mut free = hard(DVec3::Z, DVec3::Z, false);
    soft.follow(&input(DVec3::Z, 0.0, true), &mut free, |_| None);
    assert_eq!(free.force, DVec3::ZERO);
    // a knock of 1.5 mm in a tick on something else
    let device = DVec3::Z * -0.5;
    let mut output = hard(DVec3::ZERO, device, true);
    soft.follow(&input(device, 0.001, false), &mut output, |_| None);
    assert_eq!(output.force, DVec3::Z * 0.5);
}

#[test]
fn answers_that_are_no_numbers_are_no_answers() {
    let good = floor(0.5, -1.0);
    let bad = [
        LocalContact {
            position: DVec3::NAN,
            ..good
        },
        LocalContact {
            force: DVec3::INFINITY,
            ..good
        },
        LocalContact {
            stiffness: DMat3::NAN,
            ..good
        },
        LocalContact {
            validity: f64::NAN,
            ..good
        },
        LocalContact {
            validity: 0.0,
            ..good
        },
    ];
    for answer in bad {
        let mut soft = SoftContact::default();
        soft.take(Some(&answer), 0.0);
        let device = DVec3::Z * -1.0;
        let before = hard(DVec3::ZERO, device, true);
        let mut output = before;
        soft.follow(&input(device, 0.0, true), &mut output, |_| None);
        assert_eq!(output, before);
    }
}

#[test]
fn a_law_is_not_followed_far_from_where_it_was_found() {
    // 5 N/mm, found 1 mm deep; the device is 20 mm to the side, and as deep
    let answer = LocalContact {
        validity: 2.0,
        ..floor(5.0, -1.0)
    };
    let far = DVec3::new(20.0, 0.0, -1.0);
    assert_eq!(
        settled(&mut SoftContact::default(), &answer, far),
        DVec3::ZERO
    );
    let near = DVec3::new(2.0, 0.0, -1.0);
    assert!(settled(&mut SoftContact::default(), &answer, near).z > 0.5);
}

#[test]
fn a_law_that_drives_is_followed_along_its_force_only() {
    // stiffness that would push the tool on: no spring
    let answer = LocalContact {
        stiffness: DMat3::from_diagonal(DVec3::new(3.0, 3.0, -0.5)),
        ..floor(0.5, -1.0)
    };
    let device = DVec3::new(0.3, 0.0, -2.0);
    let force = settled(&mut SoftContact::default(), &answer, device);
    assert!(force.x.abs() < 1e-9, "{force}");
    assert!(
        (force.z - 2.0 * K * 0.5 / (K + 0.5)).abs() < 1e-9,
        "{force}"
    );
}

/// Bone of this stiffness [N/mm] below a height, as what stops a tool.
fn bone(top: f64, stiffness: f64) -> impl Fn(DVec3) -> Option<Stop> {
    move |tool: DVec3| {
        (tool.z < top).then_some(Stop {
            tool: tool.with_z(top),
            stiffness,
        })
    }
}

#[test]
fn what_does_not_give_way_is_felt_with_its_own_stiffness_whatever_the_answers_say() {
    let nothing = LocalContact {
        position: DVec3::ZERO,
        force: DVec3::ZERO,
        stiffness: DMat3::ZERO,
        validity: 30.0,
    };
    for (answer, stiffness) in [(nothing, K), (nothing, 3.0), (floor(0.1, -0.1), 3.0)] {
        let mut soft = SoftContact::default();
        let bone = bone(-1.0, stiffness);
        let mut last = 0.0;
        for tick in 0..3000 {
            let (time, z) = (f64::from(tick) * 0.001, f64::from(tick) * -0.001);
            let device = DVec3::Z * z;
            soft.take(Some(&answer), time);
            // the proxy stays on the skin, held by what gives way
            let mut output = hard(DVec3::ZERO, device, true);
            soft.follow(&input(device, time, true), &mut output, &bone);
            let force = output.force.z;
            assert!(force - last < stiffness * 0.012, "{last} {force} at {z}");
            last = force;
            if z < -1.2 {
                let end = output.contact_point_in_scene;
                assert!(end.z >= -1.0 - 1e-9, "the tool is in the bone: {end}");
            }
        }
        // 2 mm deep in the bone, by way of its own spring
        assert!((last - 2.0 * stiffness).abs() < 0.02, "{last} {stiffness}");
    }
}

#[test]
fn a_tool_that_is_drawn_over_soft_matter_sticks_and_then_slips_with_friction() {
    let dry = Friction {
        stick: 0.6,
        slip: 0.4,
    };
    let law = floor(0.5, -0.1);
    let drawn = |friction: Friction| {
        let mut soft = SoftContact::default();
        let mut forces = Vec::new();
        for tick in 0..4000 {
            let time = f64::from(tick) * 0.001;
            // down by 2 mm, then along by 6 mm
            let down = (f64::from(tick) * 0.002).min(2.0);
            let along = (f64::from(tick - 1000) * 0.002).max(0.0);
            let device = DVec3::new(along, 0.0, -down);
            soft.take(Some(&law), time);
            let mut output = hard(device, device, false);
            let input = SoftInput {
                friction,
                ..input(device, time, true)
            };
            soft.follow(&input, &mut output, |_| None);
            forces.push(output.force);
        }
        forces
    };
    let smooth = drawn(Friction::NONE);
    assert!(smooth.iter().all(|force| force.x == 0.0));
    let forces = drawn(dry);
    // within the cone always, against the way, and none before it is drawn
    for force in &forces {
        assert!(
            force.x <= 1e-12 && -force.x <= 0.6 * force.z + 1e-9,
            "{force}"
        );
    }
    assert!(forces[900].x.abs() < 1e-12);
    let last = forces[3999];
    assert!((last.x + 0.4 * last.z).abs() < 1e-6, "{last}");
    assert!((last.z - smooth[3999].z).abs() < 1e-6, "{last}");
    let most = forces.iter().map(|force| -force.x / force.z.max(1e-9));
    assert!(most.fold(0.0, f64::max) > 0.5, "it never stuck");
}
