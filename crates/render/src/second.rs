//! A second scan that is shown through the first: where it lies, how it looks, and what rays see of it.
//!
//! Rays are those of the first scan; lengths along them are the same in both grids. Its light is that of the first scan,
//! and nothing shades what lies beside that. Both are seen through one another, or by turns. The page's shaders have
//! the same (`shaders/second/`).

use std::sync::Arc;

use glam::{Affine3A, DAffine3, Vec3};
use palpate_volume::grid::Grid;
use palpate_volume::voxels::Voxels;

use crate::appearance::{Appearance, Blend, ControlPoint, Lighting};
use crate::lanes::{Floats, Gather, Masks, Vector};
use crate::lighting::{OwnFactors, Reaching};
use crate::prepared::Prepared;
use crate::scene::{Scene, SceneError};
use crate::shading::{FAR_AWAY, Shading, boundary};

mod turns;

pub use turns::Turns;

/// A second scan, and where it lies.
#[derive(Clone, Debug)]
pub struct SecondScan {
    scene: Arc<Scene>,
    second_from_first: DAffine3,
}

impl SecondScan {
    /// Reads each value once. `second_from_first`: from points of the first scan to its own, patient of each [mm].
    ///
    /// # Errors
    /// Where there are too many voxels.
    pub fn new(voxels: Voxels, second_from_first: DAffine3) -> Result<Self, SceneError> {
        let scene = Arc::new(Scene::new(voxels)?);
        Ok(Self {
            scene,
            second_from_first,
        })
    }

    /// The same scan elsewhere; reads nothing again.
    #[must_use]
    pub fn moved(&self, second_from_first: DAffine3) -> Self {
        Self {
            scene: Arc::clone(&self.scene),
            second_from_first,
        }
    }
}

/// Colours from black to white in modes of grey.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tint {
    /// From red to yellow.
    #[default]
    Warm,
    /// From blue to light blue.
    Cool,
    /// Grey.
    Grey,
}

/// How a second scan is drawn, in its own unit; its light is that of the first.
#[derive(Clone, Debug, PartialEq)]
pub struct SecondAppearance {
    /// Factor on its extinction.
    pub density: f32,
    /// Transfer function: at least two points by rising value.
    pub transfer: Vec<ControlPoint>,
    /// Gradient from which on a boundary has its full strength [value per mm].
    pub edge_gradient: f64,
    /// Width and middle of the window in modes of grey.
    pub window: (f64, f64),
    /// Value of its iso-surface.
    pub iso_value: f64,
    /// Colour of that.
    pub iso_colour: Vec3,
    /// From this value on there is tissue.
    pub tissue_from: f64,
    /// Its colours in modes of grey.
    pub tint: Tint,
    /// Of those, and of its iso-surface, 0 to 1; where it is seen by turns nothing is seen through it.
    pub opacity: f32,
    /// Whether it is seen with the first, or by turns.
    pub turns: Turns,
}

impl SecondAppearance {
    /// As that of a scan that is seen alone.
    pub(crate) fn alone(&self, blend: Blend) -> Appearance {
        Appearance {
            blend,
            density: self.density,
            transfer: self.transfer.clone(),
            edge_gradient: self.edge_gradient,
            window: self.window,
            iso_value: self.iso_value,
            iso_colour: self.iso_colour,
            tissue_from: self.tissue_from,
            slab: None,
            lighting: Lighting::default(),
            segments: Vec::new(),
            surfaces: Vec::new(),
            clip: Vec::new(),
        }
    }
}

/// A second scan made ready for a first one and a mode.
#[derive(Clone, Debug)]
pub(crate) struct Second {
    scan: Arc<SecondScan>,
    prepared: Prepared,
    tint: Tint,
    /// Of its colours in modes of grey, and of its iso-surface.
    pub opacity: f32,
    pub turns: Turns,
    /// Size of the first scan's voxels [mm].
    spacing: Vec3,
    /// From its own grid to the first scan's.
    first_from_own: Affine3A,
    /// From the first scan's grid to its own: what a voxel along each axis is there, and where that grid begins.
    columns: [Vec3; 3],
    origin: Vec3,
    /// From differences over two voxels of the first to a gradient in its unit [per mm].
    gradient_scale: Vec3,
}

impl Second {
    pub fn new(
        scan: Arc<SecondScan>,
        appearance: &SecondAppearance,
        first: &Grid,
        blend: Blend,
    ) -> Self {
        let to_own = scan.scene.grid().grid_from_patient()
            * scan.second_from_first
            * first.patient_from_grid();
        let columns = to_own.matrix3.as_mat3();
        let slope = scan.scene.voxels().intensities().slope();
        let back = to_own.inverse();
        Self {
            opacity: match appearance.turns {
                Turns::Together => appearance.opacity,
                Turns::Cells(_) | Turns::Second => 1.0,
            },
            turns: appearance.turns,
            spacing: first.spacing().as_vec3(),
            first_from_own: Affine3A::from_mat3_translation(
                back.matrix3.as_mat3(),
                back.translation.as_vec3(),
            ),
            prepared: Prepared::new(&scan.scene, appearance.alone(blend)),
            tint: appearance.tint,
            columns: [columns.x_axis, columns.y_axis, columns.z_axis],
            origin: to_own.translation.as_vec3(),
            gradient_scale: (slope / (2.0 * first.spacing())).as_vec3(),
            scan,
        }
    }

    /// What rays need to know of it, beside the first scan.
    pub fn shading<'a>(&'a self, first: &Shading<'a>) -> Shading<'a> {
        let Prepared {
            appearance,
            transfer,
            segments,
            empty,
            grey,
            tissue_from,
            ..
        } = &self.prepared;
        let is_slab = first.slab.1 < FAR_AWAY;
        Shading {
            field: &self.scan.scene.field,
            displaced: None,
            second: None,
            own_turns: Some(self),
            segments,
            transfer,
            empty,
            planes: &[],
            density: appearance.density,
            edge_gradient: appearance.edge_gradient as f32,
            grey: *grey,
            // a slab is inside of the body: there all counts
            tissue_from: if is_slab { -FAR_AWAY } else { *tissue_from },
            iso_colour: appearance.iso_colour,
            ..*first
        }
    }

    /// Its place of a place of the first [grid].
    #[inline(always)]
    pub fn place<L: Gather>(&self, grid: Vector<L>) -> Vector<L> {
        Vector::splat(self.origin) + self.turned(grid)
    }

    /// A direction of the first grid in its own.
    #[inline(always)]
    pub fn turned<L: Gather>(&self, direction: Vector<L>) -> Vector<L> {
        let [x, y, z] = self.columns;
        Vector::splat(x).scaled(direction.x)
            + Vector::splat(y).scaled(direction.y)
            + Vector::splat(z).scaled(direction.z)
    }

    /// Normals of planes of its grid in the first one's axes, not of length 1.
    #[inline(always)]
    pub fn normal_in_first<L: Gather>(&self, normal: Vector<L>) -> Vector<L> {
        let [x, y, z] = self.columns;
        Vector::new(
            normal.dot(Vector::splat(x)),
            normal.dot(Vector::splat(y)),
            normal.dot(Vector::splat(z)),
        )
    }

    /// Where the second scan is; its own place.
    #[inline(always)]
    fn holds<L: Gather>(&self, place: Vector<L>) -> L::Mask {
        let zero = L::Float::splat(0.0);
        let end = self.scan.scene.field.dimensions().as_vec3();
        zero.at_most(place.x)
            & zero.at_most(place.y)
            & zero.at_most(place.z)
            & place.x.at_most(Floats::splat(end.x))
            & place.y.at_most(Floats::splat(end.y))
            & place.z.at_most(Floats::splat(end.z))
    }

    /// Gradient at its own place along the first scan's axes, over a voxel of that to each side [unit per mm].
    #[inline(always)]
    pub fn gradient_at<L: Gather>(&self, place: Vector<L>) -> Vector<L> {
        let field = &self.scan.scene.field;
        let [x, y, z] = self.columns;
        let (x, y, z) = (Vector::splat(x), Vector::splat(y), Vector::splat(z));
        Vector::new(
            field.value_at(place + x) - field.value_at(place - x),
            field.value_at(place + y) - field.value_at(place - y),
            field.value_at(place + z) - field.value_at(place - z),
        )
        .times(Vector::splat(self.gradient_scale))
    }

    /// Its colour alone, 0 to 1 on the screen; `share`: of its window.
    #[inline(always)]
    pub fn tinted<L: Gather>(&self, share: L::Float) -> Vector<L> {
        tinted(self.tint, share)
    }

    /// Its colour, 0 to 1 on the screen, over that of the first; `share`: of its window.
    ///
    /// What is black in a colour leaves the first as it is.
    #[inline(always)]
    pub fn blended<L: Gather>(&self, first: Vector<L>, share: L::Float) -> Vector<L> {
        let one = L::Float::splat(1.0);
        let shown = match self.tint {
            Tint::Grey => one,
            _ => (L::Float::splat(3.0) * share).min(one),
        };
        let weight = L::Float::splat(self.opacity) * shown;
        first + (tinted(self.tint, share) - first).scaled(weight)
    }
}

#[inline(always)]
fn tinted<L: Gather>(tint: Tint, share: L::Float) -> Vector<L> {
    let (zero, one) = (L::Float::splat(0.0), L::Float::splat(1.0));
    let low = (share * Floats::splat(1.6)).min(one);
    let middle = (share * Floats::splat(1.8) - Floats::splat(0.5))
        .max(zero)
        .min(one);
    let high = (share * Floats::splat(2.6) - Floats::splat(1.6))
        .max(zero)
        .min(one);
    match tint {
        Tint::Warm => Vector::new(low, middle, high),
        Tint::Cool => Vector::new(high, middle, low),
        Tint::Grey => Vector::new(share, share, share),
    }
}

/// A second scan for one picture.
#[derive(Clone, Copy)]
pub(crate) struct SecondShading<'a> {
    pub second: &'a Second,
    pub shading: Shading<'a>,
}

/// Tissue at a place.
pub(crate) struct Lit<L: Gather> {
    /// As it is lit.
    pub colour: Vector<L>,
    /// [1/mm]
    pub extinction: L::Float,
}

impl<L: Gather> Lit<L> {
    /// Two kinds of tissue in one place: both absorb, and each adds its light as much as it does.
    #[inline(always)]
    pub fn mixed_with(&self, colour: Vector<L>, extinction: L::Float) -> (Vector<L>, L::Float) {
        let sum = extinction + self.extinction;
        let weighted = colour.scaled(extinction) + self.colour.scaled(self.extinction);
        let share = L::Float::splat(1.0).div(sum.max(Floats::splat(1e-9)));
        (weighted.scaled(share), sum)
    }
}

impl SecondShading<'_> {
    /// What there is of its tissue at places of the first scan.
    #[inline(always)]
    pub fn lit<L: Gather>(
        &self,
        first: &Shading<'_>,
        grid: Vector<L>,
        to_eye: Vector<L>,
    ) -> Lit<L> {
        let Self { second, shading } = self;
        let zero = L::Float::splat(0.0);
        let none = Lit {
            colour: Vector::new(zero, zero, zero),
            extinction: zero,
        };
        let place = second.place(grid);
        let inside = match second.turns {
            Turns::Together => second.holds(place),
            Turns::Cells(_) | Turns::Second => second.has_turn(grid),
        };
        if !inside.any() {
            return none;
        }
        let value = shading.field.value_at(place);
        let (mut colour, extinction) = shading.transfer.tissue_at::<L>(value);
        let mut extinction = (extinction * Floats::splat(shading.density)).or_else(inside, zero);
        if first.blend.draws_solids() && zero.less(extinction).any() {
            let gradient = second.gradient_at(place);
            let strength = (shading.edge_gradient, first.flat_share);
            let (kept, boundary) = boundary::<L>(strength, gradient.length());
            extinction = extinction * kept;
            if first.blend == Blend::Shaded {
                let normal = gradient.facing(to_eye);
                let reaching = light_beside(first, grid, normal.scaled(boundary));
                let own = as_it_is();
                colour = first
                    .light
                    .on_tissue(colour, normal, to_eye, boundary, reaching, own);
            }
        }
        Lit { colour, extinction }
    }

    /// Its iso-surface at places of the first scan; `face`: the normal where one cuts it.
    #[inline(always)]
    pub fn light_of_surface<L: Gather>(
        &self,
        first: &Shading<'_>,
        grid: Vector<L>,
        to_eye: Vector<L>,
        (cut, face): (L::Mask, Vector<L>),
    ) -> Vector<L> {
        let gradient = self.second.gradient_at(self.second.place(grid));
        let normal = face.or_else(cut, gradient).facing(to_eye);
        let reaching = light_beside(first, grid, normal);
        let (colour, open) = (Vector::splat(self.shading.iso_colour), Floats::splat(1.0));
        first
            .light
            .on_surface(colour, normal, to_eye, open, reaching, as_it_is())
    }
}

#[inline(always)]
fn as_it_is<L: Gather>() -> OwnFactors<L> {
    OwnFactors {
        ambient: Floats::splat(1.0),
        specular: Floats::splat(1.0),
    }
}

/// Light is known where the first scan is, and nothing shades what lies beside it.
#[inline(always)]
fn light_beside<L: Gather>(first: &Shading<'_>, grid: Vector<L>, away: Vector<L>) -> Reaching<L> {
    let one = L::Float::splat(1.0);
    let known = first.lookup.at(grid, away);
    let inside = first.is_in_scan(grid);
    Reaching {
        sky: known.sky.or_else(inside, one),
        lamp: known.lamp.or_else(inside, one),
    }
}
