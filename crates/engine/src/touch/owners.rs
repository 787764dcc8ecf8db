//! Which segments own the solid voxels that were asked for last.
//!
//! A tick asks for the same voxels several times, and a probe at rest for the same ones tick
//! after tick, while the answer may take a look into every segment, and for a ball a search for
//! the voxel that it rests against. What is kept changes no answer. Nothing here allocates.

use std::cell::Cell;

use palpate_haptics::force::MAX_HOLDERS;
use palpate_haptics::scene::Solid;
use palpate_volume::edit::SegmentId;

/// Voxels kept: what holds a probe back, and as many that did so before.
const KEPT: usize = 2 * MAX_HOLDERS;

/// An answer; `None` where nobody owns the voxel.
type Answer = (Solid, Option<SegmentId>);

/// The last answers, of one state of what is touched.
#[derive(Debug, Default)]
pub struct Owners {
    version: u64,
    kept: [Cell<Option<Answer>>; KEPT],
    /// The place that is overwritten next.
    next: Cell<usize>,
}

impl Owners {
    /// Tells a number that changes with whatever is touched; answers of another one are forgotten.
    pub fn set_version(&mut self, version: u64) {
        if self.version != version {
            *self = Self {
                version,
                ..Self::default()
            };
        }
    }

    /// Who owns a voxel; `look` finds it out, and is asked only where the answer is not at hand.
    pub fn of(&self, solid: Solid, look: impl FnOnce() -> Option<SegmentId>) -> Option<SegmentId> {
        let kept = self.kept.iter().filter_map(Cell::get);
        if let Some((_, owner)) = kept.into_iter().find(|(asked, _)| *asked == solid) {
            return owner;
        }
        let owner = look();
        let next = self.next.get();
        if let Some(place) = self.kept.get(next) {
            place.set(Some((solid, owner)));
        }
        self.next.set((next + 1) % KEPT);
        owner
    }
}

#[cfg(test)]
mod tests {
    use glam::IVec3;

    use super::*;

    /// Asks; gives the answer, and whether it had to be looked up.
    fn ask(owners: &Owners, x: i32, owner: u8) -> (Option<SegmentId>, bool) {
        let looked = Cell::new(false);
        let answer = owners.of(Solid::of_world(IVec3::X * x), || {
            looked.set(true);
            Some(SegmentId(owner))
        });
        (answer, looked.get())
    }

    #[test]
    fn a_voxel_is_looked_up_once_until_what_is_touched_changes() {
        let mut owners = Owners::default();
        owners.set_version(1);
        assert_eq!(ask(&owners, 5, 7), (Some(SegmentId(7)), true));
        for x in 0..KEPT as i32 - 1 {
            ask(&owners, 10 + x, 3);
        }
        owners.set_version(1);
        assert_eq!(ask(&owners, 5, 9), (Some(SegmentId(7)), false));
        owners.set_version(2);
        assert_eq!(ask(&owners, 5, 9), (Some(SegmentId(9)), true));
    }

    #[test]
    fn bodies_are_told_apart_and_the_oldest_answer_makes_room() {
        let owners = Owners::default();
        assert!(ask(&owners, 5, 7).1);
        let other = Solid {
            body: 1,
            voxel: IVec3::X * 5,
        };
        assert_eq!(owners.of(other, || None), None);
        assert_eq!(ask(&owners, 5, 9), (Some(SegmentId(7)), false));
        for x in 0..KEPT as i32 {
            ask(&owners, 10 + x, 3);
        }
        assert_eq!(ask(&owners, 5, 9), (Some(SegmentId(9)), true));
    }
}
