//! What a ray needs to know while it runs: the scan, how it is drawn, and the light.

use glam::{Vec3, Vec4};

use crate::appearance::Blend;
use crate::bricks::EmptySpace;
use crate::displaced::Displaced;
use crate::field::Field;
use crate::lanes::{Floats, Gather, Ints, Masks, Vector, smoothstep};
use crate::light_volume::LightLookup;
use crate::lighting::Light;
use crate::second::{Second, SecondShading};
use crate::segments::Segments;
use crate::transfer::Transfer;

/// Farther than anything in a scene [mm].
pub(crate) const FAR_AWAY: f32 = 1e9;

/// A scene and its appearance, for one picture.
#[derive(Clone, Copy)]
pub(crate) struct Shading<'a> {
    pub blend: Blend,
    pub field: &'a Field,
    /// Tissue beside its voxels.
    pub displaced: Option<&'a Displaced>,
    pub second: Option<&'a SecondShading<'a>>,
    /// Where this is the second scan: how it is seen beside the first.
    pub own_turns: Option<&'a Second>,
    pub segments: &'a Segments,
    pub transfer: &'a Transfer,
    pub empty: &'a EmptySpace,
    pub light: Light,
    pub lookup: LightLookup<'a>,
    /// Normals toward what is cut away and a number: their sum over a point of the grid is how far it lies before
    /// the plane [mm].
    pub planes: &'a [Vec4],
    pub density: f32,
    /// Gradient of a full boundary [value per mm], and the fraction of its extinction that homogeneous tissue keeps.
    pub edge_gradient: f32,
    pub flat_share: f32,
    /// Fraction of the window at a stored value, or its height over the iso-value: factor and term.
    pub grey: (f32, f32),
    /// The same fraction from which on there is tissue.
    pub tissue_from: f32,
    pub iso_colour: Vec3,
    /// Length of a step [mm].
    pub step: f32,
    /// Depths between which is looked [mm].
    pub slab: (f32, f32),
    /// Without the occlusion by the nearest voxels.
    pub is_in_haste: bool,
}

impl Shading<'_> {
    /// Value and segment of a place; nothing that was cut away belongs to a segment.
    #[inline(always)]
    pub fn at<L: Gather>(&self, grid: Vector<L>) -> (L::Float, L::Int) {
        let rest = self.at_rest(grid);
        let value = self.field.value_at(rest);
        (value, self.segments.at(self.field, rest, value))
    }

    /// The same without segments where another scan is seen.
    #[inline(always)]
    pub fn seen_at<L: Gather>(&self, grid: Vector<L>) -> (L::Float, L::Int) {
        let (value, code) = self.at(grid);
        let others = self.is_others_turn(grid);
        (value, L::Int::splat(0).or_else(others, code))
    }

    /// Whether another scan is seen at places, and nothing of this one.
    #[inline(always)]
    pub fn is_others_turn<L: Gather>(&self, grid: Vector<L>) -> L::Mask {
        match (self.second, self.own_turns) {
            (Some(other), _) => other.second.has_turn(grid),
            (None, Some(own)) => !own.shows_own(grid),
            (None, None) => Masks::splat(false),
        }
    }

    /// Stored value of what is seen at a place.
    #[inline(always)]
    pub fn value_at<L: Gather>(&self, grid: Vector<L>) -> L::Float {
        self.field.value_at(self.at_rest(grid))
    }

    /// Gradient of what is seen, in the scan's unit [per mm].
    #[inline(always)]
    pub fn gradient_at<L: Gather>(&self, grid: Vector<L>) -> Vector<L> {
        match self.displaced {
            Some(displaced) if displaced.hold(grid, 1.0).any() => {
                displaced.gradient_at(self.field, grid)
            }
            _ => self.field.gradient_at(grid),
        }
    }

    /// Outward normal of a segment's surface at a place.
    #[inline(always)]
    pub fn normal_at<L: Gather>(&self, grid: Vector<L>, code: L::Int) -> Vector<L> {
        let smooth = self.gradient_at(grid);
        self.segments
            .normal_at(self.field, smooth, self.at_rest(grid), code)
    }

    /// Where the tissue that stands at a place is at rest, in the voxels that show it.
    #[inline(always)]
    fn at_rest<L: Gather>(&self, grid: Vector<L>) -> Vector<L> {
        match self.displaced {
            None => grid,
            Some(displaced) => displaced.at_rest(grid),
        }
    }

    /// Fraction of the window at a stored value.
    #[inline(always)]
    pub fn grey_of<L: Gather>(&self, value: L::Float) -> L::Float {
        value * Floats::splat(self.grey.0) + Floats::splat(self.grey.1)
    }

    #[inline(always)]
    pub fn is_cut_away<L: Gather>(&self, grid: Vector<L>) -> L::Mask {
        is_before_a_plane(self.planes, grid)
    }

    /// Fraction of its extinction that tissue keeps with a gradient of this length [value per mm], and how much of a
    /// boundary that is.
    #[inline(always)]
    pub fn boundary<L: Gather>(&self, gradient: L::Float) -> (L::Float, L::Float) {
        boundary::<L>((self.edge_gradient, self.flat_share), gradient)
    }

    #[inline(always)]
    pub fn is_in_scan<L: Gather>(&self, grid: Vector<L>) -> L::Mask {
        let zero = L::Float::splat(0.0);
        let end = self.end();
        zero.less(grid.x)
            & zero.less(grid.y)
            & zero.less(grid.z)
            & grid.x.less(Floats::splat(end.x))
            & grid.y.less(Floats::splat(end.y))
            & grid.z.less(Floats::splat(end.z))
    }

    /// The scan's last corner [grid].
    pub fn end(&self) -> Vec3 {
        self.field.dimensions().as_vec3()
    }
}

/// Whether one of the planes cuts a place away.
#[inline(always)]
pub(crate) fn is_before_a_plane<L: Gather>(planes: &[Vec4], grid: Vector<L>) -> L::Mask {
    let mut cut = L::Mask::splat(false);
    for plane in planes {
        let before = grid.dot(Vector::splat(plane.truncate())) + Floats::splat(plane.w);
        cut = cut | L::Float::splat(0.0).less(before);
    }
    cut
}

/// Fraction of its extinction that tissue keeps with a gradient of this length, and how much of a boundary that is;
/// from the gradient of a full boundary and the fraction that homogeneous tissue keeps.
///
/// Source: Levoy, "Display of surfaces from volume data", IEEE CG&A 8 (1988).
#[inline(always)]
pub(crate) fn boundary<L: Gather>(
    (edge_gradient, flat_share): (f32, f32),
    gradient: L::Float,
) -> (L::Float, L::Float) {
    let boundary = smoothstep::<L>(edge_gradient, gradient);
    let flat = L::Float::splat(flat_share);
    (flat + (L::Float::splat(1.0) - flat) * boundary, boundary)
}
