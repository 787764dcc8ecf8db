//! Displacements as the picture draws them: where tissue stands beside the voxels that show it.
//!
//! The picture pulls the scan back through them and moves the vertices of surfaces by them.
//! Frame: grid of the scan; displacements in mm along its axes.

use glam::{DVec3, UVec3, Vec3};
use palpate_deform::model::DisplacementField;
use palpate_volume::grid::Grid;

/// How a field is followed by the picture.
#[derive(Clone, Copy, Debug)]
pub struct Following {
    /// No node is shown farther from where it is at rest [mm].
    pub farthest: f64,
    /// What moves by less is shown where it was [smallest side of a voxel].
    pub least: f32,
}

/// A hundredth of a voxel: what moves by less is not seen.
pub const UNSEEN: f32 = 0.01;

/// Displacements at the nodes of a box.
///
/// Memory: x fastest; node (i, j, k) stands at `origin + step · (i, j, k)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Displacements {
    /// First node [grid].
    pub origin: DVec3,
    /// Between nodes [voxels].
    pub step: DVec3,
    /// Nodes along each axis.
    pub size: UVec3,
    /// How far tissue stands from the voxels that show it [mm].
    pub moved: Vec<Vec3>,
    /// What moves by less is shown where it was [mm].
    pub least: f32,
}

impl Displacements {
    /// What the picture draws of a field; none where nothing has moved enough to be seen.
    #[must_use]
    pub fn of(field: &DisplacementField, grid: &Grid, following: Following) -> Option<Self> {
        let axes_from_patient = grid.direction().transpose().as_mat3();
        let along_axes = |moved: &Vec3| {
            let moved = axes_from_patient * *moved;
            if moved.is_finite() {
                moved.clamp_length_max(following.farthest as f32)
            } else {
                Vec3::ZERO
            }
        };
        let moved: Vec<Vec3> = field.moved.iter().map(along_axes).collect();
        let least = following.least * grid.smallest_spacing() as f32;
        let is_seen = moved
            .iter()
            .any(|moved| moved.length_squared() > least * least);
        is_seen.then(|| Self {
            origin: grid.grid_from_patient().transform_point3(field.origin),
            step: DVec3::splat(field.spacing) / grid.spacing(),
            size: field.size,
            moved,
            least,
        })
    }

    /// Whether the picture is to be drawn again: something has moved enough to be seen.
    #[must_use]
    pub fn differs(&self, before: &Self) -> bool {
        let least = self.least;
        let is_other = |(now, then): (&Vec3, &Vec3)| now.distance_squared(*then) > least * least;
        (self.origin, self.step, self.size) != (before.origin, before.step, before.size)
            || self.moved.iter().zip(&before.moved).any(is_other)
    }

    /// Little-endian half floats x, y, z, 0 for each node: as the picture's texture holds them.
    #[must_use]
    pub fn packed(&self) -> Vec<u8> {
        let numbers = self
            .moved
            .iter()
            .flat_map(|moved| [moved.x, moved.y, moved.z, 0.0]);
        numbers
            .flat_map(|number| half(number).to_le_bytes())
            .collect()
    }
}

/// A number as a half float (IEEE 754 binary16), to the nearest; what is smaller than 6e-5
/// becomes zero, what is larger than 65504 that.
fn half(number: f32) -> u16 {
    let bits = number.to_bits();
    let sign = (bits >> 16) as u16 & 0x8000;
    let size = bits & 0x7fff_ffff;
    let least = 0x3880_0000;
    if size < least {
        return sign;
    }
    let to_even = 0x0fff + (size >> 13 & 1);
    // the exponent counts from 15 instead of 127
    let rounded = (size + to_even - (112 << 23)) >> 13;
    sign | rounded.min(0x7bff) as u16
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat3;

    const SEEN: Following = Following {
        farthest: 4.0,
        least: UNSEEN,
    };

    /// Turned by a right angle: its x axis is the patient's y.
    fn grid() -> Grid {
        let turned = DMat3::from_cols(DVec3::Y, DVec3::NEG_X, DVec3::Z);
        let spacing = DVec3::new(1.0, 2.0, 4.0);
        Grid::new(UVec3::splat(40), spacing, DVec3::ZERO, turned).unwrap()
    }

    /// Two nodes, 2 mm apart; the first one moves.
    fn field(moved: Vec3) -> DisplacementField {
        DisplacementField {
            origin: grid()
                .patient_from_grid()
                .transform_point3(DVec3::splat(10.5)),
            axes: grid().direction(),
            spacing: 2.0,
            size: UVec3::new(2, 1, 1),
            moved: vec![moved, Vec3::ZERO],
        }
    }

    #[test]
    fn nodes_and_displacements_are_told_in_the_frame_of_the_grid() {
        let displacements =
            Displacements::of(&field(Vec3::new(0.0, 0.6, 0.3)), &grid(), SEEN).unwrap();
        assert!(displacements.origin.distance(DVec3::splat(10.5)) < 1e-12);
        assert_eq!(displacements.step, DVec3::new(2.0, 1.0, 0.5));
        assert_eq!(displacements.size, UVec3::new(2, 1, 1));
        assert_eq!(displacements.moved, [Vec3::new(0.6, 0.0, 0.3), Vec3::ZERO]);
    }

    #[test]
    fn what_has_not_moved_enough_is_not_told() {
        assert!(Displacements::of(&field(Vec3::X * 0.009), &grid(), SEEN).is_none());
        assert!(Displacements::of(&field(Vec3::NAN), &grid(), SEEN).is_none());
        let one = Displacements::of(&field(Vec3::X), &grid(), SEEN).unwrap();
        let mut other = one.clone();
        other.moved[1].x += 0.009;
        assert!(!other.differs(&one));
        other.moved[1].x += 0.009;
        assert!(other.differs(&one));
        other.moved[1] = one.moved[1];
        other.origin.x += 1.0;
        assert!(other.differs(&one));
    }

    #[test]
    fn half_floats_are_those_of_the_standard() {
        let cases = [
            (0.0, 0x0000),
            (1.0, 0x3c00),
            (-2.0, 0xc000),
            (65504.0, 0x7bff),
            (1e9, 0x7bff),
            (0.333_25, 0x3555),
            (1e-6, 0x0000),
            // half a step above 1: to the even one
            (1.000_488_3, 0x3c00),
            (1.000_489, 0x3c01),
        ];
        for (number, expected) in cases {
            assert_eq!(half(number), expected, "{number}");
        }
        let displacements = Displacements::of(&field(Vec3::NEG_Y), &grid(), SEEN).unwrap();
        // x of the first node, the patient's -y, is its first number
        assert_eq!(displacements.packed()[..2], 0xbc00_u16.to_le_bytes());
        assert_eq!(displacements.packed().len(), 16);
    }
}
