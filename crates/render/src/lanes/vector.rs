//! Vectors of three numbers in lanes.

use std::ops::{Add, Sub};

use glam::Vec3;

use super::{Floats, Lanes, Masks};

/// Eight vectors.
#[derive(Clone, Copy)]
pub(crate) struct Vector<L: Lanes> {
    pub x: L::Float,
    pub y: L::Float,
    pub z: L::Float,
}

impl<L: Lanes> Vector<L> {
    #[inline(always)]
    pub fn new(x: L::Float, y: L::Float, z: L::Float) -> Self {
        Self { x, y, z }
    }

    #[inline(always)]
    pub fn splat(vector: Vec3) -> Self {
        Self::new(
            Floats::splat(vector.x),
            Floats::splat(vector.y),
            Floats::splat(vector.z),
        )
    }

    #[inline(always)]
    pub fn scaled(self, factor: L::Float) -> Self {
        Self::new(self.x * factor, self.y * factor, self.z * factor)
    }

    /// Axis by axis.
    #[inline(always)]
    pub fn times(self, other: Self) -> Self {
        Self::new(self.x * other.x, self.y * other.y, self.z * other.z)
    }

    /// `self + direction * length`.
    #[inline(always)]
    pub fn along(self, direction: Self, length: L::Float) -> Self {
        self + direction.scaled(length)
    }

    #[inline(always)]
    pub fn dot(self, other: Self) -> L::Float {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }

    #[inline(always)]
    pub fn length(self) -> L::Float {
        self.dot(self).sqrt()
    }

    #[inline(always)]
    pub fn normalized(self) -> Self {
        self.scaled(L::Float::splat(1.0).div(self.length().max(Floats::splat(1e-30))))
    }

    #[inline(always)]
    pub fn or_else(self, mask: L::Mask, other: Self) -> Self {
        Self::new(
            self.x.or_else(mask, other.x),
            self.y.or_else(mask, other.y),
            self.z.or_else(mask, other.z),
        )
    }

    /// The unit vector, turned to the viewer; `to_eye` itself where there is no direction.
    #[inline(always)]
    pub fn facing(self, to_eye: Self) -> Self {
        let size = self.length();
        let known = L::Float::splat(1e-9).less(size);
        let unit = self
            .scaled(L::Float::splat(1.0).div(size))
            .or_else(known, to_eye);
        let away = unit.dot(to_eye).less(Floats::splat(0.0));
        let turned = unit.scaled(Floats::splat(-1.0));
        if away.any() {
            turned.or_else(away, unit)
        } else {
            unit
        }
    }
}

impl<L: Lanes> Add for Vector<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<L: Lanes> Sub for Vector<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}
