//! Particles back to voxels: what is solid where, and with which intensity.
//!
//! A voxel is cleared when fewer than half of the particles it has at rest (or, where it is
//! empty at rest, would have) are in it, and filled again from three quarters on; between, it
//! stays as it is. For the four particles of an FCC voxel that is below two and from three on,
//! for the one of a cuboid voxel none and one. A voxel in which another one's tissue stands
//! reads the mean of what stands in it; one that tissue has left reads air.
//! Source: thesis 5.25, whose threshold is not given; errata, section 4 (hysteresis).

use glam::{DVec3, IVec3};
use palpate_volume::edit::Edit;
use palpate_volume::segment_set::SegmentSet;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxel_state::VoxelState;
use palpate_volume::voxels::Voxels;

use super::state::Particles;
use crate::voxel_ledger::{Ledger, Wanted};

/// Share of its particles below which a voxel is cleared.
const CLEAR_BELOW: f64 = 0.5;
/// Share from which on it is filled.
const FILL_FROM: f64 = 0.75;

/// Rule by which voxels follow particles.
#[derive(Clone, Copy, Debug)]
pub(super) struct WriteBack {
    /// Particles of a voxel that is full.
    pub capacity: f64,
    /// Stored value where tissue left.
    pub air: i16,
}

/// What stands in a voxel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Standing {
    pub count: u32,
    pub at_rest: u32,
    stored: i64,
    from_elsewhere: bool,
    /// Sum of their displacements [voxels].
    come: DVec3,
    nearest: f64,
    segments: SegmentSet,
}

impl Standing {
    const NOTHING: Self = Self {
        count: 0,
        at_rest: 0,
        stored: 0,
        from_elsewhere: false,
        come: DVec3::ZERO,
        nearest: f64::INFINITY,
        segments: SegmentSet::EMPTY,
    };

    pub fn is_as_at_rest(&self) -> bool {
        self.count == self.at_rest && !self.from_elsewhere
    }

    /// How far what a voxel shows has come [voxels]; none where it shows no matter.
    pub fn shown(&self, matter: &VoxelState) -> Option<DVec3> {
        let mean = self.come / f64::from(self.count.max(1));
        (!matter.segments.is_empty()).then_some(mean)
    }
}

impl WriteBack {
    /// The edit that makes voxels of `region` follow the particles, and gives back all that
    /// the ledger knows of elsewhere; none where nothing changes.
    pub fn edit(
        &self,
        voxels: &Voxels,
        particles: &Particles,
        region: &VoxelBox,
        ledger: &mut Ledger,
    ) -> Option<Edit> {
        let standing = gather(voxels, particles, region);
        let mut wanted = Wanted::new();
        for (voxel, standing) in region.voxels().zip(&standing) {
            if standing.is_as_at_rest() && ledger.changed(voxel).is_none() {
                continue;
            }
            let (Some(rest), Some(now)) = (ledger.rest(voxels, voxel), voxels.state(voxel)) else {
                continue;
            };
            let matter = self.matter(standing, &rest, &now);
            wanted.insert(voxel.to_array(), (matter, standing.shown(&matter)));
        }
        // tissue whose particles have left the box goes back to rest
        ledger.give_back_outside(voxels, region, &mut wanted);
        ledger.write(voxels, &wanted)
    }

    /// What a voxel is with what stands in it.
    fn matter(&self, standing: &Standing, rest: &VoxelState, now: &VoxelState) -> VoxelState {
        let solid_at_rest = standing.at_rest > 0;
        // tissue that takes no part is never overwritten
        if !solid_at_rest && !rest.segments.is_empty() {
            return *rest;
        }
        let share = f64::from(standing.count) / self.full(standing);
        let solid = if share >= FILL_FROM {
            true
        } else if share < CLEAR_BELOW {
            false
        } else {
            !now.segments.is_empty()
        };
        self.of(solid, standing, rest)
    }

    /// Particles of a voxel that is full.
    pub fn full(&self, standing: &Standing) -> f64 {
        match standing.at_rest {
            0 => self.capacity,
            at_rest => f64::from(at_rest),
        }
    }

    /// What a voxel is with what stands in it, where that makes it solid or not.
    pub fn of(&self, solid: bool, standing: &Standing, rest: &VoxelState) -> VoxelState {
        let solid_at_rest = standing.at_rest > 0;
        match (solid, solid_at_rest) {
            (true, true) if !standing.from_elsewhere => *rest,
            (true, _) => VoxelState {
                stored: (standing.stored as f64 / f64::from(standing.count)).round() as i16,
                segments: if solid_at_rest {
                    rest.segments
                } else {
                    standing.segments
                },
            },
            (false, true) => VoxelState {
                stored: self.air,
                segments: SegmentSet::EMPTY,
            },
            (false, false) => *rest,
        }
    }
}

/// What stands in each voxel of the region, x fastest.
pub(super) fn gather(voxels: &Voxels, particles: &Particles, region: &VoxelBox) -> Vec<Standing> {
    let spacing = voxels.grid().spacing();
    let size = region.size().as_ivec3();
    let mut standing = vec![Standing::NOTHING; region.voxel_count() as usize];
    let place = |voxel: IVec3| {
        let offset = voxel - region.min;
        region
            .contains(voxel)
            .then(|| (offset.x + size.x * (offset.y + size.y * offset.z)) as usize)
    };
    let voxel_of = |at: DVec3| (at / spacing).floor().as_ivec3();
    for (index, origin) in particles.origins.iter().enumerate() {
        if let Some(home) = place(origin.voxel) {
            standing[home].at_rest += 1;
        }
        let position = particles.sites[index].position();
        // a particle that no longer lies over its voxel at rest (their cells differ) counts there
        let moved = voxel_of(position) - voxel_of(particles.homes[index]);
        let voxel = origin.voxel + moved;
        let Some(here) = place(voxel) else {
            continue;
        };
        let here = &mut standing[here];
        here.count += 1;
        here.stored += i64::from(origin.matter.stored);
        here.from_elsewhere |= moved != IVec3::ZERO;
        here.come += moved.as_dvec3();
        let distance = position.distance_squared((voxel.as_dvec3() + 0.5) * spacing);
        if distance < here.nearest {
            (here.nearest, here.segments) = (distance, origin.matter.segments);
        }
    }
    standing
}
