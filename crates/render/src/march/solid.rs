//! Surfaces of segments and of one value along rays, found between two samples, and their light.

use glam::Vec3;

use crate::lanes::{Floats, Gather, Ints, Masks, Vector, Work};
use crate::lighting::OwnFactors;
use crate::march::Packet;
use crate::shading::Shading;

/// Halvings between two samples.
const REFINEMENTS: usize = 5;

/// Code of what an iso-surface encloses; no segment has it.
pub(super) const ISO: i32 = -2;

/// Where between two samples a ray enters something solid, and what: of segments in one another the outer one.
/// `code` is what is solid at the second.
#[inline(always)]
pub(super) fn refined_entry<L: Gather>(
    shading: &Shading<'_>,
    packet: &Packet<L>,
    (mut before, mut inside): (L::Float, L::Float),
    mut code: L::Int,
    with_iso: bool,
) -> (L::Float, L::Int) {
    for _ in 0..REFINEMENTS {
        let middle = L::Float::splat(0.5) * (before + inside);
        let here = enclosed(shading, packet.at(middle), with_iso);
        let is_in = !here.equal(Ints::splat(0));
        inside = middle.or_else(is_in, inside);
        code = here.or_else(is_in, code);
        before = before.or_else(is_in, middle);
    }
    (inside, code)
}

/// Code of the solid body at a place, `ISO` inside the iso-surface, 0 where there is none.
#[inline(always)]
pub(super) fn enclosed<L: Gather>(
    shading: &Shading<'_>,
    grid: Vector<L>,
    with_iso: bool,
) -> L::Int {
    let (value, code) = shading.at(grid);
    let others = shading.is_others_turn(grid);
    let solid = shading.segments.are_solid::<L>(code) & !others;
    let none = L::Int::splat(0);
    if !with_iso {
        return code.or_else(solid, none);
    }
    let hidden = none.greater(code) | others;
    let above = L::Float::splat(0.0).at_most(shading.grey_of::<L>(value));
    let iso = L::Int::splat(ISO).or_else(above & !hidden, none);
    code.or_else(solid, iso)
}

/// Light of a solid body at a place; `cut`: through which face it is seen where one cuts it.
#[inline(always)]
pub(super) fn light_of_body<L: Gather>(
    shading: &Shading<'_>,
    packet: &Packet<L>,
    length: L::Float,
    code: L::Int,
    cut: (L::Mask, Vector<L>),
) -> Vector<L> {
    L::apart(LightOfBody {
        shading,
        packet,
        length,
        code,
        cut,
    })
}

/// What [`light_of_body`] is given.
struct LightOfBody<'a, L: Gather> {
    shading: &'a Shading<'a>,
    packet: &'a Packet<L>,
    length: L::Float,
    code: L::Int,
    cut: (L::Mask, Vector<L>),
}

impl<L: Gather> Work<L> for LightOfBody<'_, L> {
    type Done = Vector<L>;

    #[inline(always)]
    fn done(self) -> Vector<L> {
        let Self {
            shading,
            packet,
            length,
            code,
            cut: (cut, face),
        } = self;
        let grid = packet.at(length);
        let to_eye = packet.to_eye();
        let is_iso = code.equal(Ints::splat(ISO));
        let normal = shading.normal_at(grid, code).facing(to_eye);
        let normal = face.or_else(cut, normal);
        let near = if shading.is_in_haste {
            Floats::splat(1.0)
        } else {
            let with_iso = is_iso.any();
            openness(shading, grid, normal, &Body { code, with_iso })
        };
        let colour =
            Vector::splat(shading.iso_colour).or_else(is_iso, shading.segments.colour::<L>(code));
        let own: OwnFactors<L> = shading.segments.factors::<L>(code);
        let reaching = shading.lookup.at(grid, normal);
        shading
            .light
            .on_surface(colour, normal, to_eye, near, reaching, own)
    }
}

/// Which places belong to what has a surface.
pub(super) trait OwnPlaces<L: Gather> {
    /// Whether places do that are not cut away.
    fn at(&self, shading: &Shading<'_>, place: Vector<L>) -> L::Mask;
}

/// The bodies of rays, by their codes.
struct Body<L: Gather> {
    code: L::Int,
    with_iso: bool,
}

impl<L: Gather> OwnPlaces<L> for Body<L> {
    #[inline(always)]
    fn at(&self, shading: &Shading<'_>, place: Vector<L>) -> L::Mask {
        enclosed(shading, place, self.with_iso).equal(self.code) & !shading.is_cut_away(place)
    }
}

/// Fraction of the sky that is seen from a surface past the voxels around it: four cones about the normal and one
/// along it.
///
/// Source: Hernell et al., "Local ambient occlusion", IEEE TVCG 16 (2010), for sampling by cones.
#[inline(always)]
pub(super) fn openness<L: Gather>(
    shading: &Shading<'_>,
    grid: Vector<L>,
    normal: Vector<L>,
    own: &impl OwnPlaces<L>,
) -> L::Float {
    const CONES: [(f32, f32); 5] = [(0.0, 0.0), (1.1, 0.0), (-1.1, 0.0), (0.0, 1.1), (0.0, -1.1)];
    let zero = L::Float::splat(0.0);
    let side = sideways(normal);
    let other = normal.cross(side);
    let per_mm = Vector::splat(shading.field.spacing().recip());
    let mut covered = zero;
    for (across, upward) in CONES {
        let direction =
            (normal + side.scaled(Floats::splat(across)) + other.scaled(Floats::splat(upward)))
                .normalized()
                .times(per_mm);
        let mut hit = zero;
        let mut away = 2.2;
        for step in 0..4 {
            let place = grid.along(direction, Floats::splat(away));
            let inside = shading.is_in_scan(place);
            if inside.any() {
                let same = own.at(shading, place) & inside;
                // what is far away covers less
                let covers = L::Float::splat(1.0 - 0.2 * step as f32);
                hit = hit.max(covers.or_else(same, zero));
            }
            away *= 1.9;
        }
        covered = covered + hit;
    }
    L::Float::splat(1.0) - L::Float::splat(0.17) * covered
}

/// A unit vector across another.
#[inline(always)]
fn sideways<L: Gather>(normal: Vector<L>) -> Vector<L> {
    let upright = normal.z.abs().less(Floats::splat(0.9));
    let axis = Vector::<L>::splat(Vec3::Z).or_else(upright, Vector::splat(Vec3::X));
    normal.cross(axis).normalized()
}
