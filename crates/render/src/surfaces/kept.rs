//! Which depths of a pixel clip planes leave.

use glam::{Vec3, Vec4};

use crate::camera::RayFan;

/// The part of a ray behind all planes, which is in one piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kept {
    /// Depths [mm].
    pub from: f32,
    pub to: f32,
    /// Where it comes in through a plane: the place in the grid, and the plane's normal along the grid's axes.
    pub face: Option<(Vec3, Vec3)>,
}

/// Of the ray of a pixel; `planes` as [`crate::shading::Shading`] has them.
pub(super) fn kept_of(
    fan: &RayFan,
    planes: &[Vec4],
    (column, row): (u32, u32),
    shift: (f32, f32),
) -> Kept {
    let x = (column as f32 + 0.5 + shift.0) * 2.0 / fan.size.0 as f32 - 1.0;
    let y = 1.0 - (row as f32 + 0.5 + shift.1) * 2.0 / fan.size.1 as f32;
    let sideways = x * fan.across + y * fan.upward;
    let (begin, way) = if fan.is_parallel {
        (fan.eye + sideways / fan.spacing, fan.forward / fan.spacing)
    } else {
        (fan.eye, (fan.forward + sideways) / fan.spacing)
    };
    let mut kept = Kept {
        from: 0.0,
        to: f32::INFINITY,
        face: None,
    };
    for plane in planes {
        let before = begin.dot(plane.truncate()) + plane.w;
        let rise = way.dot(plane.truncate());
        if rise.abs() < 1e-7 {
            kept.to = if before > 0.0 { -1.0 } else { kept.to };
        } else if rise > 0.0 {
            kept.to = kept.to.min(-before / rise);
        } else if -before / rise > kept.from {
            kept.from = -before / rise;
            let normal = plane.truncate() / fan.spacing;
            kept.face = Some((begin + way * kept.from, normal.normalize()));
        }
    }
    kept
}
