//! The probe as changes of what is solid meet it: free, pushed, or in the way.

use glam::IVec3;
use palpate_haptics::admission::{Admission, admit_scene};
use palpate_haptics::contact::Proxy;
use palpate_haptics::scene::TouchScene;
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;

use crate::touch::touchable::Body;

/// The probe in the grid of the scan.
#[derive(Debug)]
pub struct Probe<'a> {
    /// Where the scan stands.
    pub grid: &'a Grid,
    /// Where the probe is.
    pub proxy: &'a mut Proxy,
}

impl Probe<'_> {
    /// Whether the probe is free in `new`, if need be after a push through what is free in
    /// `old`.
    pub fn admits<N: Occupancy>(
        &mut self,
        old: &TouchScene<'_, Body>,
        new: &TouchScene<'_, N>,
    ) -> bool {
        admit_scene(old, new, self.proxy) != Admission::Held
    }

    /// Where the probe is.
    #[must_use]
    pub fn voxel(&self) -> IVec3 {
        self.proxy.voxel()
    }
}
