//! The surface where the scan has one value, found to 1/32 of a step, and solid segments beside it.
//!
//! Source: Hadwiger et al., "Real-time ray-casting and advanced shading of discrete isosurfaces", Computer Graphics
//! Forum 24 (2005).

use crate::lanes::{Floats, Gather, Ints, Masks, Vector};
use crate::march::solid::{enclosed, light_of_body, refined_entry};
use crate::march::{Layers, MOST_SAMPLES, Packet, Seen};
use crate::shading::Shading;

/// Follows rays to the first surface.
#[inline(always)]
pub(super) fn seen_along<'a, L: Gather>(
    shading: &Shading<'_>,
    packet: &Packet<L>,
    mut layers: Layers<'a, L>,
) -> (Seen<L>, Layers<'a, L>) {
    let (zero, one) = (L::Float::splat(0.0), L::Float::splat(1.0));
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
    let dark = Vector::new(zero, zero, zero);
    let mut seen = Seen {
        light: dark,
        clarity: one,
        depth: Floats::splat(-1.0),
        segment: none,
    };
    if !met.any() {
        return (seen, layers);
    }
    let at_entry = enclosed(shading, packet.at(last), true);
    let cut = met & last.at_most(packet.enter) & !at_entry.equal(none);
    let (entry, refined) = refined_entry(shading, packet, (last, next), code, true);
    let end = last.or_else(cut, entry);
    let code = at_entry.or_else(cut, refined);
    let light = light_of_body(shading, packet, end, code, cut);
    layers.pass(shading, packet, end, met, &mut seen);
    seen.light = seen
        .light
        .along(light, seen.clarity.or_else(met, Floats::splat(0.0)));
    seen.clarity = zero.or_else(met, seen.clarity);
    seen.note_depth(end, code.max(none), met);
    (seen, layers)
}
