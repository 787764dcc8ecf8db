//! The undo journal: order, budget and what is told of it.

use palpate_tools::undo::{DEFAULT_BUDGET, UndoJournal};

#[test]
fn steps_come_back_newest_first_and_a_new_change_forgets_what_was_undone() {
    let mut journal = UndoJournal::default();
    journal.done('a', 1);
    journal.done('b', 1);
    assert_eq!(journal.pop_undo(), Some('b'));
    journal.undone('B', 1);
    assert!(journal.can_redo());
    journal.done('c', 1);
    assert!(!journal.can_redo());
    assert_eq!(journal.pop_undo(), Some('c'));
    assert_eq!(journal.pop_undo(), Some('a'));
    assert!(!journal.can_undo());
    assert_eq!(journal.bytes(), 0);
}

#[test]
fn the_position_rises_with_each_step_and_falls_where_one_is_taken_back() {
    let mut journal = UndoJournal::new(400);
    let place = |journal: &UndoJournal<char>| (journal.position(), journal.made());
    assert_eq!(place(&journal), (0, 0));
    journal.done('a', 1);
    journal.done('b', 1);
    assert_eq!(place(&journal), (2, 2));
    let step = journal.pop_undo().unwrap();
    journal.undone(step, 1);
    assert_eq!(place(&journal), (1, 2));
    let step = journal.pop_redo().unwrap();
    journal.redone(step, 1);
    assert_eq!(place(&journal), (2, 2));
    // 'a' and 'b' are forgotten, and count
    journal.done('c', 400);
    assert_eq!(journal.steps().count(), 1);
    assert_eq!(place(&journal), (3, 3));
}

#[test]
fn the_oldest_steps_are_forgotten_where_they_hold_too_much_and_the_newest_never() {
    let mut journal = UndoJournal::default();
    journal.done("small", 1);
    journal.done("huge", 2 * DEFAULT_BUDGET);
    assert_eq!(journal.steps().count(), 1);
    assert_eq!(journal.pop_undo(), Some("huge"));
    assert!(!journal.can_undo());
}

#[test]
fn the_number_of_steps_is_limited_by_their_bytes_alone() {
    let mut journal = UndoJournal::new(1 << 20);
    for step in 0..20_000_u32 {
        journal.done(step, 100);
        assert!(journal.bytes() <= journal.budget());
    }
    let kept = journal.steps().count();
    // a step of 100 bytes weighs between that and 200 with its place in the list
    assert!((1 << 20) / 200 < kept && kept < (1 << 20) / 100, "{kept}");
    assert_eq!(journal.newest(), Some(&19_999));
    let used = journal.bytes();

    let mut undone = 0;
    while let Some(step) = journal.pop_undo() {
        journal.undone(step, 100);
        undone += 1;
    }
    assert_eq!((undone, journal.bytes()), (kept, used));
    while let Some(step) = journal.pop_redo() {
        journal.redone(step, 100);
    }
    assert_eq!((journal.steps().count(), journal.bytes()), (kept, used));
}
