//! One shape of one tissue, and the painting of points by overlapping shapes.

use glam::Vec3;

use super::tissue::Tissue;
use super::{chest, hips, organs, skin, spine};

/// How much faster than the way walked a distance of a part may change. Measured over blocks
/// of many sizes: 1.9; a test compares with painting all parts.
const STEEPEST: f32 = 2.2;

/// Radius of a block [mm] up to which the distances from its middle tell what shows in it.
const FARTHEST: f32 = 12.0;

/// A shape by its signed distance [mm], negative inside.
pub(super) struct Part {
    tissue: Tissue,
    /// Lowest and highest corner of a box that holds the shape.
    bounds: (Vec3, Vec3),
    distance: Box<dyn Fn(Vec3) -> f32 + Sync + Send>,
}

impl Part {
    pub(super) fn new(
        tissue: Tissue,
        bounds: ([f32; 3], [f32; 3]),
        distance: impl Fn(Vec3) -> f32 + Sync + Send + 'static,
    ) -> Self {
        Self {
            tissue,
            bounds: (bounds.0.into(), bounds.1.into()),
            distance: Box::new(distance),
        }
    }

    fn meets(&self, low: Vec3, high: Vec3) -> bool {
        self.bounds.0.cmple(high).all() && self.bounds.1.cmpge(low).all()
    }
}

/// All shapes in painting order: a later one covers earlier ones.
pub(super) fn all_parts() -> Vec<Part> {
    let mut parts = skin::parts();
    parts.extend(organs::parts());
    parts.extend(chest::parts());
    parts.extend(spine::parts());
    parts.extend(hips::parts());
    parts
}

/// Lists the parts that show anywhere in a box, in painting order.
///
/// `blur` [mm]: how far from its surface a part still shows.
pub(super) fn list_visible<'a>(
    parts: &'a [Part],
    [low, high]: [Vec3; 2],
    blur: f32,
    visible: &mut Vec<&'a Part>,
) {
    let middle = (low + high) / 2.0;
    let radius = (high - low).length() / 2.0;
    let reach = if radius < FARTHEST {
        STEEPEST * radius + blur
    } else {
        f32::INFINITY
    };
    visible.clear();
    for part in parts
        .iter()
        .filter(|part| part.meets(low - blur, high + blur))
    {
        let distance = (part.distance)(middle);
        if distance < -reach {
            // nothing shows through it
            visible.clear();
        }
        if distance < reach {
            visible.push(part);
        }
    }
}

/// Mean intensity [HU] and tissue at a point; tissues blend within `blur` [mm] of a surface.
pub(super) fn paint(parts: &[&Part], point: Vec3, blur: f32) -> (f32, Tissue) {
    let mut value = Tissue::Air.intensity().0;
    let mut tissue = Tissue::Air;
    for part in parts {
        let distance = (part.distance)(point);
        let cover = smooth_step(0.5 - 0.5 * distance / blur);
        if cover > 0.0 {
            value += (part.tissue.intensity_at(-distance) - value) * cover;
        }
        if distance < 0.0 {
            tissue = part.tissue;
        }
    }
    (value, tissue)
}

/// 0 below 0, 1 above 1, smooth between.
fn smooth_step(share: f32) -> f32 {
    let share = share.clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seeded points of the field of view.
    fn random_points(count: usize) -> Vec<Vec3> {
        let mut random = oorandom::Rand32::new(11);
        let mut coordinate = |size: f32| (random.rand_float() - 0.5) * size;
        (0..count)
            .map(|_| Vec3::new(coordinate(400.0), coordinate(280.0), coordinate(540.0)))
            .collect()
    }

    /// Culling is a tissue of speed only.
    #[test]
    fn parts_left_out_of_a_block_never_show_in_it() {
        let parts = all_parts();
        let everything: Vec<&Part> = parts.iter().collect();
        let mut visible = Vec::new();

        // blocks of volumes from 1024³ to 80³ voxels
        for half in [
            [0.8, 0.5, 1.0],
            [3.0, 2.2, 4.2],
            [6.2, 4.4, 8.4],
            [10.0, 7.0, 13.5],
        ]
        .map(Vec3::from)
        {
            let blur = half.element_sum() / 8.0;
            for centre in random_points(20_000) {
                list_visible(&parts, [centre - half, centre + half], blur, &mut visible);
                for corner in 0..8 {
                    let sign = |bit: u32| if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
                    let point = centre + half * Vec3::new(sign(0), sign(1), sign(2));
                    let (value, tissue) = paint(&visible, point, blur);
                    let (true_value, true_tissue) = paint(&everything, point, blur);

                    // 0.001 HU: what lies beneath a part leaves a rounding behind
                    assert!((value - true_value).abs() < 1e-3, "{point} {half}: {value}");
                    assert_eq!(tissue, true_tissue, "{point} {half}");
                }
            }
        }
    }

    /// A box that cuts its shape would show as a flat face.
    #[test]
    fn every_shape_lies_within_its_box() {
        let parts = all_parts();
        for point in random_points(100_000) {
            for part in parts.iter().filter(|part| !part.meets(point, point)) {
                let inside_field = point.abs().cmplt(Vec3::new(199.0, 139.0, 269.0)).all();
                assert!(
                    !inside_field || (part.distance)(point) > 0.0,
                    "{:?} reaches {point} outside {:?}",
                    part.tissue,
                    part.bounds
                );
            }
        }
    }
}
