//! Where a picture is seen from: in the patient, LPS mm; and its rays along the axes of the scan's grid.

use glam::{DVec3, Vec3};
use palpate_volume::grid::Grid;

/// A point that is looked at, how far it is, and the axes of the view. Frame: patient, LPS mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Point in the middle of the picture.
    pub target: DVec3,
    /// From the eye to the target [mm].
    pub distance: f64,
    /// Unit axis of the view to the right.
    pub right: DVec3,
    /// Unit axis of the view upward.
    pub up: DVec3,
    /// Unit axis of the view back toward the person.
    pub back: DVec3,
    /// Vertical angle of view [rad].
    pub field: f64,
    /// Orthographic: how far before the target rays begin, side by side [mm]; the picture is as high as
    /// one in perspective is at the target. None: in perspective.
    pub parallel: Option<f64>,
    /// One of two eyes: so far to the right [fraction of the distance], looking straight ahead through
    /// the same window at the target (Bourke, "Calculating stereo pairs", 1999).
    pub aside: f64,
}

impl Camera {
    /// From the target toward the eye, for each mm of depth.
    fn sight(&self) -> DVec3 {
        self.back + self.aside * self.right
    }

    /// Where all rays begin; in an orthographic view the one in the picture's middle.
    #[must_use]
    pub fn eye(&self) -> DVec3 {
        self.target + self.parallel.unwrap_or(self.distance) * self.sight()
    }

    /// Toward the lamp, over the viewer's left shoulder; a unit vector.
    #[must_use]
    pub fn lamp(&self) -> DVec3 {
        (-0.45 * self.right + 0.65 * self.up + 0.75 * self.back).normalize()
    }
}

/// The rays of a picture. Positions in the grid, directions along its axes in mm.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RayFan {
    /// Pixels across and down.
    pub size: (u32, u32),
    pub eye: Vec3,
    pub forward: Vec3,
    /// Half the picture, at 1 mm of depth in perspective, anywhere in an orthographic view.
    pub across: Vec3,
    pub upward: Vec3,
    pub is_parallel: bool,
    pub spacing: Vec3,
    /// Unit vectors toward the lamp and upward in the picture.
    pub lamp: Vec3,
    pub up: Vec3,
    /// From the eye to the middle of the view [mm].
    pub middle: f32,
}

impl RayFan {
    pub fn new(camera: &Camera, grid: &Grid, size: (u32, u32)) -> Self {
        let turned = grid.direction().transpose();
        let along = |vector: DVec3| (turned * vector).as_vec3();
        let depth = camera.parallel.map_or(1.0, |_| camera.distance);
        let half = (camera.field / 2.0).tan() * depth;
        let aspect = f64::from(size.0) / f64::from(size.1);
        Self {
            size,
            eye: grid
                .grid_from_patient()
                .transform_point3(camera.eye())
                .as_vec3(),
            forward: along(-camera.sight()),
            across: along(half * aspect * camera.right),
            upward: along(half * camera.up),
            is_parallel: camera.parallel.is_some(),
            spacing: grid.spacing().as_vec3(),
            lamp: along(camera.lamp()),
            up: along(camera.up),
            middle: camera.parallel.unwrap_or(camera.distance) as f32,
        }
    }
}
