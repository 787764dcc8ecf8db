//! The outline of the trunk and its layers: skin, fat, muscle, and the abdominal cavity.

use glam::Vec3;

use super::chest::{blade_spine_distance, collar_bone_distance};
use super::part::Part;
use super::shapes::{Curve, Tube, blend, cut, ellipsoid};
use super::tissue::Tissue;

const WHOLE: ([f32; 3], [f32; 3]) = ([-200.0, -140.0, -270.0], [200.0, 140.0, 270.0]);
const SKIN_THICKNESS: f32 = 2.5;

/// Layers from outside inward.
pub(super) fn parts() -> Vec<Part> {
    let fat = fat_thickness();
    let [skin, inside, beneath] = [Outline::new(), Outline::new(), Outline::new()];
    let cavity = abdominal_cavity();
    vec![
        Part::new(Tissue::Skin, WHOLE, move |p| skin.distance(p)),
        Part::new(Tissue::Fat, WHOLE, move |p| {
            inside.distance(p) + SKIN_THICKNESS
        }),
        Part::new(Tissue::Muscle, WHOLE, move |p| {
            beneath.distance(p) + SKIN_THICKNESS + fat.at(p.z)
        }),
        Part::new(
            Tissue::Fat,
            ([-150.0, -110.0, -245.0], [150.0, 90.0, 80.0]),
            move |p| cut(cavity.distance(p), (p.z - 60.0).max(-238.0 - p.z), 20.0),
        ),
    ]
}

/// The surface of the body.
struct Outline {
    torso: Tube,
}

impl Outline {
    fn new() -> Self {
        let torso = Tube::through(
            &[
                // z, half width, half depth, y of the centre
                (270.0, 55.0, 60.0, 14.0),
                (250.0, 60.0, 62.0, 18.0),
                (232.0, 86.0, 70.0, 18.0),
                (214.0, 124.0, 84.0, 14.0),
                (195.0, 148.0, 97.0, 8.0),
                (160.0, 159.0, 108.0, 4.0),
                (120.0, 158.0, 112.0, 3.0),
                (70.0, 153.0, 113.0, 2.0),
                (20.0, 147.0, 108.0, 0.0),
                (-25.0, 139.0, 102.0, -2.0),
                (-60.0, 138.0, 100.0, -2.0),
                (-100.0, 148.0, 102.0, 0.0),
                (-150.0, 166.0, 107.0, 2.0),
                (-200.0, 176.0, 111.0, 4.0),
                (-240.0, 174.0, 109.0, 4.0),
                (-270.0, 168.0, 105.0, 3.0),
            ],
            0.35,
        );
        Self { torso }
    }

    fn distance(&self, p: Vec3) -> f32 {
        let side = Vec3::new(p.x.abs(), p.y, p.z);
        let shoulder = ellipsoid(side, [142.0, 10.0, 180.0], [44.0, 52.0, 58.0]);
        let chest = ellipsoid(side, [66.0, -80.0, 142.0], [60.0, 30.0, 44.0]);
        let buttock = ellipsoid(side, [66.0, 84.0, -215.0], [66.0, 42.0, 62.0]);

        let body = blend(self.torso.distance(p), shoulder, 30.0);
        let body = blend(body, chest, 26.0);
        let body = blend(body, buttock, 26.0) + furrows(p);

        // collar bones and shoulder blades show under the skin
        let bones = collar_bone_distance(side).min(blade_spine_distance(side));
        blend(body, bones - 4.0, 16.0)
    }
}

/// How far the surface lies under the smooth body [mm]: along the spine, the breastbone and
/// the belly, between the buttocks, and at the navel.
fn furrows(p: Vec3) -> f32 {
    if p.x.abs() > 40.0 {
        return 0.0;
    }
    let groove = |width: f32| (-(p.x / width).powi(2)).exp();
    if p.y > 50.0 {
        let cleft = 13.0 * groove(11.0) * ((-200.0 - p.z) / 30.0).clamp(0.0, 1.0);
        return 4.0 * groove(18.0) + cleft;
    }
    if p.y < -50.0 {
        let navel = 12.0 * (-(p.x.powi(2) + (p.z + 75.0).powi(2)) / 60.0).exp();
        return 3.5 * groove(11.0) + navel;
    }
    0.0
}

/// Thickness of the fat under the skin [mm] by height.
fn fat_thickness() -> Curve {
    Curve::through(&[
        (270.0, 4.0),
        (200.0, 6.0),
        (100.0, 7.5),
        (20.0, 10.0),
        (-50.0, 15.0),
        (-120.0, 17.0),
        (-200.0, 18.0),
        (-270.0, 15.0),
    ])
}

/// The cavity behind the belly's wall, filled with fat before organs lie in it.
fn abdominal_cavity() -> Tube {
    Tube::through(
        &[
            (80.0, 122.0, 84.0, -2.0),
            (20.0, 120.0, 80.0, -6.0),
            (-40.0, 108.0, 58.0, -24.0),
            (-90.0, 106.0, 52.0, -28.0),
            (-140.0, 96.0, 52.0, -20.0),
            (-190.0, 58.0, 52.0, -8.0),
            (-225.0, 40.0, 40.0, 0.0),
            (-245.0, 10.0, 20.0, 5.0),
        ],
        0.2,
    )
}
