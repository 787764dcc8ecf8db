//! Soft organs of chest and belly.

use glam::{Vec2, Vec3};

use super::chest::cage;
use super::part::Part;
use super::shapes::{Tube, blend, chain, cut, ellipsoid, rod, sphere};
use super::spine::axis;
use super::tissue::Tissue;

/// Chest first, then belly; vessels and airways last, since they run through the others.
pub(super) fn parts() -> Vec<Part> {
    let mut parts = chest();
    parts.extend(belly());
    parts.extend(tubes());
    parts
}

fn chest() -> Vec<Part> {
    let [mediastinum, lungs] = [cage(), cage()];
    let inner = ([-140.0, -110.0, -25.0], [140.0, 110.0, 245.0]);
    vec![
        Part::new(
            Tissue::Fat,
            ([-45.0, -105.0, 40.0], [60.0, 90.0, 240.0]),
            move |p| {
                let height = (p.z - 236.0).max(44.0 - p.z);
                cut(
                    mediastinum.distance(p) + 7.0,
                    middle_distance(p).max(height),
                    8.0,
                )
            },
        ),
        Part::new(Tissue::Lungs, inner, move |p| lung_distance(&lungs, p)),
        Part::new(
            Tissue::Heart,
            ([-60.0, -95.0, 45.0], [90.0, 45.0, 165.0]),
            heart_distance,
        ),
    ]
}

/// The space between the lungs.
fn middle_distance(p: Vec3) -> f32 {
    let front = ((-p.y - 10.0) / 80.0).clamp(0.0, 1.0);
    let half_width = 27.0 - 15.0 * front;
    p.x.abs() - half_width
}

/// Height of the diaphragm: two domes, the right one higher, falling to the sides and back.
fn diaphragm(p: Vec3) -> f32 {
    let dome = |centre: f32, top: f32| {
        let out = Vec2::new((p.x - centre) / 74.0, (p.y + 12.0) / 82.0);
        top - 62.0 * out.length_squared().powf(1.3)
    };
    -blend(-dome(-62.0, 82.0), -dome(66.0, 70.0), 10.0)
}

fn lung_distance(cage: &Tube, p: Vec3) -> f32 {
    let wall = cage.distance(p) + 7.5;
    // the middle is narrow at the top and in front
    let middle = -middle_distance(p);
    let floor = (diaphragm(p) + 5.0 - p.z) * 0.7;
    let heart = -(heart_distance(p) - 4.0);
    let top = p.z - 234.0;
    cut(
        cut(cut(wall, middle, 10.0), floor, 6.0).max(top),
        heart,
        6.0,
    )
}

/// The heart lies obliquely, its tip forward, down and to the left.
fn heart_distance(p: Vec3) -> f32 {
    let base = rod(p, [-8.0, -14.0, 128.0], [26.0, -38.0, 92.0], 34.0, 38.0);
    let tip = rod(p, [26.0, -38.0, 92.0], [58.0, -56.0, 76.0], 36.0, 18.0);
    blend(base, tip, 10.0)
}

fn belly() -> Vec<Part> {
    vec![
        Part::new(
            Tissue::Muscle,
            ([-85.0, -30.0, -200.0], [85.0, 50.0, 5.0]),
            psoas_distance,
        ),
        Part::new(
            Tissue::Bowel,
            ([-100.0, -95.0, -190.0], [100.0, 30.0, -10.0]),
            bowel_distance,
        ),
        Part::new(
            Tissue::Bowel,
            ([-115.0, -95.0, -190.0], [115.0, 45.0, 20.0]),
            colon_distance,
        ),
        Part::new(
            Tissue::Stomach,
            ([-45.0, -85.0, -40.0], [115.0, 50.0, 75.0]),
            stomach_distance,
        ),
        Part::new(
            Tissue::Spleen,
            ([55.0, 5.0, -15.0], [125.0, 85.0, 70.0]),
            spleen_distance,
        ),
        Part::new(
            Tissue::Kidneys,
            ([-95.0, 10.0, -85.0], [95.0, 65.0, 45.0]),
            kidney_distance,
        ),
        Part::new(
            Tissue::Liver,
            ([-130.0, -105.0, -70.0], [85.0, 85.0, 85.0]),
            Liver::new().into_distance(),
        ),
        Part::new(
            Tissue::Bladder,
            ([-45.0, -70.0, -230.0], [45.0, 15.0, -160.0]),
            |p| ellipsoid(p, [0.0, -28.0, -198.0], [36.0, 30.0, 26.0]),
        ),
    ]
}

/// The muscle on each side of the lumbar spine, down to the thigh.
fn psoas_distance(p: Vec3) -> f32 {
    let side = Vec3::new(p.x.abs(), p.y, p.z);
    let upper = rod(side, [28.0, 28.0, -10.0], [46.0, 24.0, -100.0], 10.0, 18.0);
    let lower = rod(
        side,
        [46.0, 24.0, -100.0],
        [66.0, -10.0, -180.0],
        18.0,
        16.0,
    );
    upper.min(lower)
}

/// Loops of the small bowel: the folds of a gyroid, within an ellipsoid.
fn bowel_distance(p: Vec3) -> f32 {
    const FOLD: f32 = 0.155;
    let room = ellipsoid(p, [0.0, -42.0, -95.0], [78.0, 38.0, 72.0]);
    if room > 5.0 {
        return room;
    }
    let (s, c) = ((p * FOLD).map(f32::sin), (p * FOLD).map(f32::cos));
    let folds = (s.x * c.y + s.y * c.z + s.z * c.x).abs() - 0.95;
    cut(room, folds / FOLD / 1.4, 5.0)
}

fn colon_distance(p: Vec3) -> f32 {
    const COURSE: [[f32; 3]; 9] = [
        [-82.0, -20.0, -150.0],
        [-90.0, -8.0, -90.0],
        [-88.0, -10.0, -45.0],
        [-48.0, -55.0, -42.0],
        [0.0, -68.0, -52.0],
        [50.0, -52.0, -34.0],
        [90.0, 0.0, -8.0],
        [92.0, 6.0, -90.0],
        [84.0, -4.0, -150.0],
    ];
    // pouches along its way
    let pouches = 2.5 * ((p.x + p.z) * 0.22).sin();
    chain(p, &COURSE, 17.0) + pouches
}

fn stomach_distance(p: Vec3) -> f32 {
    let dome = ellipsoid(p, [62.0, 0.0, 38.0], [36.0, 38.0, 32.0]);
    let body = rod(p, [58.0, -16.0, 22.0], [34.0, -44.0, -10.0], 27.0, 22.0);
    let exit = rod(p, [34.0, -44.0, -10.0], [-16.0, -36.0, -2.0], 20.0, 13.0);
    blend(blend(dome, body, 14.0), exit, 8.0)
}

fn spleen_distance(p: Vec3) -> f32 {
    let outer = ellipsoid(p, [88.0, 42.0, 26.0], [28.0, 34.0, 42.0]);
    let hollow = ellipsoid(p, [56.0, 22.0, 26.0], [34.0, 38.0, 46.0]);
    cut(outer, -hollow, 6.0)
}

/// Beans on both sides of the spine, the right one lower, with their hollow toward it.
fn kidney_distance(p: Vec3) -> f32 {
    let lower = if p.x < 0.0 { 14.0 } else { 0.0 };
    let side = Vec3::new(p.x.abs(), p.y, p.z + lower);
    let bean = ellipsoid(side, [64.0, 38.0, -12.0], [27.0, 23.0, 54.0]);
    let hollow = ellipsoid(side, [37.0, 28.0, -12.0], [15.0, 12.0, 16.0]);
    cut(bean, -hollow, 6.0)
}

/// The liver fills the right dome of the diaphragm and reaches over to the left.
struct Liver {
    cage: Tube,
}

impl Liver {
    fn new() -> Self {
        Self { cage: cage() }
    }

    fn into_distance(self) -> impl Fn(Vec3) -> f32 {
        move |p| {
            let right = ellipsoid(p, [-66.0, 0.0, 22.0], [66.0, 80.0, 74.0]);
            let left = ellipsoid(p, [8.0, -44.0, 42.0], [68.0, 36.0, 26.0]);
            let lobes = blend(right, left, 30.0);

            // under the diaphragm, within the ribs, hollow where the bowel and kidney press
            let dome = (p.z - diaphragm(p)) * 0.7;
            let wall = self.cage.distance(p) + 8.0;
            let below = ellipsoid(p, [-30.0, 10.0, -58.0], [66.0, 56.0, 58.0]);
            let cleft = rod(p, [-14.0, -80.0, 10.0], [-14.0, -40.0, 30.0], 6.0, 3.0);
            let inside = cut(cut(lobes, dome, 6.0), wall, 4.0);
            cut(cut(inside, -below, 16.0), -cleft, 8.0)
        }
    }
}

fn tubes() -> Vec<Part> {
    let spine = axis();
    vec![
        Part::new(
            Tissue::Vessels,
            ([-65.0, -50.0, -210.0], [65.0, 60.0, 202.0]),
            move |p| {
                let down = rod(
                    p,
                    Vec3::new(18.0, spine.at(p.z) - 27.0, 168.0),
                    Vec3::new(10.0, spine.at(p.z) - 29.0, -92.0),
                    11.5,
                    8.5,
                );
                let cava = rod(
                    p,
                    Vec3::new(-20.0, spine.at(p.z) - 27.0, 95.0),
                    Vec3::new(-16.0, spine.at(p.z) - 28.0, -96.0),
                    10.5,
                    10.5,
                );
                down.min(cava).min(great_vessels(p)).min(hip_vessels(p))
            },
        ),
        Part::new(
            Tissue::Cartilage,
            ([-70.0, -20.0, 100.0], [70.0, 60.0, 270.0]),
            |p| airways(p) - 1.8,
        ),
        Part::new(
            Tissue::Trachea,
            ([-70.0, -20.0, 100.0], [70.0, 60.0, 270.0]),
            airways,
        ),
    ]
}

/// The aorta's arch and the vessels above it.
fn great_vessels(p: Vec3) -> f32 {
    const ARCH: [[f32; 3]; 6] = [
        [-4.0, -18.0, 140.0],
        [-14.0, -20.0, 160.0],
        [-8.0, -12.0, 177.0],
        [6.0, 2.0, 182.0],
        [16.0, 14.0, 176.0],
        [18.0, 19.0, 164.0],
    ];
    let cava = rod(p, [-26.0, -12.0, 190.0], [-24.0, -8.0, 130.0], 9.0, 10.0);
    let lung = chain(
        Vec3::new(p.x.abs(), p.y, p.z),
        &[[0.0, -18.0, 146.0], [24.0, 0.0, 146.0], [48.0, 10.0, 138.0]],
        9.0,
    );
    chain(p, &ARCH, 12.5).min(cava).min(lung)
}

fn hip_vessels(p: Vec3) -> f32 {
    const COURSE: [[f32; 3]; 4] = [
        [0.0, -10.0, -92.0],
        [24.0, 2.0, -125.0],
        [46.0, 0.0, -160.0],
        [56.0, -32.0, -200.0],
    ];
    chain(Vec3::new(p.x.abs(), p.y, p.z), &COURSE, 6.0)
}

/// The windpipe and its two branches.
fn airways(p: Vec3) -> f32 {
    let trunk = rod(p, [0.0, 2.0, 285.0], [0.0, 18.0, 162.0], 7.5, 7.5);
    let right = rod(p, [0.0, 18.0, 162.0], [-42.0, 18.0, 128.0], 6.5, 5.0);
    let left = rod(p, [0.0, 18.0, 162.0], [46.0, 18.0, 134.0], 6.0, 4.5);
    trunk
        .min(right)
        .min(left)
        .min(sphere(p, [0.0, 18.0, 162.0], 7.0))
}
