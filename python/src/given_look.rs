//! Cameras and looks of pictures as Python has them, see `palpate.pictures`.

use glam::{DVec3, Vec3};
use palpate_render::appearance::{
    Appearance, Blend, ControlPoint, Lighting, Plane, Shown, ShownSegment, ShownSurface,
};
use palpate_render::camera::Camera;
use palpate_render::second::{SecondAppearance, Tint, Turns};
use pyo3::prelude::*;

use crate::arrays::{Triple, vector};
use crate::errors::CoreError;

/// A colour as Python has it.
pub type Colour = (f32, f32, f32);

/// A camera as Python has it, see `palpate.pictures.camera`.
#[derive(FromPyObject)]
pub struct GivenCamera {
    target: Triple,
    distance: f64,
    right: Triple,
    up: Triple,
    back: Triple,
    field: f64,
    parallel: Option<f64>,
    aside: f64,
}

/// Light as Python has it, see `palpate.pictures.appearance`.
#[derive(FromPyObject)]
pub struct GivenLighting {
    ambient: f32,
    diffuse: f32,
    specular: f32,
    shininess: f32,
    edges: f32,
    occlusion: f32,
    shadow: f32,
}

/// A segment as Python has it, see `palpate.pictures.appearance`.
#[derive(FromPyObject)]
pub struct GivenSegment {
    id: u8,
    range: Option<(f64, f64)>,
    edited: bool,
    shown: String,
    colour: Colour,
    ambient: f32,
    specular: f32,
}

/// How a second scan looks as Python has it, see `palpate.pictures.appearance`.
#[derive(FromPyObject)]
pub struct GivenSecond {
    density: f32,
    transfer: Vec<(f64, Colour, f32)>,
    edge_gradient: f64,
    window: (f64, f64),
    iso_value: f64,
    iso_colour: Colour,
    tissue_from: f64,
    tint: String,
    opacity: f32,
    turns: String,
    cells: f32,
}

/// A segment's surface as Python has it, see `palpate.pictures.appearance`.
#[derive(FromPyObject)]
pub struct GivenSurface {
    id: u8,
    colour: Colour,
    opacity: f32,
    wireframe: bool,
    ambient: f32,
    specular: f32,
}

/// An appearance as Python has it, see `palpate.pictures.appearance`.
#[derive(FromPyObject)]
pub struct GivenAppearance {
    mode: String,
    density: f32,
    transfer: Vec<(f64, Colour, f32)>,
    edge_gradient: f64,
    window: (f64, f64),
    iso_value: f64,
    iso_colour: Colour,
    tissue_from: f64,
    slab: Option<f64>,
    lighting: GivenLighting,
    segments: Vec<GivenSegment>,
    surfaces: Vec<GivenSurface>,
    clip: Vec<(Triple, f64)>,
}

impl GivenCamera {
    pub fn checked(&self) -> Result<Camera, CoreError> {
        let camera = Camera {
            target: vector(self.target),
            distance: self.distance,
            right: vector(self.right),
            up: vector(self.up),
            back: vector(self.back),
            field: self.field,
            parallel: self.parallel,
            aside: self.aside,
        };
        camera.check()?;
        Ok(camera)
    }
}

impl GivenAppearance {
    pub fn checked(self) -> Result<Appearance, CoreError> {
        let appearance = Appearance {
            blend: mode(&self.mode)?,
            density: self.density,
            transfer: self.transfer.into_iter().map(control_point).collect(),
            edge_gradient: self.edge_gradient,
            window: self.window,
            iso_value: self.iso_value,
            iso_colour: self.iso_colour.into(),
            tissue_from: self.tissue_from,
            slab: self.slab,
            lighting: self.lighting.into(),
            segments: self
                .segments
                .into_iter()
                .map(ShownSegment::try_from)
                .collect::<Result<_, _>>()?,
            surfaces: self.surfaces.into_iter().map(ShownSurface::from).collect(),
            clip: self.clip.into_iter().map(plane).collect(),
        };
        appearance.check()?;
        Ok(appearance)
    }
}

impl GivenSecond {
    pub fn checked(self) -> Result<SecondAppearance, CoreError> {
        let appearance = SecondAppearance {
            density: self.density,
            transfer: self.transfer.into_iter().map(control_point).collect(),
            edge_gradient: self.edge_gradient,
            window: self.window,
            iso_value: self.iso_value,
            iso_colour: self.iso_colour.into(),
            tissue_from: self.tissue_from,
            tint: tint(&self.tint)?,
            opacity: self.opacity,
            turns: turns(&self.turns, self.cells)?,
        };
        appearance.check()?;
        Ok(appearance)
    }
}

fn turns(name: &str, cells: f32) -> Result<Turns, CoreError> {
    match name {
        "together" => Ok(Turns::Together),
        "cells" => Ok(Turns::Cells(cells)),
        "second" => Ok(Turns::Second),
        _ => Err(CoreError::value(format!(
            "turns {name} given; allowed: together, cells, second"
        ))),
    }
}

fn tint(name: &str) -> Result<Tint, CoreError> {
    match name {
        "warm" => Ok(Tint::Warm),
        "cool" => Ok(Tint::Cool),
        "grey" => Ok(Tint::Grey),
        _ => Err(CoreError::value(format!(
            "tint {name} given; allowed: warm, cool, grey"
        ))),
    }
}

fn mode(name: &str) -> Result<Blend, CoreError> {
    Ok(match name {
        "shaded" => Blend::Shaded,
        "composite" => Blend::Composite,
        "absorption" => Blend::Absorption,
        "emission" => Blend::Emission,
        "mip" => Blend::Mip,
        "minip" => Blend::MinIp,
        "average" => Blend::Average,
        "iso" => Blend::Iso,
        _ => {
            return Err(CoreError::value(format!(
                "mode {name} given; allowed: shaded, composite, absorption, emission, mip, minip, average, iso"
            )));
        }
    })
}

fn control_point((value, colour, extinction): (f64, Colour, f32)) -> ControlPoint {
    ControlPoint {
        value,
        colour: Vec3::from(colour),
        extinction,
    }
}

pub fn plane((normal, offset): (Triple, f64)) -> Plane {
    let normal: DVec3 = vector(normal);
    Plane { normal, offset }
}

impl From<GivenLighting> for Lighting {
    fn from(given: GivenLighting) -> Self {
        Self {
            ambient: given.ambient,
            diffuse: given.diffuse,
            specular: given.specular,
            shininess: given.shininess,
            edges: given.edges,
            occlusion: given.occlusion,
            shadow: given.shadow,
        }
    }
}

impl From<GivenSurface> for ShownSurface {
    fn from(given: GivenSurface) -> Self {
        Self {
            id: given.id,
            colour: given.colour.into(),
            opacity: given.opacity,
            is_wireframe: given.wireframe,
            ambient: given.ambient,
            specular: given.specular,
        }
    }
}

impl TryFrom<GivenSegment> for ShownSegment {
    type Error = CoreError;

    fn try_from(given: GivenSegment) -> Result<Self, CoreError> {
        let shown = match given.shown.as_str() {
            "solid" => Shown::Solid,
            "tinted" => Shown::Tinted,
            "hidden" => Shown::Hidden,
            name => {
                return Err(CoreError::value(format!(
                    "segment shown as {name} given; allowed: solid, tinted, hidden"
                )));
            }
        };
        Ok(Self {
            id: given.id,
            range: given.range,
            is_edited: given.edited,
            shown,
            colour: given.colour.into(),
            ambient: given.ambient,
            specular: given.specular,
        })
    }
}
