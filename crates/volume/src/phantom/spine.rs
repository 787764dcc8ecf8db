//! The spine: vertebrae with bodies, arches and processes, discs between them, the spinal
//! canal behind, and the sacrum below.

use glam::{Vec2, Vec3};

use super::part::Part;
use super::shapes::{Curve, blend, cut, ellipse, rod};
use super::tissue::Tissue;

/// Canal, discs, vertebrae, sacrum.
pub(super) fn parts() -> Vec<Part> {
    let column = ([-50.0, -10.0, -140.0], [50.0, 130.0, 270.0]);
    let [canal, discs, bones] = [Spine::new(), Spine::new(), Spine::new()];
    let sacrum = Sacrum::new();
    vec![
        Part::new(
            Tissue::SpinalCanal,
            ([-12.0, 0.0, -215.0], [12.0, 110.0, 270.0]),
            move |p| canal.canal(p),
        ),
        Part::new(Tissue::Discs, column, move |p| discs.discs(p)),
        Part::new(Tissue::Spine, column, move |p| bones.vertebrae(p)),
        Part::new(
            Tissue::Spine,
            ([-62.0, 0.0, -262.0], [62.0, 115.0, -115.0]),
            move |p| sacrum.distance(p),
        ),
    ]
}

/// Number of thoracic and lumbar vertebrae, and one cervical above them.
const VERTEBRAE: usize = 19;

/// Height [mm] of the upper end of vertebra `index`, 0 = C6, 1 = C7, 2..=13 = T1–T12, 14..=18 = L1–L5.
fn top_of(index: usize) -> f32 {
    let index = index as f32;
    // heights grow from 14 mm at the neck to 29 mm at L5
    274.2 - 13.8 * index - 0.4 * index * index
}

/// y of the axis through the vertebral bodies, by height.
pub(super) fn axis() -> Curve {
    Curve::through(&[
        (270.0, 20.0),
        (245.0, 27.0),
        (200.0, 41.0),
        (150.0, 51.0),
        (100.0, 53.0),
        (50.0, 46.0),
        (0.0, 33.0),
        (-50.0, 22.0),
        (-90.0, 18.0),
        (-133.0, 27.0),
        (-160.0, 44.0),
        (-190.0, 57.0),
        (-215.0, 61.0),
        (-240.0, 53.0),
        (-262.0, 38.0),
    ])
}

/// Height [mm] at which the canal ends in the sacrum.
const SACRAL_CANAL_END: f32 = -210.0;

struct Spine {
    axis: Curve,
    body_width: Curve,
    body_depth: Curve,
    tops: [f32; VERTEBRAE + 1],
}

impl Spine {
    fn new() -> Self {
        Self {
            axis: axis(),
            body_width: Curve::through(&[
                (270.0, 12.5),
                (180.0, 14.5),
                (20.0, 20.0),
                (-135.0, 25.5),
            ]),
            body_depth: Curve::through(&[
                (270.0, 9.0),
                (180.0, 12.0),
                (20.0, 15.5),
                (-135.0, 17.5),
            ]),
            tops: std::array::from_fn(top_of),
        }
    }

    /// Point relative to the axis at its height.
    fn relative(&self, p: Vec3) -> Vec3 {
        Vec3::new(p.x.abs(), p.y - self.axis.at(p.z), p.z)
    }

    /// Half width and half depth of the vertebral bodies at a height.
    fn body(&self, z: f32) -> Vec2 {
        Vec2::new(self.body_width.at(z), self.body_depth.at(z))
    }

    fn canal(&self, p: Vec3) -> f32 {
        let q = self.relative(p);

        let centre = Vec2::new(0.0, self.body(p.z).y + 7.5);
        let tube = ellipse(q.truncate() - centre, Vec2::new(10.0, 8.0));
        tube.max(SACRAL_CANAL_END - p.z)
    }

    fn discs(&self, p: Vec3) -> f32 {
        let round = ellipse(self.relative(p).truncate(), self.body(p.z) + 0.5);
        cut(round, self.tops[VERTEBRAE] - p.z, 3.0)
    }

    fn vertebrae(&self, p: Vec3) -> f32 {
        let q = self.relative(p);
        let at = self.tops.partition_point(|&top| top > p.z).max(1) - 1;

        // processes reach down to the level of the vertebra below
        let first = at.saturating_sub(2);
        let last = (at + 1).min(VERTEBRAE - 1);
        (first..=last)
            .map(|index| self.vertebra(index, q))
            .fold(f32::INFINITY, f32::min)
    }

    fn vertebra(&self, index: usize, q: Vec3) -> f32 {
        let (top, bottom) = (self.tops[index], self.tops[index + 1]);
        let middle = (top + bottom) / 2.0;
        let height = top - bottom;
        let q = Vec3::new(q.x, q.y, q.z - middle);
        let size = self.body(middle);

        // the body is waisted, and thinner than its share of the column by the disc
        let half = height / 2.0 - 1.2 - 0.09 * height;
        let waist = 1.8 * (1.0 - (q.z / half).powi(2)).max(0.0);
        let body = cut(ellipse(q.truncate(), size - waist), q.z.abs() - half, 3.0);
        body.min(arch(q, index, size, height))
            .min(processes(q, index, size, height))
    }
}

/// The ring of bone around the canal.
fn arch(q: Vec3, index: usize, size: Vec2, height: f32) -> f32 {
    let around = ellipse(
        q.truncate() - Vec2::new(0.0, size.y + 7.5),
        Vec2::new(12.5, 10.5),
    );
    let lean = if index < 14 { 2.0 } else { 1.0 };
    // the back of the ring hangs lower than its roots
    let level = q.z + lean * 0.12 * (q.y - size.y);
    cut(around.abs() - 2.4, level.abs() - 0.3 * height, 3.0)
}

/// Processes to the sides, backward, and those that join one arch to the next.
fn processes(q: Vec3, index: usize, size: Vec2, height: f32) -> f32 {
    let lumbar = index >= 14;
    let root = Vec3::new(11.0, size.y + 9.0, 0.0);
    let tip = if lumbar {
        Vec3::new(38.0, size.y + 10.0, 2.0)
    } else {
        Vec3::new(30.0 - 0.6 * index as f32, size.y + 21.0, 3.0)
    };
    let side = rod(q, root, tip, 4.6, 3.8);

    // flat plates, seen from the side: the x axis is stretched
    let (reach, drop) = if lumbar { (25.0, 5.0) } else { (17.0, 17.0) };
    let flat = Vec3::new(q.x * 2.0, q.y, q.z);
    let back = Vec3::new(0.0, size.y + 17.0, -1.0);
    let spinous = rod(
        flat,
        back,
        back + Vec3::new(0.0, reach, -drop),
        6.5,
        if lumbar { 8.0 } else { 5.0 },
    ) * 0.6;

    let joint = rod(
        q,
        Vec3::new(12.5, size.y + 13.0, -0.52 * height),
        Vec3::new(12.0, size.y + 13.0, 0.5 * height),
        3.8,
        3.8,
    );
    side.min(blend(spinous, joint, 4.0))
}

/// Five fused vertebrae between the hip bones, curved like a shovel, and the coccyx.
struct Sacrum {
    axis: Curve,
    half_width: Curve,
    half_depth: Curve,
}

impl Sacrum {
    fn new() -> Self {
        Self {
            axis: axis(),
            half_width: Curve::through(&[
                (-118.0, 30.0),
                (-135.0, 54.0),
                (-160.0, 52.0),
                (-185.0, 36.0),
                (-215.0, 23.0),
                (-240.0, 9.0),
                (-262.0, 5.0),
            ]),
            half_depth: Curve::through(&[
                (-118.0, 14.0),
                (-135.0, 19.0),
                (-160.0, 16.0),
                (-190.0, 11.0),
                (-220.0, 7.0),
                (-262.0, 4.0),
            ]),
        }
    }

    fn distance(&self, p: Vec3) -> f32 {
        let x = p.x.abs();
        let width = self.half_width.at(p.z);
        // the wings bend forward
        let bend = 8.0 * (x / 50.0).powi(2);
        let y = p.y - self.axis.at(p.z) - 3.0 + bend;
        let plate = ellipse(Vec2::new(x, y), Vec2::new(width, self.half_depth.at(p.z))) * 0.85;
        let crest = rod(
            Vec3::new(x * 2.0, y, p.z),
            [0.0, 14.0, -140.0],
            [0.0, 7.0, -215.0],
            9.0,
            4.0,
        ) * 0.6;
        let bone = blend(plate, crest, 6.0);
        let ends = (p.z + 128.0 - 0.1 * x).max(-259.0 - p.z);
        cut(bone, ends, 5.0).max(-self.holes(x, y, p.z))
    }

    /// Four pairs of openings for the nerves.
    fn holes(&self, x: f32, y: f32, z: f32) -> f32 {
        [
            (-152.0, 21.0),
            (-170.0, 18.5),
            (-187.0, 16.0),
            (-203.0, 13.5),
        ]
        .iter()
        .map(|&(level, side)| Vec2::new(x - side, z - level - 0.2 * y).length() - 3.6)
        .fold(f32::INFINITY, f32::min)
    }
}
