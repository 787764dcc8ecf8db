//! Where the voxels of a scan stand in the patient.
//!
//! Frames: `grid` is in voxels, voxel (i, j, k) covers [i, i+1) on each axis, so that it
//! equals ITK's continuous index + 0.5; `patient` is LPS mm. The direction is rigid (ITK
//! images cannot shear), so a length in mm is `((a - b) * spacing).length()`.
//! Memory: x fastest, then y, then z.

use glam::{DAffine3, DMat3, DVec3, IVec3, UVec3};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::voxel_box::VoxelBox;

/// Largest number of voxels along one axis; the voxels of a plane then fit in 32 bits.
pub const MAX_DIMENSION: u32 = 65_535;

/// Largest number of voxels; brick numbers then fit in 31 bits.
pub const MAX_VOXELS: u64 = 1 << 40;

/// Spacings that make sense in a scan [mm], from electron microscopy to the whole body.
const SPACING_LIMITS: [f64; 2] = [1e-6, 1e6];

/// Farthest origin [mm]; at 1e9 mm a double still resolves 1e-7 mm.
const ORIGIN_LIMIT: f64 = 1e9;

/// How far a direction may be from orthonormal: DICOM cosines come rounded to 4 digits.
const DIRECTION_TOLERANCE: f64 = 1e-3;

/// A scan's geometry that cannot be used.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum GridError {
    /// The grid has no voxels, or too many.
    #[error(
        "dimensions {0} given; allowed: 1 to {MAX_DIMENSION} along each axis, {MAX_VOXELS} voxels in all"
    )]
    Dimensions(UVec3),
    /// Not a length.
    #[error("spacing {0} mm given; allowed: {min} to {max} mm", min = SPACING_LIMITS[0], max = SPACING_LIMITS[1])]
    Spacing(DVec3),
    /// Not finite, or absurdly far away.
    #[error("origin {0} mm given; allowed: finite, at most {ORIGIN_LIMIT} mm from zero")]
    Origin(DVec3),
    /// Sheared, scaled or not finite.
    #[error(
        "direction {0} given; allowed: orthonormal columns within {DIRECTION_TOLERANCE} (a sheared scan must be resampled first)"
    )]
    Direction(DMat3),
}

/// Dimensions of a scan and its place in the patient.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "WrittenGrid", into = "WrittenGrid")]
pub struct Grid {
    dimensions: UVec3,
    spacing: DVec3,
    patient_from_grid: DAffine3,
    grid_from_patient: DAffine3,
    /// Axes of the grid in the patient, of length 1.
    direction: DMat3,
}

/// A grid as files hold it, to the bit; nobody has checked it yet when it is read.
#[derive(Serialize, Deserialize)]
struct WrittenGrid {
    dimensions: UVec3,
    spacing: DVec3,
    patient_from_grid: DAffine3,
}

impl From<Grid> for WrittenGrid {
    fn from(grid: Grid) -> Self {
        Self {
            dimensions: grid.dimensions,
            spacing: grid.spacing,
            patient_from_grid: grid.patient_from_grid,
        }
    }
}

impl TryFrom<WrittenGrid> for Grid {
    type Error = GridError;

    fn try_from(written: WrittenGrid) -> Result<Self, GridError> {
        Self::from_affine(
            written.dimensions,
            written.spacing,
            written.patient_from_grid,
        )
    }
}

impl Grid {
    /// Makes a grid from the terms of ITK.
    ///
    /// `spacing` [mm]; `origin`: the *centre* of voxel 0, LPS mm; `direction`: its columns
    /// are the grid's axes in LPS, a rotation or a reflection.
    ///
    /// # Errors
    /// Where one of them describes no scan; see [`GridError`].
    pub fn new(
        dimensions: UVec3,
        spacing: DVec3,
        origin: DVec3,
        direction: DMat3,
    ) -> Result<Self, GridError> {
        check_dimensions(dimensions)?;
        check_spacing(spacing)?;
        check_origin(origin)?;
        check_direction(direction)?;

        // the centre of voxel 0 is the point (0.5, 0.5, 0.5) of the grid frame
        let axes = direction * DMat3::from_diagonal(spacing);
        let patient_from_grid =
            DAffine3::from_mat3_translation(axes, origin - axes * DVec3::splat(0.5));
        Ok(Self::placed(dimensions, spacing, patient_from_grid))
    }

    /// Makes the grid that these numbers are of, to the bit.
    ///
    /// # Errors
    /// Where they describe no scan; see [`GridError`].
    pub fn from_affine(
        dimensions: UVec3,
        spacing: DVec3,
        patient_from_grid: DAffine3,
    ) -> Result<Self, GridError> {
        check_spacing(spacing)?;
        let first = patient_from_grid.transform_point3(DVec3::splat(0.5));
        let direction = patient_from_grid.matrix3 * DMat3::from_diagonal(spacing.recip());
        Self::new(dimensions, spacing, first, direction)?;
        Ok(Self::placed(dimensions, spacing, patient_from_grid))
    }

    fn placed(dimensions: UVec3, spacing: DVec3, patient_from_grid: DAffine3) -> Self {
        Self {
            dimensions,
            spacing,
            patient_from_grid,
            grid_from_patient: patient_from_grid.inverse(),
            direction: patient_from_grid.matrix3 * DMat3::from_diagonal(spacing.recip()),
        }
    }

    /// Voxels along x, y and z.
    pub fn dimensions(&self) -> UVec3 {
        self.dimensions
    }

    /// Size of a voxel along each axis of the grid [mm].
    pub fn spacing(&self) -> DVec3 {
        self.spacing
    }

    /// The length h that pages call "a voxel" [mm].
    pub fn smallest_spacing(&self) -> f64 {
        self.spacing.min_element()
    }

    /// Number of voxels.
    pub fn voxel_count(&self) -> usize {
        voxel_count(self.dimensions)
    }

    /// Volume of one voxel [mm³].
    pub fn voxel_volume(&self) -> f64 {
        self.spacing.element_product()
    }

    /// Takes grid points to LPS mm.
    pub fn patient_from_grid(&self) -> DAffine3 {
        self.patient_from_grid
    }

    /// Takes LPS mm to grid points.
    pub fn grid_from_patient(&self) -> DAffine3 {
        self.grid_from_patient
    }

    /// Takes vectors in mm along the axes of the grid to those of the patient, LPS.
    pub fn direction(&self) -> DMat3 {
        self.direction
    }

    /// The box of all voxels.
    pub fn bounds(&self) -> VoxelBox {
        VoxelBox::of_dimensions(self.dimensions)
    }

    /// Whether the grid has this voxel.
    pub fn contains(&self, voxel: IVec3) -> bool {
        is_inside(self.dimensions, voxel)
    }

    /// Place of a voxel of this grid in memory, x fastest.
    pub fn index(&self, voxel: IVec3) -> usize {
        voxel_index(self.dimensions, voxel)
    }

    /// The voxel that holds a point of the grid frame; none outside the grid or where the
    /// point is not finite.
    pub fn voxel_at(&self, point_in_grid: DVec3) -> Option<IVec3> {
        let inside = point_in_grid.cmpge(DVec3::ZERO).all()
            && point_in_grid.cmplt(self.dimensions.as_dvec3()).all();
        inside.then(|| point_in_grid.as_ivec3())
    }
}

/// Number of voxels of a grid.
pub(crate) fn voxel_count(dimensions: UVec3) -> usize {
    dimensions.x as usize * dimensions.y as usize * dimensions.z as usize
}

/// Place of a voxel in memory, x fastest; the voxel must be inside.
#[inline]
pub fn voxel_index(dimensions: UVec3, voxel: IVec3) -> usize {
    let [nx, ny] = [dimensions.x as usize, dimensions.y as usize];
    (voxel.z as usize * ny + voxel.y as usize) * nx + voxel.x as usize
}

/// Whether a voxel is one of a grid; negative numbers become large ones.
#[inline]
pub(crate) fn is_inside(dimensions: UVec3, voxel: IVec3) -> bool {
    let voxel = voxel.as_uvec3();
    (voxel.x < dimensions.x) & (voxel.y < dimensions.y) & (voxel.z < dimensions.z)
}

/// Refuses a grid without voxels or with too many.
pub(crate) fn check_dimensions(dimensions: UVec3) -> Result<(), GridError> {
    let voxels = dimensions
        .to_array()
        .iter()
        .map(|&n| u128::from(n))
        .product::<u128>();
    let allowed =
        dimensions.max_element() <= MAX_DIMENSION && (1..=u128::from(MAX_VOXELS)).contains(&voxels);
    allowed
        .then_some(())
        .ok_or(GridError::Dimensions(dimensions))
}

fn check_spacing(spacing: DVec3) -> Result<(), GridError> {
    let [low, high] = SPACING_LIMITS;
    // written so that NaN is refused
    let allowed = spacing.cmpge(DVec3::splat(low)).all() && spacing.cmple(DVec3::splat(high)).all();
    allowed.then_some(()).ok_or(GridError::Spacing(spacing))
}

fn check_origin(origin: DVec3) -> Result<(), GridError> {
    let allowed = origin.abs().cmple(DVec3::splat(ORIGIN_LIMIT)).all();
    allowed.then_some(()).ok_or(GridError::Origin(origin))
}

fn check_direction(direction: DMat3) -> Result<(), GridError> {
    let product = direction.transpose() * direction;
    let allowed =
        direction.is_finite() && product.abs_diff_eq(DMat3::IDENTITY, DIRECTION_TOLERANCE);
    allowed.then_some(()).ok_or(GridError::Direction(direction))
}
