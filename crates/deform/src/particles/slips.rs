//! Slip: neighbours at rest that have parted. A crystal gives way by rows, and the force falls then.

use glam::DVec3;

use super::neighbours::NeighbourList;
use super::state::Particles;

/// Particles are neighbours where they rest nearer than this [spacings]: between the first and
/// the second shell.
const NEIGHBOURS: f64 = 1.2;
/// A link has parted from here on [spacings]: beyond its greatest pull, at 1.11, and before the
/// second shell.
const PARTED: f64 = 1.3;

/// How many links have parted so far, of those whose ends are still within reach.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slips {
    parted: u32,
}

impl Slips {
    /// Counts again; gives how many more there are than at the last look, and the middle of all.
    pub fn look(
        &mut self,
        particles: &Particles,
        list: &NeighbourList,
        spacing: f64,
    ) -> Option<(u32, DVec3)> {
        let Particles { sites, homes, .. } = particles;
        if list.particle_count() != sites.len() {
            return None;
        }
        let [near, far] = [NEIGHBOURS, PARTED].map(|share| (share * spacing).powi(2));
        let (mut count, mut sum) = (0, DVec3::ZERO);
        for (one, site) in sites.iter().enumerate() {
            // each link once
            for other in list.neighbours(one).filter(|&other| other > one) {
                let place = sites[other].position();
                let has_parted = homes[one].distance_squared(homes[other]) < near
                    && site.position().distance_squared(place) > far;
                if has_parted {
                    count += 1;
                    sum += 0.5 * (site.position() + place);
                }
            }
        }
        let before = std::mem::replace(&mut self.parted, count);
        (count > before).then(|| (count - before, sum / f64::from(count)))
    }
}
