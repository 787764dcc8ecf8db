//! A fixed number of ticks between the force that is sent and the force that acts.
//!
//! Real devices have this delay in their bus and amplifiers; it bounds the stiffness of a
//! stable wall (Hulin, Preusche, Hirzinger, "Stability boundary for haptic rendering",
//! IROS 2008).

use glam::DVec3;

/// Longest delay in ticks.
pub const MAX_DELAY_TICKS: usize = 32;

/// The forces on their way [N], oldest next. Fixed in size: nothing is allocated.
#[derive(Clone, Debug)]
pub struct OutputDelay {
    waiting: [DVec3; MAX_DELAY_TICKS],
    ticks: usize,
    next: usize,
}

impl OutputDelay {
    /// A line of `ticks` zero forces; longer ones are cut to [`MAX_DELAY_TICKS`].
    pub fn new(ticks: usize) -> Self {
        Self {
            waiting: [DVec3::ZERO; MAX_DELAY_TICKS],
            ticks: ticks.min(MAX_DELAY_TICKS),
            next: 0,
        }
    }

    /// Takes the force of this tick and gives the one that acts now.
    pub fn pass(&mut self, force: DVec3) -> DVec3 {
        if self.ticks == 0 {
            return force;
        }
        let acting = std::mem::replace(&mut self.waiting[self.next], force);
        self.next = (self.next + 1) % self.ticks;
        acting
    }
}
