//! A tape as columns of numbers: whole, and refused where it is none.

use crate::common::recorder::*;
use crate::common::*;
use glam::{DVec3, UVec3};
use palpate_engine::replay::{BUILD, Tape, TapeColumns, TapeCommand, TapeEntry, TapeError, replay};
use palpate_engine::servo::{DeformableContact, ServoState};

#[test]
fn a_tape_goes_through_columns_and_is_replayed_all_the_same() {
    let (recording, tape) = recorded(10, 3_000, 10);
    let columns = TapeColumns::from(&tape);
    let read = Tape::try_from(&columns).unwrap();
    assert_eq!(read.state, tape.state);
    assert_eq!(read.grid, tape.grid);
    assert_equal(&replay(&recording, &read).unwrap());
    assert_eq!(TapeColumns::from(&read), columns);
}

/// Numbers survive to the bit, those that are none included.
#[test]
fn a_state_goes_through_columns_to_the_bit() {
    let (_, mut tape) = recorded(11, 30, 10);
    tape.state.hand = DVec3::new(-0.0, 5e-324, 1.0 + f64::EPSILON);
    tape.state.mapping.offset = DVec3::new(f64::NAN, f64::INFINITY, -1e300);
    tape.state.tick = u64::MAX;
    let read = Tape::try_from(&TapeColumns::from(&tape)).unwrap();
    let bits = |state: &ServoState| {
        let numbers = [state.hand, state.mapping.offset].map(|vector| vector.to_array());
        numbers.map(|numbers| numbers.map(f64::to_bits))
    };
    assert_eq!(bits(&read.state), bits(&tape.state));
    assert_eq!(read.state.tick, u64::MAX);
}

#[test]
fn columns_that_are_no_tape_are_refused() {
    let (_, tape) = recorded(12, 2_000, 10);
    let good = TapeColumns::from(&tape);
    let refused = |change: fn(&mut TapeColumns)| {
        let mut columns = good.clone();
        change(&mut columns);
        Tape::try_from(&columns).unwrap_err()
    };
    let cut = refused(|columns| columns.start.truncate(40));
    assert!(matches!(cut, TapeError::Start(_)), "{cut}");
    let other = refused(|columns| columns.commands[0] = 0xc1);
    assert!(matches!(other, TapeError::Command { number: 0, .. }));

    let lengths: [fn(&mut TapeColumns); 6] = [
        |columns| _ = columns.values.stored.pop(),
        |columns| _ = columns.brick_ends.pop(),
        |columns| *columns.brick_ends.last_mut().unwrap() += 1,
        |columns| columns.command_ends[0] = u64::MAX,
        |columns| _ = columns.solid.words.pop(),
        |columns| _ = columns.commands.pop(),
    ];
    for change in lengths {
        assert_eq!(refused(change), TapeError::Lengths);
    }
    let bricks: [fn(&mut TapeColumns); 4] = [
        |columns| *columns.values.index.last_mut().unwrap() = u32::MAX,
        |columns| columns.values.index[1] = columns.values.index[0],
        |columns| *columns.solid.index.last_mut().unwrap() = u32::MAX,
        |columns| columns.solid.index[1] = columns.solid.index[0],
    ];
    for change in bricks {
        assert_eq!(refused(change), TapeError::Bricks);
    }
}

#[test]
fn bricks_beyond_the_border_and_scans_that_fill_all_memory_are_refused() {
    let mut rig = Rig::new(UVec3::new(20, 9, 12), DVec3::splat(-5.0));
    rig.simulation.begin_tape();
    rig.tick_at(DVec3::splat(-5.0));
    let mut tape = rig.simulation.tape().lock().unwrap().finish().unwrap();
    let mut columns = TapeColumns::from(&tape);
    // the third brick along x has four voxels inside
    columns.solid.segment.push(1);
    columns.solid.index.push(2);
    columns.solid.words.push([0x0f; 8]);
    assert!(Tape::try_from(&columns).is_ok());
    columns.solid.words[0][3] = 0x1f;
    assert_eq!(Tape::try_from(&columns).unwrap_err(), TapeError::Outside);

    tape.parts.clear();
    tape.grid = grid(UVec3::new(8_000, 8_000, 8_000));
    let refused = Tape::try_from(&TapeColumns::from(&tape)).unwrap_err();
    assert!(matches!(refused, TapeError::TooLarge { .. }), "{refused}");
}

#[test]
fn the_build_has_a_name() {
    assert_eq!(BUILD.len(), 16);
    assert!(u64::from_str_radix(BUILD, 16).unwrap() != 0);
}

/// Files of older versions are read by these names, whatever the code calls them.
#[test]
fn names_in_a_file_stay_as_they_are() {
    let (_, mut tape) = recorded(13, 30, 10);
    tape.entries.push(TapeEntry {
        command: TapeCommand::DeformableContact(DeformableContact::default()),
        swaps: Vec::new(),
        fractions: Vec::new(),
    });
    let columns = TapeColumns::from(&tape);
    let has = |bytes: &[u8], name: &str| bytes.windows(name.len()).any(|at| at == name.as_bytes());
    let names = "grid state parts rescale is_full touch mapping settings feels radius poses touched \
                 giving_way soft needle hand clutch forgotten_hand received refused_places command \
                 tick segments contact";
    for name in names.split_whitespace() {
        assert!(has(&columns.start, name), "{name}");
    }
    assert!(has(&columns.commands, "GiveWay"));
}
