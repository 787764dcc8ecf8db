//! What is seen along rays, eight at a time: one file for each family of optical models.

mod iso;
mod layers;
mod projection;
mod ray;
mod solid;
mod tissue;

use crate::appearance::Blend;
use crate::lanes::{Floats, Gather, Ints, Vector};
use crate::shading::Shading;

pub(crate) use layers::Layers;
pub(crate) use ray::{Beside, PACKET, Packet, Pixels};

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
    /// Length at which lies what is seen through, in modes that show all of a ray [mm]; below 0 where nothing is.
    pub haze: L::Float,
}

impl<L: Gather> Seen<L> {
    /// Notes where rays became more opaque than clear.
    #[inline(always)]
    fn note_depth(&mut self, length: L::Float, segment: L::Int, lanes: L::Mask) {
        let opaque = self.clarity.less(Floats::splat(0.5));
        let first = self.depth.less(Floats::splat(0.0)) & opaque & lanes;
        self.depth = length.or_else(first, self.depth);
        self.segment = segment.or_else(first, self.segment);
    }
}

/// Follows a packet of rays, also through a second scan, past the surfaces in their way.
#[inline(always)]
pub(crate) fn seen_along<L: Gather>(
    shading: &Shading<'_>,
    packet: &Packet<L>,
    beside: Option<&Beside<'_, L>>,
    layers: Layers<'_, L>,
) -> Seen<L> {
    let (mut seen, layers) = match shading.blend {
        Blend::Shaded | Blend::Composite | Blend::Absorption | Blend::Emission => {
            tissue::seen_along(shading, packet, beside, layers)
        }
        Blend::Mip | Blend::MinIp | Blend::Average => {
            (projection::seen_along(shading, packet, beside), layers)
        }
        Blend::Iso => iso::seen_along(shading, packet, beside, layers),
    };
    layers.end(shading, packet, &mut seen);
    seen
}
