//! The pelvis and the upper ends of the thigh bones.
//!
//! The wing of each hip bone is an outline drawn on a bowl; sockets, pubic and sitting
//! bones are rods.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::part::Part;
use super::shapes::{Tube, blend, chain, cut, ellipsoid, polygon, rod, sphere};
use super::tissue::Tissue;

/// Joint cartilage, hip bones, thigh bones.
pub(super) fn parts() -> Vec<Part> {
    let bowl = bowl();
    let whole = ([-160.0, -110.0, -270.0], [160.0, 100.0, -70.0]);
    vec![
        Part::new(
            Tissue::Cartilage,
            ([-14.0, -90.0, -250.0], [14.0, -40.0, -195.0]),
            |p| ellipsoid(p, [0.0, -66.0, -222.0], [9.0, 9.0, 19.0]),
        ),
        Part::new(Tissue::Pelvis, whole, move |p| {
            let side = Vec3::new(p.x.abs(), p.y, p.z);
            hip_distance(&bowl, side)
        }),
        Part::new(
            Tissue::Femurs,
            ([-170.0, -60.0, -270.0], [170.0, 60.0, -165.0]),
            |p| thigh_distance(Vec3::new(p.x.abs(), p.y, p.z)),
        ),
    ]
}

/// The surface of the wings: wide above, narrow at the hip joints.
fn bowl() -> Tube {
    Tube::through(
        &[
            (-70.0, 140.0, 92.0, 0.0),
            (-95.0, 134.0, 88.0, -2.0),
            (-125.0, 118.0, 82.0, 0.0),
            (-155.0, 98.0, 74.0, 3.0),
            (-185.0, 80.0, 66.0, 6.0),
            (-220.0, 72.0, 60.0, 8.0),
        ],
        0.1,
    )
}

/// Millimetres around the bowl per radian.
const AROUND: f32 = 104.0;

fn hip_distance(bowl: &Tube, side: Vec3) -> f32 {
    let ring = blend(wing_distance(bowl, side), socket_distance(side), 10.0);
    blend(ring, lower_distance(side), 6.0)
}

/// The wing, on which the crest is thicker.
fn wing_distance(bowl: &Tube, side: Vec3) -> f32 {
    // way around the bowl from the back [mm] and height: crest, front edge, hip joint,
    // notch, joint with the sacrum
    const OUTLINE: [[f32; 2]; 17] = [
        [42.0, -128.0],
        [56.0, -108.0],
        [82.0, -92.0],
        [112.0, -84.0],
        [142.0, -82.0],
        [172.0, -87.0],
        [200.0, -98.0],
        [222.0, -114.0],
        [224.0, -124.0],
        [208.0, -142.0],
        [210.0, -158.0],
        [196.0, -176.0],
        [178.0, -210.0],
        [128.0, -214.0],
        [112.0, -182.0],
        [84.0, -172.0],
        [43.0, -160.0],
    ];
    let (depth, angle) = bowl.locate(side);
    if depth.abs() > 25.0 || side.z > -70.0 {
        return depth.abs().max(side.z + 82.0);
    }
    let face = polygon(Vec2::new(angle / PI * PI * AROUND, side.z), &OUTLINE);
    let rim = ((face + 14.0) / 14.0).clamp(0.0, 1.0);
    let toward_joint = ((-150.0 - side.z) / 40.0).clamp(0.0, 1.0);
    let back = ((95.0 - angle * AROUND) / 40.0).clamp(0.0, 1.0);
    let thickness = 2.8 + 2.4 * rim + 5.0 * toward_joint + 5.0 * back;
    cut(depth.abs() - thickness, face, 4.0)
}

/// The cup around the head of the thigh bone, open to the side and forward.
fn socket_distance(side: Vec3) -> f32 {
    let cup = sphere(side, HEAD, 31.0);
    let hollow = sphere(side, HEAD, 25.0);
    let open = (side - HEAD).dot(Vec3::new(0.83, -0.28, -0.48)) - 6.0;
    cut(cut(cup, -hollow, 2.0), open, 3.0)
}

const HEAD: Vec3 = Vec3::new(88.0, 4.0, -197.0);

/// Pubic and sitting bones around the opening between them.
fn lower_distance(side: Vec3) -> f32 {
    const UPPER_BRANCH: [[f32; 3]; 4] = [
        [72.0, -18.0, -190.0],
        [52.0, -42.0, -194.0],
        [32.0, -58.0, -203.0],
        [15.0, -66.0, -211.0],
    ];
    const LOWER_BRANCH: [[f32; 3]; 4] = [
        [14.0, -64.0, -230.0],
        [26.0, -48.0, -244.0],
        [42.0, -18.0, -255.0],
        [52.0, 14.0, -258.0],
    ];
    let pubis = ellipsoid(side, [13.5, -66.0, -220.0], [9.5, 8.5, 18.0]);
    let seat = rod(side, [74.0, 28.0, -212.0], [60.0, 34.0, -252.0], 12.0, 14.5);
    let branches = chain(side, &UPPER_BRANCH, 7.8).min(chain(side, &LOWER_BRANCH, 6.5));
    blend(blend(pubis, branches, 8.0), seat, 8.0)
}

/// Head, neck, both trochanters and shaft.
fn thigh_distance(side: Vec3) -> f32 {
    let head = sphere(side, HEAD, 23.0);
    let neck = rod(side, HEAD, [126.0, 10.0, -222.0], 13.0, 16.0);
    let outer = ellipsoid(side, [138.0, 16.0, -214.0], [13.0, 17.0, 21.0]);
    let inner = sphere(side, [114.0, 24.0, -254.0], 10.0);
    let shaft = rod(
        side,
        [128.0, 11.0, -228.0],
        [121.0, 6.0, -285.0],
        17.0,
        14.0,
    );
    let whole = blend(blend(head, neck, 6.0), blend(outer, shaft, 10.0), 8.0);
    blend(whole, inner, 10.0)
}
