//! How a scan is drawn: all but the camera. Values are in the unit of the scan, lengths in mm, colours
//! linear RGB from 0 to 1.

use glam::Vec3;
pub use palpate_volume::clip::Plane;

/// How the values along a ray become one colour.
///
/// Source: Max, "Optical models for direct volume rendering", IEEE TVCG 1 (1995).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Blend {
    /// Absorption and emission, lit at boundaries; segments are solid.
    #[default]
    Shaded,
    /// The same in the tissue's own colours.
    Composite,
    /// 1 − exp(−∫ extinction): bright where much is absorbed, as a radiograph.
    Absorption,
    /// ∫ extinction · colour.
    Emission,
    /// The largest value of a ray, in grey.
    Mip,
    /// The smallest from the first to the last tissue of a ray, in grey.
    MinIp,
    /// The mean from the first to the last tissue of a ray, in grey.
    Average,
    /// The first place where a value is reached.
    Iso,
}

impl Blend {
    /// Whether the transfer function tells how tissue looks.
    #[must_use]
    pub fn uses_transfer_function(self) -> bool {
        matches!(
            self,
            Self::Shaded | Self::Composite | Self::Absorption | Self::Emission
        )
    }

    /// Whether solid segments stand in the picture; elsewhere their voxels are values like all others.
    #[must_use]
    pub fn draws_solids(self) -> bool {
        matches!(self, Self::Shaded | Self::Composite | Self::Iso)
    }

    /// Whether what is drawn is lit, and so casts shadows.
    #[must_use]
    pub fn is_lit(self) -> bool {
        matches!(self, Self::Shaded | Self::Iso)
    }
}

/// A point of a transfer function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlPoint {
    /// Value of the scan.
    pub value: f64,
    /// Linear RGB.
    pub colour: Vec3,
    /// Extinction [1/mm].
    pub extinction: f32,
}

/// Factors on the light of the picture; with 1 it is as `lighting.rs` has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lighting {
    /// On ambient light.
    pub ambient: f32,
    /// On diffuse light.
    pub diffuse: f32,
    /// On specular light.
    pub specular: f32,
    /// On the exponent of highlights.
    pub shininess: f32,
    /// Fraction of its extinction that homogeneous tissue loses, 0 to 1 (Levoy, IEEE CG&A 8, 1988).
    pub edges: f32,
    /// How much of ambient occlusion is seen, 0 to 1.
    pub occlusion: f32,
    /// How much of shadows is seen, 0 to 1.
    pub shadow: f32,
}

impl Default for Lighting {
    fn default() -> Self {
        Self {
            ambient: 1.0,
            diffuse: 1.0,
            specular: 1.0,
            shininess: 1.0,
            edges: 0.94,
            occlusion: 0.8,
            shadow: 0.6,
        }
    }
}

/// How the voxels of a segment look.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// A body in its colour.
    Solid,
    /// Tissue in its colour.
    Tinted,
    /// Left out of the picture.
    Hidden,
}

/// A segment that does not look as the scan does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShownSegment {
    /// Its number.
    pub id: u8,
    /// Limits of the threshold that made it, both included: it is where interpolated values lie between
    /// them. None where its voxels alone tell.
    pub range: Option<(f64, f64)>,
    /// It was edited after: its voxels decide too, beside those that are not what their value says.
    pub is_edited: bool,
    /// How its voxels look.
    pub shown: Shown,
    /// Linear RGB.
    pub colour: Vec3,
    /// Factor on ambient light.
    pub ambient: f32,
    /// Factor on specular light.
    pub specular: f32,
}

/// A segment whose surface is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShownSurface {
    /// The segment's number.
    pub id: u8,
    /// Linear RGB.
    pub colour: Vec3,
    /// Above 0; with 1 nothing is seen behind it.
    pub opacity: f32,
    /// Only the sides of its triangles are drawn.
    pub is_wireframe: bool,
    /// Factor on ambient light.
    pub ambient: f32,
    /// Factor on specular light.
    pub specular: f32,
}

/// Everything but the camera that decides how a scan is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Appearance {
    /// The optical model.
    pub blend: Blend,
    /// Factor on all extinction.
    pub density: f32,
    /// Transfer function: at least two points by rising value; outside it stays as at its ends.
    pub transfer: Vec<ControlPoint>,
    /// Gradient from which on a tissue boundary has its full strength [value per mm].
    pub edge_gradient: f64,
    /// Width and middle of the window in modes of grey.
    pub window: (f64, f64),
    /// Value of the iso-surface.
    pub iso_value: f64,
    /// Colour of the iso-surface.
    pub iso_colour: Vec3,
    /// From this value on there is tissue; MinIP and average count from the first to the last on a ray.
    pub tissue_from: f64,
    /// Thickness of what is looked at around the middle of the view [mm]; none: everything.
    pub slab: Option<f64>,
    /// Light.
    pub lighting: Lighting,
    /// Segments, in the order in which they win where several claim a value.
    pub segments: Vec<ShownSegment>,
    /// Segments whose surfaces are drawn, of those that the scene has.
    pub surfaces: Vec<ShownSurface>,
    /// What is cut away.
    pub clip: Vec<Plane>,
}
