//! The probe as changes of the occupancy meet it: free, pushed, or in the way.

use glam::IVec3;
use palpate_haptics::admission::{Admission, admit};
use palpate_haptics::proxy::Proxy;
use palpate_volume::bits::Bits;
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;

use crate::touch_occupancy::Admit;

/// A point probe in its grid.
#[derive(Debug)]
pub struct Probe<'a> {
    /// Where the scan stands.
    pub grid: &'a Grid,
    /// Where the probe is.
    pub proxy: &'a mut Proxy,
}

impl Admit for Probe<'_> {
    fn admit<N: Occupancy>(&mut self, old: &Bits, new: &N) -> bool {
        admit(old, new, self.grid, self.proxy) != Admission::Held
    }

    fn voxel(&self) -> IVec3 {
        self.proxy.voxel()
    }
}
