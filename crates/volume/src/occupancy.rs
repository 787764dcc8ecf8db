//! Which voxels stand in the way of a probe: the one question touch asks of a scan.
//!
//! Frame: grid. Outside the grid nothing is solid. Several segments together are solid
//! where any of them is.

use std::sync::Arc;

use glam::{DVec3, IVec3, UVec3};

use crate::bit_brick::BitBrick;
use crate::bits::Bits;
use crate::block::block_of_bits;
use crate::first_solid::{Traversal, free_way, traversed};
use crate::segment::Segment;

/// Which voxels are solid. Outside the grid nothing is. Answers must not change during a
/// traversal; they neither allocate nor panic.
pub trait Occupancy {
    /// Whether this voxel is solid.
    fn is_solid(&self, voxel: IVec3) -> bool;

    /// The first solid voxel between two points, of at most `max_visits` that are asked for, but
    /// always one; see [`crate::first_solid::first_solid_bounded`]. Whoever is one of several kinds
    /// says so here once, and not for each voxel.
    #[inline]
    fn first_solid(&self, start: DVec3, end: DVec3, max_visits: u32) -> Traversal {
        traversed(self, start, end, max_visits)
    }

    /// The 8×8×8 voxels from `min` on, as bits counted from there.
    #[inline]
    fn block(&self, min: IVec3) -> BitBrick {
        BitBrick::from_fn(UVec3::splat(8), |offset| self.is_solid(min + offset))
    }

    /// The same for the smooth surface that is felt. It differs where what is solid errs to the
    /// safe side, as the cells do in which the middle of a ball cannot be.
    #[inline]
    fn smooth_block(&self, min: IVec3) -> BitBrick {
        self.block(min)
    }

    /// Works out ahead what [`Self::smooth_block`] tells of the brick that begins at `min`, where
    /// that is not at hand; whether there was any work. It changes no answer.
    #[inline]
    fn prepare_smooth_brick(&self, _min: IVec3) -> bool {
        false
    }

    /// How far the probe's middle keeps from the surface of [`Self::smooth_block`] [mm]: the
    /// radius of a ball, where solid is what its middle cannot be in.
    #[inline]
    fn probe_radius_mm(&self) -> f64 {
        0.0
    }

    /// Whether [`Self::occupancy_fraction`] ever tells anything.
    #[inline]
    fn knows_fractions(&self) -> bool {
        false
    }

    /// How much of a voxel at the surface of [`Self::smooth_block`] is solid, 0..=1: at least ½
    /// of a solid one and at most ½ of a free one. None where nothing is known beyond its bit.
    #[inline]
    fn occupancy_fraction(&self, _voxel: IVec3, _solid: bool) -> Option<f32> {
        None
    }

    /// By how much each of some voxels, told with whether it is solid, counts for more or less
    /// than its bit: what [`Self::occupancy_fraction`] is beyond that, and 0 where it tells nothing. Whoever
    /// can tell of several at once does so here.
    #[inline]
    fn fraction_changes(&self, voxels: &[(IVec3, bool)], changes: &mut [f32]) {
        for (change, (voxel, solid)) in changes.iter_mut().zip(voxels) {
            let beyond_bit = |fraction: f32| fraction - f32::from(u8::from(*solid));
            *change = self
                .occupancy_fraction(*voxel, *solid)
                .map_or(0.0, beyond_bit);
        }
    }
}

impl Occupancy for Bits {
    #[inline]
    fn is_solid(&self, voxel: IVec3) -> bool {
        Bits::is_solid(self, voxel)
    }

    #[inline]
    fn first_solid(&self, start: DVec3, end: DVec3, max_visits: u32) -> Traversal {
        free_way(self, start, end, max_visits)
            .unwrap_or_else(|| traversed(self, start, end, max_visits))
    }

    #[inline]
    fn block(&self, min: IVec3) -> BitBrick {
        block_of_bits(self, min)
    }
}

impl Occupancy for Segment {
    #[inline]
    fn is_solid(&self, voxel: IVec3) -> bool {
        self.contains(voxel)
    }

    #[inline]
    fn block(&self, min: IVec3) -> BitBrick {
        self.occupancy().block(min)
    }
}

/// The union of bodies that one probe touches: all of them know the same radius, or none.
impl<O: Occupancy> Occupancy for [O] {
    #[inline]
    fn is_solid(&self, voxel: IVec3) -> bool {
        self.iter().any(|part| part.is_solid(voxel))
    }

    #[inline]
    fn block(&self, min: IVec3) -> BitBrick {
        union(self.iter().map(|part| part.block(min)))
    }

    #[inline]
    fn smooth_block(&self, min: IVec3) -> BitBrick {
        union(self.iter().map(|part| part.smooth_block(min)))
    }

    #[inline]
    fn prepare_smooth_brick(&self, min: IVec3) -> bool {
        self.iter().any(|part| part.prepare_smooth_brick(min))
    }

    #[inline]
    fn probe_radius_mm(&self) -> f64 {
        let radii = self.iter().map(Occupancy::probe_radius_mm);
        radii.fold(0.0, f64::max)
    }

    #[inline]
    fn knows_fractions(&self) -> bool {
        self.iter().any(Occupancy::knows_fractions)
    }

    /// The largest of the parts; one of which nothing more is known fills all or nothing.
    #[inline]
    fn occupancy_fraction(&self, voxel: IVec3, _solid: bool) -> Option<f32> {
        let fraction_of = |part: &O| {
            let is_solid = part.smooth_block(voxel).contains(IVec3::ZERO);
            let fraction = part.occupancy_fraction(voxel, is_solid);
            (
                fraction.unwrap_or(f32::from(u8::from(is_solid))),
                fraction.is_some(),
            )
        };
        let fractions = self.iter().map(fraction_of);
        let (largest, is_known) =
            fractions.fold((0.0, false), |(largest, is_known), (fraction, known)| {
                (f32::max(largest, fraction), is_known || known)
            });
        is_known.then_some(largest)
    }
}

fn union(blocks: impl Iterator<Item = BitBrick>) -> BitBrick {
    blocks.fold(BitBrick::EMPTY, |union, part| {
        BitBrick(std::array::from_fn(|z| union.0[z] | part.0[z]))
    })
}

/// A place that may be vacant: nothing is solid then.
impl<O: Occupancy> Occupancy for Option<O> {
    #[inline]
    fn is_solid(&self, voxel: IVec3) -> bool {
        self.as_ref().is_some_and(|part| part.is_solid(voxel))
    }

    #[inline]
    fn first_solid(&self, start: DVec3, end: DVec3, max_visits: u32) -> Traversal {
        match self {
            Some(part) => part.first_solid(start, end, max_visits),
            None => traversed(self, start, end, max_visits),
        }
    }

    #[inline]
    fn block(&self, min: IVec3) -> BitBrick {
        let part = self.as_ref();
        part.map_or(BitBrick::EMPTY, |part| part.block(min))
    }

    #[inline]
    fn smooth_block(&self, min: IVec3) -> BitBrick {
        let part = self.as_ref();
        part.map_or(BitBrick::EMPTY, |part| part.smooth_block(min))
    }

    #[inline]
    fn prepare_smooth_brick(&self, min: IVec3) -> bool {
        let part = self.as_ref();
        part.is_some_and(|part| part.prepare_smooth_brick(min))
    }

    #[inline]
    fn probe_radius_mm(&self) -> f64 {
        self.as_ref().map_or(0.0, O::probe_radius_mm)
    }

    #[inline]
    fn knows_fractions(&self) -> bool {
        self.as_ref().is_some_and(O::knows_fractions)
    }

    #[inline]
    fn occupancy_fraction(&self, voxel: IVec3, solid: bool) -> Option<f32> {
        self.as_ref()?.occupancy_fraction(voxel, solid)
    }

    #[inline]
    fn fraction_changes(&self, voxels: &[(IVec3, bool)], changes: &mut [f32]) {
        match self {
            Some(part) => part.fraction_changes(voxels, changes),
            None => changes.fill(0.0),
        }
    }
}

/// Passes every question on to the occupancy inside: one list, so that no wrapper answers one of
/// them by default, and a ball keeps its radius in all of them.
macro_rules! pass_on {
    ($(#[$doc:meta])* [$($generics:tt)*] $wrapper:ty, $this:ident => $inner:expr) => {
        $(#[$doc])*
        impl<$($generics)*> Occupancy for $wrapper {
            #[inline]
            fn is_solid(&self, voxel: IVec3) -> bool {
                let $this = self;
                $inner.is_solid(voxel)
            }

            #[inline]
            fn first_solid(&self, start: DVec3, end: DVec3, max_visits: u32) -> Traversal {
                let $this = self;
                $inner.first_solid(start, end, max_visits)
            }

            #[inline]
            fn block(&self, min: IVec3) -> BitBrick {
                let $this = self;
                $inner.block(min)
            }

            #[inline]
            fn smooth_block(&self, min: IVec3) -> BitBrick {
                let $this = self;
                $inner.smooth_block(min)
            }

            #[inline]
            fn prepare_smooth_brick(&self, min: IVec3) -> bool {
                let $this = self;
                $inner.prepare_smooth_brick(min)
            }

            #[inline]
            fn probe_radius_mm(&self) -> f64 {
                let $this = self;
                $inner.probe_radius_mm()
            }

            #[inline]
            fn knows_fractions(&self) -> bool {
                let $this = self;
                $inner.knows_fractions()
            }

            #[inline]
            fn occupancy_fraction(&self, voxel: IVec3, solid: bool) -> Option<f32> {
                let $this = self;
                $inner.occupancy_fraction(voxel, solid)
            }

            #[inline]
            fn fraction_changes(&self, voxels: &[(IVec3, bool)], changes: &mut [f32]) {
                let $this = self;
                $inner.fraction_changes(voxels, changes);
            }
        }
    };
}

pass_on! { [O: Occupancy + ?Sized] &O, this => (**this) }
pass_on! { [O: Occupancy + ?Sized] Box<O>, this => (**this) }
pass_on! { [O: Occupancy + ?Sized] Arc<O>, this => (**this) }
pass_on! { /// The union.
    [O: Occupancy, const N: usize] [O; N], this => this.as_slice()
}
pass_on! { /// The union.
    [O: Occupancy] Vec<O>, this => this.as_slice()
}
