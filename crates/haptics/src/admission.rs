//! The one rule for every change of what is solid: the probe's body stays free.
//!
//! A change is admitted where the proxy's voxel stays free. Else the proxy is first pushed,
//! along face-connected voxels that are free *before* the change, to the next voxel that is
//! free after it as well: next along the way, not as the crow flies, so that a wall that
//! grows never pushes the proxy around its rim to the other side. Where there is none in a
//! bounded window, the change is held. Whoever makes changes (edit, undo, threshold, switching on) asks here first.
//!
//! Frame: grid; distances in mm. Closed, like a tick: the search runs on the stack.

mod motion;
mod placement;

pub use motion::{POSE_STEP_VISITS, PoseMotion, PoseStep, step_pose};
pub use placement::{nearest_free, nearest_free_in};

use crate::contact::Proxy;
use crate::contact::bodies::{Bodies, Visits};
use crate::contact::voxel_distance::squared_distance;
use crate::scene::TouchScene;
use glam::{DVec3, IVec3};
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;
use std::cell::Cell;

/// How far the proxy can be pushed along each axis [voxels].
pub const PUSH_REACH: i32 = 7;

/// Voxels along the edge of the window, and in all of it.
const EDGE: i32 = 2 * PUSH_REACH + 1;
const VOXELS: usize = (EDGE * EDGE * EDGE) as usize;

/// Most voxels that one admission reads, in either occupancy.
pub const ADMISSION_VISITS: u32 = 2 * VOXELS as u32;

/// Most voxels read by one question of admission with objects near; where they are used up the
/// change is held.
pub const SCENE_ADMISSION_VISITS: u32 = 65_536;

/// What became of a change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Admission {
    /// Admitted: the proxy's voxel stays free.
    Free,
    /// Admitted: the proxy was pushed to this voxel.
    Pushed {
        /// Free before and after the change.
        voxel: IVec3,
    },
    /// Not admitted: the proxy has nowhere to go. Nothing was moved.
    Held,
}

/// Admits a change from `old` to `new`, pushing the proxy where needed.
pub fn admit<A: Occupancy + ?Sized, B: Occupancy + ?Sized>(
    old: &A,
    new: &B,
    grid: &Grid,
    proxy: &mut Proxy,
) -> Admission {
    if !new.is_solid(proxy.voxel()) {
        return Admission::Free;
    }
    let place = |voxel: IVec3| {
        let distance = squared_distance(voxel, proxy.point(), grid.spacing());
        (!new.is_solid(voxel)).then_some((distance, voxel))
    };
    let step = |_, voxel: IVec3| {
        if old.is_solid(voxel) {
            Step::Never
        } else {
            Step::Open
        }
    };
    let Some(voxel) = nearest_escape(proxy.voxel(), grid.spacing(), place, step) else {
        return Admission::Held;
    };
    *proxy = Proxy::nearest_in(voxel, proxy.point());
    Admission::Pushed { voxel }
}

/// The same for a whole scene: whatever changes in it, objects added, removed or filled, or
/// the radius of the probe for which they were made. Both scenes have one world grid.
///
/// Where objects are near, the probe goes by steps of one voxel of the world, each walked in
/// every body that was there before, to the nearest place that is free in all that are there
/// after. An object that moves is better asked about step by step (`motion.rs`).
pub fn admit_scene<A: Occupancy, B: Occupancy>(
    old: &TouchScene<'_, A>,
    new: &TouchScene<'_, B>,
    proxy: &mut Proxy,
) -> Admission {
    let spacing = old.grid.spacing();
    let reach = spacing * f64::from(PUSH_REACH + 2);
    let at = proxy.point() * spacing;
    let before = Bodies::near_box(old, at - reach, at + reach);
    let after = Bodies::near_box(new, at - reach, at + reach);
    if before.is_world_only() && after.is_world_only() {
        return admit(old.occupancy, new.occupancy, old.grid, proxy);
    }
    if after.solid_at(proxy.point()).is_none() {
        return Admission::Free;
    }

    // the probe's own place in each voxel, and steps from one to the next
    let start = *proxy;
    let point_in = |voxel: IVec3| start.point() + (voxel - start.voxel()).as_dvec3();
    let visits = Cell::new(Visits::new(SCENE_ADMISSION_VISITS));
    let is_free = |from: DVec3, to: DVec3| {
        let mut left = visits.get();
        let free = before.is_free(from, to, &mut left);
        visits.set(left);
        free
    };
    let place = |voxel: IVec3| {
        let here = point_in(voxel);
        let nearest = Proxy::nearest_in(voxel, start.point()).point();
        let can_stand = |point: DVec3| {
            after.solid_at(point).is_none() && (point == here || is_free(here, point))
        };
        let point = [nearest, here]
            .into_iter()
            .find(|&point| can_stand(point))?;
        Some((after.squared_distance(point, start.point()), point))
    };
    let step = |from: IVec3, to: IVec3| {
        if before.solid_at(point_in(to)).is_some() {
            Step::Never
        } else if is_free(point_in(from), point_in(to)) {
            Step::Open
        } else {
            Step::NotFromHere
        }
    };
    let escape = nearest_escape(start.voxel(), spacing, place, step);
    let Some(escaped) = escape.and_then(Proxy::at) else {
        return Admission::Held;
    };
    *proxy = escaped;
    Admission::Pushed {
        voxel: escaped.voxel(),
    }
}

/// The place that fewest open steps from voxel to voxel reach, face to face; of
/// those as near as the longest side of a voxel, the nearest by the squared distance [mm²] that
/// `place` gives with it.
fn nearest_escape<P>(
    start: IVec3,
    spacing: DVec3,
    place: impl Fn(IVec3) -> Option<(f64, P)>,
    step: impl Fn(IVec3, IVec3) -> Step,
) -> Option<P> {
    let mut search = Search::new(start);
    let mut best: Option<(f64, P)> = None;
    let mut steps_left = spacing.max_element() / spacing.min_element();
    while !search.is_done() && steps_left >= 1.0 {
        // all voxels that are one step further than those before
        for _ in 0..search.waiting() {
            let Some(voxel) = search.next() else { break };
            if let Some(found) = place(voxel)
                && best.as_ref().is_none_or(|(nearest, _)| found.0 < *nearest)
            {
                best = Some(found);
            }
            for face in FACES {
                search.reach(voxel + face, |next| step(voxel, next));
            }
        }
        if best.is_some() {
            steps_left -= 1.0;
        }
    }
    best.map(|(_, place)| place)
}

/// Whether a step from one voxel to the next can be taken.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Step {
    Open,
    /// Something stands between the two.
    NotFromHere,
    /// Nobody can stand there.
    Never,
}

const FACES: [IVec3; 6] = [
    IVec3::X,
    IVec3::Y,
    IVec3::Z,
    IVec3::NEG_X,
    IVec3::NEG_Y,
    IVec3::NEG_Z,
];

/// A breadth-first search in the window, with its queue on the stack.
struct Search {
    min: IVec3,
    seen: [u64; VOXELS.div_ceil(64)],
    queue: [u16; VOXELS],
    head: usize,
    tail: usize,
}

impl Search {
    /// A search that begins in the middle of its window.
    fn new(start: IVec3) -> Self {
        let mut search = Self {
            min: start - PUSH_REACH,
            seen: [0; VOXELS.div_ceil(64)],
            queue: [0; VOXELS],
            head: 0,
            tail: 0,
        };
        search.reach(start, |_| Step::Open);
        search
    }

    /// Voxels reached but not looked at yet.
    fn waiting(&self) -> usize {
        self.tail - self.head
    }

    fn is_done(&self) -> bool {
        self.waiting() == 0
    }

    /// The next voxel in the order of steps.
    fn next(&mut self) -> Option<IVec3> {
        if self.is_done() {
            return None;
        }
        let index = i32::from(*self.queue.get(self.head)?);
        self.head += 1;
        let offset = IVec3::new(index % EDGE, index / EDGE % EDGE, index / (EDGE * EDGE));
        Some(self.min + offset)
    }

    /// Queues a voxel of the window that is seen for the first time and open.
    fn reach(&mut self, voxel: IVec3, step: impl Fn(IVec3) -> Step) {
        let offset = voxel - self.min;
        let inside = offset.cmpge(IVec3::ZERO).all() && offset.cmplt(IVec3::splat(EDGE)).all();
        if !inside {
            return;
        }
        let index = ((offset.z * EDGE + offset.y) * EDGE + offset.x) as usize;
        let mark = 1 << (index % 64);
        let Some(word) = self.seen.get_mut(index / 64) else {
            return;
        };
        if *word & mark != 0 {
            return;
        }
        let step = step(voxel);
        if step != Step::NotFromHere {
            *word |= mark;
        }
        if step == Step::Open
            && let Some(place) = self.queue.get_mut(self.tail)
        {
            *place = index as u16;
            self.tail += 1;
        }
    }
}
