//! Which cells a ball reaches around a voxel: the structuring element of the dilation.
//!
//! The ball's centre moves over cells, which are the voxels of the same grid. A voxel blocks a
//! cell where the ball could overlap it from somewhere in the cell: where box and box are nearer
//! than the radius. That errs to the safe side, by less than a cell.
//!
//! Frame: grid; distances in mm, so that the shapes are balls on thick slices too. Memory: a
//! shape is convex and symmetric, so rows along x are told by one half-width each.
//! Source: Serra, "Image Analysis and Mathematical Morphology" (1982), ch. II.

use glam::{DVec3, IVec3};
use palpate_volume::voxel_box::VoxelBox;

/// Farthest that a shape reaches along each axis [voxels].
pub const MAX_REACH: i32 = 16;

const STEPS: usize = MAX_REACH as usize + 1;

/// Balls that touch a voxel to within this share of the radius touch it exactly; rounding is
/// some 1e-16 of it.
const ROUNDING: f64 = 1e-12;

/// Why there is no ball of this radius.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum BallError {
    /// Not a length.
    #[error("the radius of the ball is {radius_mm} mm; allowed: 0 or more, and finite")]
    NotARadius {
        /// What was given [mm].
        radius_mm: f64,
    },
    /// Not the size of a voxel.
    #[error("the voxels are {spacing} mm; allowed: more than 0 along each axis, and finite")]
    NotASpacing {
        /// What was given [mm].
        spacing: DVec3,
    },
    /// Larger than the window around the probe.
    #[error(
        "a ball of radius {radius_mm} mm reaches over {voxels} voxels of {spacing} mm; \
         allowed: {MAX_REACH} voxels along each axis, so at most {allowed_mm} mm here"
    )]
    TooLarge {
        /// What was given [mm].
        radius_mm: f64,
        /// The grid's voxels [mm].
        spacing: DVec3,
        /// What the ball needs along each axis [voxels].
        voxels: DVec3,
        /// The largest radius for this spacing [mm].
        allowed_mm: f64,
    },
}

/// A ball as the offsets from a voxel to the cells that it blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallShape {
    radius_mm: f64,
    spacing: DVec3,
    reach: IVec3,
    /// Farthest offset along y, by half-width along x and offset along z; -1 for none.
    heights: [[i8; STEPS]; STEPS + 1],
}

impl BallShape {
    /// Wherever in a free cell the centre is, the ball overlaps no solid voxel.
    /// Touching is allowed; a radius of 0 is the point, which blocks the voxel itself.
    ///
    /// `spacing` is the size of a voxel [mm].
    pub fn new(radius_mm: f64, spacing: DVec3) -> Result<Self, BallError> {
        if !(radius_mm.is_finite() && radius_mm >= 0.0) {
            return Err(BallError::NotARadius { radius_mm });
        }
        if !(spacing.is_finite() && spacing.cmpgt(DVec3::ZERO).all()) {
            return Err(BallError::NotASpacing { spacing });
        }
        let allowed_mm = Self::largest_radius(spacing);
        if radius_mm > allowed_mm * (1.0 + ROUNDING) {
            return Err(BallError::TooLarge {
                radius_mm,
                spacing,
                voxels: (radius_mm / spacing).ceil(),
                allowed_mm,
            });
        }
        Ok(Self::of_blocked(radius_mm, spacing, |offset| {
            blocks(radius_mm, spacing, offset)
        }))
    }

    /// The largest radius on voxels of this size [mm].
    pub fn largest_radius(spacing: DVec3) -> f64 {
        f64::from(MAX_REACH) * spacing.min_element()
    }

    /// The shape of all offsets for which `blocked` holds; it is asked for none that is negative.
    fn of_blocked(radius_mm: f64, spacing: DVec3, blocked: impl Fn(IVec3) -> bool) -> Self {
        // blocked offsets stand without gaps around 0 on each line along an axis
        let last = |at: &dyn Fn(i32) -> IVec3| {
            (0..=MAX_REACH).take_while(|&i| blocked(at(i))).count() as i32 - 1
        };
        let mut heights = [[-1; STEPS]; STEPS + 1];
        for (x, heights) in heights.iter_mut().enumerate().take(STEPS) {
            for (z, height) in heights.iter_mut().enumerate() {
                *height = last(&|y| IVec3::new(x as i32, y, z as i32)) as i8;
            }
        }
        Self {
            radius_mm,
            spacing,
            reach: IVec3::new(
                last(&|x| IVec3::new(x, 0, 0)),
                last(&|y| IVec3::new(0, y, 0)),
                last(&|z| IVec3::new(0, 0, z)),
            ),
            heights,
        }
    }

    /// The next radius [mm] on the way to another one: at most one smallest spacing larger, so
    /// that the ball reaches one cell further and admission has to push the probe but little;
    /// smaller ones at once.
    pub fn toward(&self, radius_mm: f64) -> f64 {
        radius_mm.min(self.radius_mm + self.spacing.min_element())
    }

    /// Radius [mm].
    pub fn radius_mm(&self) -> f64 {
        self.radius_mm
    }

    /// Voxels of the grid that it was made for [mm].
    pub fn spacing(&self) -> DVec3 {
        self.spacing
    }

    /// Farthest offset along each axis [voxels].
    pub fn reach(&self) -> IVec3 {
        self.reach
    }

    /// All cells that voxels of this box can block.
    pub fn grown(&self, voxels: &VoxelBox) -> VoxelBox {
        if voxels.is_empty() {
            return VoxelBox::EMPTY;
        }
        VoxelBox::new(
            voxels.min.saturating_sub(self.reach),
            voxels.max.saturating_add(self.reach),
        )
    }

    /// Whether a voxel blocks the cell that is this far from it.
    pub fn blocks(&self, offset: IVec3) -> bool {
        let [x, y, z] = offset.to_array().map(i32::unsigned_abs);
        i64::from(y) <= i64::from(self.height(x as usize, z as usize))
    }

    /// Farthest offset along y of rows that reach at least `x` along x, `z` along z; -1 where
    /// there is no such row.
    #[inline]
    pub(crate) fn height(&self, x: usize, z: usize) -> i32 {
        let height = self.heights.get(x).and_then(|heights| heights.get(z));
        height.map_or(-1, |&height| height.into())
    }
}

/// The rule itself.
fn blocks(radius_mm: f64, spacing: DVec3, offset: IVec3) -> bool {
    let between = (offset.abs() - 1).max(IVec3::ZERO).as_dvec3() * spacing;
    offset == IVec3::ZERO || between.length() < radius_mm * (1.0 - ROUNDING)
}
