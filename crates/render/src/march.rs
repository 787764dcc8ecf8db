//! What is seen along rays, eight at a time: one file for each family of optical models.

mod iso;
mod projection;
mod ray;
mod solid;
mod tissue;

use crate::appearance::Blend;
use crate::lanes::{Gather, Vector};
use crate::shading::Shading;

pub(crate) use ray::{PACKET, Packet, Pixels};

/// Share of light below which nothing behind is seen.
pub(crate) const CLEAR_ENOUGH: f32 = 0.012;

/// Samples along a ray, whatever it is given.
const MOST_SAMPLES: u32 = 8192;

/// What was seen along rays.
pub(crate) struct Seen<L: Gather> {
    /// Linear colour, weighted by opacity.
    pub light: Vector<L>,
    /// Fraction of the light behind that passes.
    pub clarity: L::Float,
    /// Length at which a ray became more opaque than clear [mm], below 0 where it has not.
    pub depth: L::Float,
    /// Code of the segment there; see [`crate::segments::Segments`].
    pub segment: L::Int,
}

/// Follows a packet of rays.
#[inline(always)]
pub(crate) fn seen_along<L: Gather>(shading: &Shading<'_>, packet: &Packet<L>) -> Seen<L> {
    match shading.blend {
        Blend::Shaded | Blend::Composite | Blend::Absorption | Blend::Emission => {
            tissue::seen_along(shading, packet)
        }
        Blend::Mip | Blend::MinIp | Blend::Average => projection::seen_along(shading, packet),
        Blend::Iso => iso::seen_along(shading, packet),
    }
}
