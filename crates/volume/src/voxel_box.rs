//! Boxes of voxels, such as the voxels that an edit changed.
//!
//! Frame: grid; `min` belongs to the box, `max` no more.

use glam::{IVec3, UVec3};

/// A box of voxels; empty where `max <= min` along any axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VoxelBox {
    /// First voxel.
    pub min: IVec3,
    /// One beyond the last voxel along each axis.
    pub max: IVec3,
}

impl VoxelBox {
    /// The box without voxels.
    pub const EMPTY: Self = Self {
        min: IVec3::ZERO,
        max: IVec3::ZERO,
    };

    /// The voxels from `min` up to, but without, `max`.
    pub const fn new(min: IVec3, max: IVec3) -> Self {
        Self { min, max }
    }

    /// One voxel.
    pub fn of_voxel(voxel: IVec3) -> Self {
        Self::new(voxel, voxel.saturating_add(IVec3::ONE))
    }

    /// All voxels of a grid.
    pub fn of_dimensions(dimensions: UVec3) -> Self {
        Self::new(IVec3::ZERO, dimensions.as_ivec3())
    }

    /// Whether it holds no voxel.
    pub fn is_empty(&self) -> bool {
        self.min.cmpge(self.max).any()
    }

    /// Voxels along each axis.
    pub fn size(&self) -> UVec3 {
        if self.is_empty() {
            return UVec3::ZERO;
        }
        self.max.wrapping_sub(self.min).as_uvec3()
    }

    /// Number of voxels, at most `u64::MAX`.
    pub fn voxel_count(&self) -> u64 {
        let [x, y, z] = self.size().to_array().map(u64::from);
        (x * y).saturating_mul(z)
    }

    /// Whether it holds this voxel.
    pub fn contains(&self, voxel: IVec3) -> bool {
        voxel.cmpge(self.min).all() && voxel.cmplt(self.max).all()
    }

    /// Whether it holds all voxels of `other`.
    pub fn contains_box(&self, other: &Self) -> bool {
        other.is_empty() || (other.min.cmpge(self.min).all() && other.max.cmple(self.max).all())
    }

    /// The smallest box that holds both.
    pub fn union(&self, other: &Self) -> Self {
        match (self.is_empty(), other.is_empty()) {
            (true, true) => Self::EMPTY,
            (true, false) => *other,
            (false, true) => *self,
            (false, false) => Self::new(self.min.min(other.min), self.max.max(other.max)),
        }
    }

    /// The voxels that both hold.
    pub fn intersect(&self, other: &Self) -> Self {
        let both = Self::new(self.min.max(other.min), self.max.min(other.max));
        if both.is_empty() { Self::EMPTY } else { both }
    }

    /// Grown by `voxels` on every side; shrunk where negative.
    pub fn dilate(&self, voxels: i32) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let margin = IVec3::splat(voxels);
        let grown = Self::new(
            self.min.saturating_sub(margin),
            self.max.saturating_add(margin),
        );
        if grown.is_empty() { Self::EMPTY } else { grown }
    }

    /// Every voxel, x fastest.
    pub fn voxels(self) -> impl Iterator<Item = IVec3> {
        // an empty box may be long along its other axes
        let IVec3 {
            x: x0,
            y: y0,
            z: z0,
        } = self.min;
        let IVec3 {
            x: x1,
            y: y1,
            z: z1,
        } = if self.is_empty() { self.min } else { self.max };
        (z0..z1).flat_map(move |z| {
            (y0..y1).flat_map(move |y| (x0..x1).map(move |x| IVec3::new(x, y, z)))
        })
    }
}
