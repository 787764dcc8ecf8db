//! The one rule for every change of what is solid: the probe's body stays free.
//!
//! A change is admitted where the proxy's voxel stays free. Else the proxy is first pushed,
//! along face-connected voxels that are free *before* the change, to the next voxel that is
//! free after it as well: next along the way, not as the crow flies, so that a wall that
//! grows never pushes the proxy around its rim to the other side. Where there is none in a
//! bounded window, the change is held. Whoever makes changes (edit, undo, threshold, switching on) asks here first.
//!
//! Frame: grid; distances in mm. Closed, like a tick: the search runs on the stack.

use crate::proxy::Proxy;
use crate::voxel_distance::squared_distance;
use glam::{DVec3, IVec3};
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;

/// How far the proxy can be pushed along each axis [voxels].
pub const PUSH_REACH: i32 = 7;

/// Voxels along the edge of the window, and in all of it.
const EDGE: i32 = 2 * PUSH_REACH + 1;
const VOXELS: usize = (EDGE * EDGE * EDGE) as usize;

/// Most voxels that one admission reads, in either occupancy.
pub const ADMISSION_VISITS: u32 = 2 * VOXELS as u32;

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
    let Some(voxel) = nearest_escape(old, new, grid.spacing(), proxy) else {
        return Admission::Held;
    };
    *proxy = Proxy::nearest_in(voxel, proxy.point());
    Admission::Pushed { voxel }
}

/// The voxel free in `new` that fewest steps reach, face to face through voxels free in
/// `old`; of those as near as the longest side of a voxel, the nearest in mm.
fn nearest_escape(
    old: &(impl Occupancy + ?Sized),
    new: &(impl Occupancy + ?Sized),
    spacing: DVec3,
    proxy: &Proxy,
) -> Option<IVec3> {
    let mut search = Search::new(proxy.voxel());
    let mut best: Option<(f64, IVec3)> = None;
    let mut steps_left = spacing.max_element() / spacing.min_element();
    while !search.is_done() && steps_left >= 1.0 {
        // all voxels that are one step further than those before
        for _ in 0..search.waiting() {
            let Some(voxel) = search.next() else { break };
            let distance = squared_distance(voxel, proxy.point(), spacing);
            let nearer = best.is_none_or(|(nearest, _)| distance < nearest);
            if nearer && !new.is_solid(voxel) {
                best = Some((distance, voxel));
            }
            for face in FACES {
                search.reach(voxel + face, |voxel| !old.is_solid(voxel));
            }
        }
        if best.is_some() {
            steps_left -= 1.0;
        }
    }
    best.map(|(_, voxel)| voxel)
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
        search.reach(start, |_| true);
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

    /// Queues a voxel of the window that is seen for the first time and free.
    fn reach(&mut self, voxel: IVec3, free: impl Fn(IVec3) -> bool) {
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
        *word |= mark;
        if free(voxel)
            && let Some(place) = self.queue.get_mut(self.tail)
        {
            *place = index as u16;
            self.tail += 1;
        }
    }
}
