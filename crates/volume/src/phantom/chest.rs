//! The chest: ribs with their cartilage, sternum, collar bones, shoulder blades, the heads
//! of the arm bones.
//!
//! Ribs lie on one surface, the cage; each follows it around from its vertebra, falling
//! toward the front, and its cartilage rises to the sternum again.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::part::Part;
use super::shapes::{Curve, Tube, chain, cut, ellipse, polygon, rod, sphere};
use super::spine::axis;
use super::tissue::Tissue;

/// Cartilage before bone, so that bone covers it at the joints.
pub(super) fn parts() -> Vec<Part> {
    let around = ([-150.0, -110.0, -30.0], [150.0, 115.0, 250.0]);
    let [cartilage, ribs, blades] = [cage(), cage(), cage()];
    let heads = RibHeads::new(&ribs, &axis());
    let sternum = Sternum { cage: cage() };
    vec![
        Part::new(Tissue::Cartilage, around, move |p| {
            cartilage_distance(&cartilage, p)
        }),
        Part::new(Tissue::Ribs, around, move |p| {
            rib_distance(&ribs, p).min(heads.distance(p))
        }),
        Part::new(
            Tissue::Sternum,
            ([-32.0, -125.0, 45.0], [32.0, -30.0, 225.0]),
            move |p| sternum.distance(p),
        ),
        Part::new(
            Tissue::Shoulders,
            ([-185.0, -90.0, 90.0], [185.0, 125.0, 245.0]),
            move |p| shoulder_distance(&blades, p),
        ),
    ]
}

/// The surface on which the ribs lie.
pub(super) fn cage() -> Tube {
    Tube::through(
        &[
            (250.0, 30.0, 26.0, 26.0),
            (240.0, 48.0, 38.0, 24.0),
            (225.0, 72.0, 50.0, 18.0),
            (205.0, 95.0, 63.0, 11.0),
            (180.0, 112.0, 74.0, 5.0),
            (150.0, 124.0, 83.0, 1.0),
            (110.0, 132.0, 90.0, -2.0),
            (60.0, 134.0, 92.0, -4.0),
            (20.0, 131.0, 90.0, -4.0),
            (-30.0, 122.0, 84.0, -2.0),
        ],
        0.2,
    )
}

/// Course of one rib: heights [mm] at the vertebra, at the end of its bone and where its
/// cartilage ends; angles of these ends as shares of the way from back to front.
#[derive(Clone, Copy)]
struct Rib {
    vertebra: f32,
    bone_end: (f32, f32),
    cartilage_end: (f32, f32),
}

/// All twelve, from above. The last two end free, so their cartilage is a mere tip.
const RIBS: [Rib; 12] = [
    rib(1, (0.78, 212.0), (0.94, 205.0)),
    rib(2, (0.80, 186.0), (0.945, 186.0)),
    rib(3, (0.80, 160.0), (0.945, 167.0)),
    rib(4, (0.79, 134.0), (0.945, 149.0)),
    rib(5, (0.78, 108.0), (0.945, 132.0)),
    rib(6, (0.76, 82.0), (0.95, 116.0)),
    rib(7, (0.73, 57.0), (0.955, 102.0)),
    rib(8, (0.69, 36.0), (0.89, 80.0)),
    rib(9, (0.64, 17.0), (0.81, 54.0)),
    rib(10, (0.58, 1.0), (0.73, 31.0)),
    rib(11, (0.46, -7.0), (0.475, -8.0)),
    rib(12, (0.26, -14.0), (0.275, -15.0)),
];

const fn rib(number: usize, bone_end: (f32, f32), cartilage_end: (f32, f32)) -> Rib {
    // it meets the spine at the upper edge of its vertebra
    let index = number as f32 + 1.0;
    let vertebra = 274.2 - 13.8 * index - 0.4 * index * index - 5.0;
    Rib {
        vertebra,
        bone_end,
        cartilage_end,
    }
}

impl Rib {
    /// Height [mm] and slope [mm per share of the way] of the bone.
    fn bone(&self, share: f32) -> (f32, f32) {
        let (end, height) = self.bone_end;
        let t = (share / end).min(1.0);
        // it falls slowly at the back and in front, fastest at the side
        let fall = self.vertebra - height;
        let eased = t + 0.13 * (2.0 * PI * (t - 0.5)).sin() / PI;
        (self.vertebra - fall * eased, -fall / end)
    }

    /// Height and slope of the cartilage, level first, then rising.
    fn cartilage(&self, share: f32) -> (f32, f32) {
        let ((start, low), (end, high)) = (self.bone_end, self.cartilage_end);
        let t = ((share - start) / (end - start)).clamp(0.0, 1.0);
        let eased = t * t * (2.0 - t);
        (
            low + (high - low) * eased,
            (high - low) * (4.0 * t - 3.0 * t * t) / (end - start),
        )
    }
}

/// Half height and half thickness of ribs [mm].
const RIB_SIZE: Vec2 = Vec2::new(6.6, 3.6);
/// The way along the cage from the spine to the sternum, roughly [mm].
const HALF_WAY_AROUND: f32 = 330.0;

fn rib_distance(cage: &Tube, p: Vec3) -> f32 {
    along_cage(cage, p, |rib, share| {
        let (height, slope) = rib.bone(share);
        let past_front = share - rib.bone_end.0;
        let past_back = (22.0 - p.x.abs()) / HALF_WAY_AROUND;
        (height, slope, past_front.max(past_back))
    })
}

fn cartilage_distance(cage: &Tube, p: Vec3) -> f32 {
    along_cage(cage, p, |rib, share| {
        let (height, slope) = rib.cartilage(share);
        (
            height,
            slope,
            (share - rib.cartilage_end.0).max(rib.bone_end.0 - 0.01 - share),
        )
    })
}

/// Distance to bands on the cage; `course` gives height, slope and how far past the end.
fn along_cage(cage: &Tube, p: Vec3, course: impl Fn(&Rib, f32) -> (f32, f32, f32)) -> f32 {
    let (depth, angle) = cage.locate(p);
    if depth.abs() > 3.0 * RIB_SIZE.y {
        return depth.abs() - RIB_SIZE.y;
    }
    let share = angle.abs() / PI;

    // lower near the spine, where ribs lie closest together
    let size = Vec2::new(RIB_SIZE.x * (0.7 + 1.5 * share).min(1.0), RIB_SIZE.y);
    let mut nearest = f32::INFINITY;
    for rib in &RIBS {
        let (height, slope, past) = course(rib, share);
        let slant = (slope / HALF_WAY_AROUND).hypot(1.0);
        let band = ellipse(Vec2::new((p.z - height) / slant, depth), size);
        nearest = nearest.min(cut(band, past * HALF_WAY_AROUND, 3.0));
    }
    nearest
}

/// The short way of each rib from the cage forward and inward to its vertebra.
struct RibHeads {
    /// Ends of each rib on the vertebra and on the cage, patient's left.
    ends: [(Vec3, Vec3); 12],
}

impl RibHeads {
    fn new(cage: &Tube, axis: &Curve) -> Self {
        const SIDE: f32 = 34.0;
        let ends = RIBS.map(|rib| {
            let share = (SIDE / cage.half_width_at(rib.vertebra)).asin() / PI;
            let height = rib.bone(share).0;
            let on_cage = Vec3::new(SIDE, cage.back(SIDE, height), height);
            let on_vertebra = Vec3::new(15.0, axis.at(rib.vertebra) + 5.0, rib.vertebra + 1.0);
            (on_vertebra, on_cage)
        });
        Self { ends }
    }

    fn distance(&self, p: Vec3) -> f32 {
        let side = Vec3::new(p.x.abs(), p.y, p.z);
        let away = (side.x - 40.0).max(25.0 - side.y).max(-side.z);
        if away > 5.0 {
            return away;
        }
        self.ends
            .iter()
            .map(|&(vertebra, cage)| rod(side, vertebra, cage, 4.0, 4.5))
            .fold(f32::INFINITY, f32::min)
    }
}

/// The breastbone: handle, body and tip, a plate on the front of the cage.
struct Sternum {
    cage: Tube,
}

impl Sternum {
    fn distance(&self, p: Vec3) -> f32 {
        const OUTLINE: [[f32; 2]; 13] = [
            [0.0, 209.0],
            [12.0, 214.0],
            [26.0, 210.0],
            [27.0, 200.0],
            [15.0, 184.0],
            [13.0, 176.0],
            [18.0, 130.0],
            [19.0, 108.0],
            [11.0, 96.0],
            [5.0, 90.0],
            [4.0, 70.0],
            [0.0, 66.0],
            [-1.0, 140.0],
        ];
        let depth = self.cage.distance(p);
        if p.y > 0.0 || depth.abs() > 20.0 {
            return depth.abs().max(p.y + 20.0) - 6.0;
        }
        let face = polygon(Vec2::new(p.x.abs(), p.z), &OUTLINE);
        cut((depth + 1.0).abs() - 4.5, face - 1.0, 4.0)
    }
}

fn shoulder_distance(cage: &Tube, p: Vec3) -> f32 {
    let side = Vec3::new(p.x.abs(), p.y, p.z);
    let blade = blade_distance(cage, side);
    collar_bone_distance(side)
        .min(blade)
        .min(arm_distance(side))
}

pub(super) fn collar_bone_distance(side: Vec3) -> f32 {
    const JOINTS: [[f32; 3]; 6] = [
        [22.0, -58.0, 213.0],
        [48.0, -62.0, 217.0],
        [75.0, -54.0, 220.0],
        [102.0, -32.0, 222.0],
        [125.0, -12.0, 222.0],
        [144.0, -4.0, 220.0],
    ];
    chain(side, &JOINTS, 5.8)
}

/// The shoulder blade: a thin plate that lies on the ribs at the back, its spine and the
/// roof over the joint.
fn blade_distance(cage: &Tube, side: Vec3) -> f32 {
    // way around the cage [mm] and height
    const OUTLINE: [[f32; 2]; 9] = [
        [66.0, 212.0],
        [92.0, 218.0],
        [112.0, 207.0],
        [138.0, 209.0],
        [142.0, 186.0],
        [124.0, 174.0],
        [92.0, 110.0],
        [82.0, 108.0],
        [66.0, 160.0],
    ];
    let (depth, angle) = cage.locate(side);
    let around = angle / PI * HALF_WAY_AROUND;
    let face = polygon(Vec2::new(around, side.z), &OUTLINE);

    // the outer border is thicker
    let thickness = if face > -5.0 { 3.4 } else { 2.4 };
    let plate = cut((depth - 15.0).abs() - thickness, face, 3.0);

    const BEAK: [[f32; 3]; 3] = [
        [122.0, 26.0, 206.0],
        [114.0, -8.0, 214.0],
        [124.0, -24.0, 206.0],
    ];
    let socket = rod(side, [118.0, 40.0, 196.0], [129.0, 22.0, 196.0], 8.0, 14.0);
    plate
        .min(blade_spine_distance(side))
        .min(chain(side, &BEAK, 4.5))
        .min(socket)
}

/// The ridge across the shoulder blade, which ends as a roof over the joint.
pub(super) fn blade_spine_distance(side: Vec3) -> f32 {
    const COURSE: [[f32; 3]; 4] = [
        [60.0, 91.0, 184.0],
        [98.0, 80.0, 200.0],
        [138.0, 47.0, 218.0],
        [152.0, 16.0, 222.0],
    ];
    chain(side, &COURSE, 4.6)
}

/// Head and upper end of the arm bone.
fn arm_distance(side: Vec3) -> f32 {
    let head = sphere(side, [147.0, 8.0, 196.0], 20.0);
    let shaft = rod(side, [156.0, 6.0, 190.0], [157.0, 6.0, 146.0], 14.0, 10.0);
    head.min(shaft)
}
