//! From the device's frame to the scene and back.
//!
//! `point_in_scene = rotation · (scale · point_in_device) + offset`: the movement frame of the
//! thesis (4.7), whose axes follow the view. Turning the view and bringing the probe elsewhere
//! change the offset only as far as the device's present position asks for, like a clutch, so
//! both work for devices that stay where the hand holds them.
//!
//! Frames: device (x right, y up, z toward the person) and scene (LPS), both mm.

use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

/// Why an axis pair is no view.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ViewError {
    /// An axis has no direction.
    #[error("view axes: {name} is {given}; allowed: finite and not zero")]
    NoDirection {
        /// Which axis.
        name: &'static str,
        /// The axis given.
        given: DVec3,
    },
    /// Both axes point the same way.
    #[error("view axes: right {right} and up {up} are parallel; allowed: two directions")]
    Parallel {
        /// The right axis given.
        right: DVec3,
        /// The up axis given.
        up: DVec3,
    },
}

/// `scene_from_device`: a rotation, a scale and an offset.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mapping {
    /// Columns: the device's right, up and toward-the-person axes in the scene.
    pub rotation: DMat3,
    /// Scene mm per device mm, > 0.
    pub scale: f64,
    /// The device's origin in the scene [mm].
    pub offset: DVec3,
}

impl Mapping {
    /// Device and scene are the same frame.
    pub const IDENTITY: Self = Self {
        rotation: DMat3::IDENTITY,
        scale: 1.0,
        offset: DVec3::ZERO,
    };

    /// A point of the device [mm] in the scene [mm].
    #[must_use]
    pub fn point_to_scene(&self, point_in_device: DVec3) -> DVec3 {
        self.rotation * (point_in_device * self.scale) + self.offset
    }

    /// A velocity of the device [mm/s] in the scene [mm/s].
    #[must_use]
    pub fn velocity_to_scene(&self, velocity_in_device: DVec3) -> DVec3 {
        self.rotation * (velocity_in_device * self.scale)
    }

    /// A point of the scene [mm] in the device's frame [mm].
    #[must_use]
    pub fn point_to_device(&self, point_in_scene: DVec3) -> DVec3 {
        self.rotation.transpose() * (point_in_scene - self.offset) / self.scale
    }

    /// A force in scene axes [N] in the device's axes: turned, never scaled.
    #[must_use]
    pub fn force_to_device(&self, force_in_scene: DVec3) -> DVec3 {
        self.rotation.transpose() * force_in_scene
    }

    /// A force in the device's axes [N] in scene axes.
    #[must_use]
    pub fn force_to_scene(&self, force_in_device: DVec3) -> DVec3 {
        self.rotation * force_in_device
    }

    /// Moves the offset so that the device, where it is, stands at `point_in_scene`.
    pub fn place(&mut self, point_in_device: DVec3, point_in_scene: DVec3) {
        self.offset = point_in_scene - self.rotation * (point_in_device * self.scale);
    }

    /// Changes the scale about the device, which stays where it stands in the scene.
    pub fn rescale(&mut self, point_in_device: DVec3, scale: f64) {
        if self.scale != scale {
            let stays = self.point_to_scene(point_in_device);
            self.scale = scale;
            self.place(point_in_device, stays);
        }
    }

    /// Turns the axes about the device, which stays where it stands in the scene.
    pub fn turn(&mut self, point_in_device: DVec3, rotation: DMat3) {
        let stays = self.point_to_scene(point_in_device);
        self.rotation = rotation;
        self.place(point_in_device, stays);
    }
}

/// The rotation of a view from its right and up axes in the scene, of any length and not
/// necessarily at right angles: `right` is kept, `up` is straightened.
///
/// # Errors
/// [`ViewError`] where the axes do not span a plane.
pub fn rotation_of_view(right: DVec3, up: DVec3) -> Result<DMat3, ViewError> {
    let x = direction(right).ok_or(ViewError::NoDirection {
        name: "right",
        given: right,
    })?;
    let rough_up = direction(up).ok_or(ViewError::NoDirection {
        name: "up",
        given: up,
    })?;
    // under a tenth of a degree the third axis would be rounding only
    let across = x.cross(rough_up);
    if across.length() < 1e-3 {
        return Err(ViewError::Parallel { right, up });
    }
    let z = across.normalize();
    Ok(DMat3::from_cols(x, z.cross(x), z))
}

fn direction(axis: DVec3) -> Option<DVec3> {
    if !axis.is_finite() {
        return None;
    }
    // by the largest component first, so that no square over- or underflows
    (axis / axis.abs().max_element()).try_normalize()
}

/// The view from the front, where a person stands who looks at a patient: right on the screen
/// is the patient's left (+x), up is the head (+z), toward the person is anterior (−y).
#[must_use]
pub fn view_from_the_front() -> DMat3 {
    DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn oblique() -> Mapping {
        Mapping {
            rotation: rotation_of_view(DVec3::new(1.0, 2.0, 0.5), DVec3::new(0.0, 0.3, 2.0))
                .unwrap(),
            scale: 2.5,
            offset: DVec3::new(-30.0, 7.0, 412.0),
        }
    }

    // rounding of coordinates of some hundred mm
    const ROUNDING: f64 = 1e-12 * 1000.0;

    #[test]
    fn a_point_goes_to_the_scene_and_back() {
        let point = DVec3::new(3.0, -4.0, 55.0);
        let back = oblique().point_to_device(oblique().point_to_scene(point));
        assert!(back.distance(point) < ROUNDING);
    }

    #[test]
    fn a_view_is_a_rotation_that_keeps_right() {
        let rotation = oblique().rotation;
        assert!((rotation.determinant() - 1.0).abs() < ROUNDING);
        let right = DVec3::new(1.0, 2.0, 0.5).normalize();
        assert!(rotation.x_axis.distance(right) < ROUNDING);
        assert_eq!(
            rotation_of_view(DVec3::X, DVec3::Z).unwrap(),
            view_from_the_front()
        );
    }

    #[test]
    fn placing_and_turning_leave_the_device_where_it_is_wanted() {
        let mut mapping = oblique();
        let device = DVec3::new(8.0, -2.0, 1.0);
        let point = DVec3::new(100.0, 50.0, -20.0);
        mapping.place(device, point);
        assert!(mapping.point_to_scene(device).distance(point) < ROUNDING);
        mapping.turn(device, view_from_the_front());
        assert!(mapping.point_to_scene(device).distance(point) < ROUNDING);
        // and a push to the left now moves the probe to the patient's right
        let left = mapping.point_to_scene(device + DVec3::NEG_X) - point;
        assert!(left.distance(DVec3::NEG_X * 2.5) < ROUNDING);
    }

    #[test]
    fn another_scale_leaves_the_device_where_it_is_and_stretches_its_way() {
        let mut mapping = oblique();
        let device = DVec3::new(8.0, -2.0, 1.0);
        let stays = mapping.point_to_scene(device);
        mapping.rescale(device, 0.5);
        assert!(mapping.point_to_scene(device).distance(stays) < ROUNDING);
        let way = mapping.point_to_scene(device + DVec3::X * 3.0) - stays;
        assert!((way.length() - 1.5).abs() < ROUNDING);
    }

    #[test]
    fn axes_that_span_no_plane_are_refused() {
        for (right, up) in [
            (DVec3::ZERO, DVec3::Y),
            (DVec3::X, DVec3::NAN),
            (DVec3::X, DVec3::INFINITY),
            (DVec3::X, DVec3::NEG_X),
        ] {
            assert!(rotation_of_view(right, up).is_err(), "{right} {up}");
        }
        // tiny and huge axes are directions all the same
        assert!(rotation_of_view(DVec3::X * 1e-300, DVec3::Y * 1e300).is_ok());
    }
}
