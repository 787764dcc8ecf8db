//! The surface where the scan has one value, found to 1/32 of a step, and solid segments beside it. That of a second scan is seen
//! through as its opacity says.
//!
//! Source: Hadwiger et al., "Real-time ray-casting and advanced shading of discrete isosurfaces", Computer Graphics
//! Forum 24 (2005).

use crate::lanes::{Floats, Gather, Ints, Masks, Vector, Work};
use crate::march::solid::{enclosed, light_of_body, refined_entry};
use crate::march::{Beside, Layers, MOST_SAMPLES, Packet, Seen};
use crate::shading::Shading;

/// Follows rays to the first surface; that of a second scan before it is seen through.
#[inline(always)]
pub(super) fn seen_along<'a, L: Gather>(
    shading: &Shading<'_>,
    packet: &Packet<L>,
    beside: Option<&Beside<'_, L>>,
    mut layers: Layers<'a, L>,
) -> (Seen<L>, Layers<'a, L>) {
    let (zero, one) = (L::Float::splat(0.0), L::Float::splat(1.0));
    let none = L::Int::splat(0);
    let mut seen = Seen {
        light: Vector::new(zero, zero, zero),
        clarity: one,
        depth: Floats::splat(-1.0),
        segment: none,
        haze: Floats::splat(-1.0),
    };
    let mut first = L::apart(Meet { shading, packet });
    let met = !first.code.equal(none);
    if let Some(beside) = beside {
        let mut other = L::apart(Meet {
            shading: &beside.second.shading,
            packet: &beside.rays,
        });
        first.open_at_side(shading, packet, (beside, packet));
        other.open_at_side(&beside.second.shading, &beside.rays, (beside, packet));
        let before = !other.code.equal(none) & (!met | other.length.less(first.length));
        layers.pass(shading, packet, other.length, before, &mut seen);
        pass_second(shading, packet, beside, &other, before, &mut seen);
    }
    if met.any() {
        let light = light_of_body(shading, packet, first.length, first.code, first.cut);
        layers.pass(shading, packet, first.length, met, &mut seen);
        seen.light = seen.light.along(light, seen.clarity.or_else(met, zero));
        seen.clarity = zero.or_else(met, seen.clarity);
        seen.note_depth(first.length, first.code.max(none), met);
    }
    (seen, layers)
}

/// Where rays meet a surface.
struct Met<L: Gather> {
    length: L::Float,
    /// Of the segment, or `ISO`; 0 where they meet none.
    code: L::Int,
    /// Whether a face cuts it there, and which.
    cut: (L::Mask, Vector<L>),
}

impl<L: Gather> Met<L> {
    /// What the side of a cell cuts is open there; `first`: the rays in the first scan, where cells are.
    #[inline(always)]
    fn open_at_side(
        &mut self,
        shading: &Shading<'_>,
        packet: &Packet<L>,
        (beside, first): (&Beside<'_, L>, &Packet<L>),
    ) {
        let (cut, face) = self.cut;
        let second = beside.second.second;
        let side = second.side_before(first, self.length, shading.step);
        let mut opens = side.is_crossed & !cut & !self.code.equal(Ints::splat(0));
        if opens.any() {
            let (value, code) = shading.at(packet.at(side.before));
            let none = L::Int::splat(0);
            let above = L::Float::splat(0.0).at_most(shading.grey_of::<L>(value));
            let encloses = shading.segments.are_solid::<L>(code) | (above & !none.greater(code));
            opens = opens & encloses;
        }
        self.cut = (cut | opens, side.face.or_else(opens, face));
    }
}

/// Goes to the first surface of a scan.
struct Meet<'a, L: Gather> {
    shading: &'a Shading<'a>,
    packet: &'a Packet<L>,
}

impl<L: Gather> Work<L> for Meet<'_, L> {
    type Done = Met<L>;

    #[inline(always)]
    fn done(self) -> Met<L> {
        let Self { shading, packet } = self;
        let zero = L::Float::splat(0.0);
        let none = L::Int::splat(0);
        let step = L::Float::splat(shading.step);
        let mut last = packet.enter;
        let mut next = last + packet.start * step;
        let mut code = none;
        for _ in 0..MOST_SAMPLES {
            let looks = last.less(packet.leave) & code.equal(none);
            if !looks.any() {
                break;
            }
            next = next.min(packet.leave).or_else(looks, next);
            let grid = packet.at(next);
            let leap = packet.steps_over_empty(shading, grid);
            let filled = looks & leap.at_most(zero);
            if filled.any() {
                code = enclosed(shading, grid, true).or_else(filled, code);
            }
            let passes = looks & code.equal(none);
            let before = (next + leap - step).or_else(zero.less(leap), next);
            last = before.or_else(passes, last);
            next = (last + step).or_else(passes, next);
        }
        let met = !code.equal(none);
        if !met.any() {
            return Met {
                length: zero,
                code,
                cut: (met, packet.face),
            };
        }
        let at_entry = enclosed(shading, packet.at(last), true);
        let cut = met & last.at_most(packet.enter) & !at_entry.equal(none);
        let (entry, refined) = refined_entry(shading, packet, (last, next), code, true);
        Met {
            length: last.or_else(cut, entry),
            code: at_entry.or_else(cut, refined).or_else(met, none),
            cut: (cut, packet.face),
        }
    }
}

/// Lets the light of a second scan's surface in.
#[inline(always)]
fn pass_second<L: Gather>(
    shading: &Shading<'_>,
    packet: &Packet<L>,
    beside: &Beside<'_, L>,
    met: &Met<L>,
    lanes: L::Mask,
    seen: &mut Seen<L>,
) {
    if !lanes.any() {
        return;
    }
    let grid = packet.at(met.length);
    let second = beside.second;
    let light = second.light_of_surface(shading, grid, packet.to_eye(), met.cut);
    let opacity = L::Float::splat(second.second.opacity);
    let share = (seen.clarity * opacity).or_else(lanes, Floats::splat(0.0));
    seen.light = seen.light.along(light, share);
    seen.clarity = seen.clarity - share;
    seen.note_depth(met.length, Ints::splat(0), lanes);
}
