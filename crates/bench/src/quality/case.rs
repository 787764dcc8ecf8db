//! The cases: bodies on two grids, and how the device is led under their surfaces.
//!
//! Frame: scene [mm], which is that of the grids, from their corner on.

use std::f64::consts::TAU;

use glam::{DMat3, DVec2, DVec3, UVec3};
use palpate_volume::grid::Grid;

use super::body::{Body, Shape};
use super::path::{through, walk};

/// Updates of one stroke, at most.
const UPDATES: usize = 2000;

/// A grid by its name: voxels, spacing [mm]. Both are some 90 mm wide.
const GRIDS: [(&str, UVec3, DVec3); 2] = [
    ("cubes", UVec3::splat(92), DVec3::ONE),
    (
        "0.7×0.7×2.5",
        UVec3::new(132, 132, 37),
        DVec3::new(0.7, 0.7, 2.5),
    ),
];

/// Depth and way per update, both in h.
const STROKES: [(f64, f64); 4] = [(2.0, 0.2), (5.0, 0.2), (2.0, 0.05), (5.0, 1.0)];

/// Where bodies stand: nowhere special among the voxels.
const CENTRE: DVec3 = DVec3::new(45.3, 45.1, 45.2);

/// Angles of planes about x and y [degrees], below and from 10 degrees of tilt on.
const FLAT: [[f64; 2]; 5] = [[0.0, 0.0], [5.0, 0.0], [0.0, 5.0], [2.0, 1.0], [5.0, 3.0]];
const TILTED: [[f64; 2]; 8] = [
    [10.0, 0.0],
    [0.0, 10.0],
    [15.0, 5.0],
    [20.0, 7.0],
    [30.0, 15.0],
    [45.0, 0.0],
    [0.0, 45.0],
    [45.0, 35.3],
];

/// Bodies of one kind, with the way of the device on each.
#[derive(Clone, Debug)]
pub struct Case {
    /// Its name, as in a report.
    pub name: String,
    /// What kind of body.
    pub body: &'static str,
    /// Which grid.
    pub grid_name: &'static str,
    /// Where the voxels stand.
    pub grid: Grid,
    /// Radius of the probe [h]; 0 is a point.
    pub radius: f64,
    /// How deep the device goes [h].
    pub depth: f64,
    /// Its way per update [h].
    pub step: f64,
    /// The bodies, and the device at each update.
    pub strokes: Vec<(Body, Vec<DVec3>)>,
}

/// All cases for a point, in the order of their report.
#[must_use]
pub fn cases() -> Vec<Case> {
    cases_where(0.0, |_| true)
}

/// The cases whose names are wanted, for a probe of a radius [h]: a ball's middle goes as deep
/// under the surface of the dilated body as a point under that of the body itself.
pub fn cases_where(radius: f64, wanted: impl Fn(&str) -> bool) -> Vec<Case> {
    let mut cases = Vec::new();
    for (grid_name, dimensions, spacing) in GRIDS {
        let grid = Grid::new(dimensions, spacing, spacing * 0.5, DMat3::IDENTITY)
            .expect("the grids above are valid");
        for (depth, step) in STROKES {
            let h = grid.smallest_spacing();
            let lead = Lead {
                depth: (depth - radius) * h,
                step: step * h,
                h,
                layer: spacing.z,
            };
            for (body, strokes) in BODIES {
                let name = format!("{body}, {grid_name}, {depth} h deep, {step} h a move");
                if wanted(&name) {
                    cases.push(Case {
                        name,
                        body,
                        grid_name,
                        grid,
                        depth,
                        step,
                        radius,
                        strokes: strokes(&lead),
                    });
                }
            }
        }
    }
    cases
}

type Strokes = Vec<(Body, Vec<DVec3>)>;

/// A body's name, and how a hand is led over it.
type Led = (&'static str, fn(&Lead) -> Strokes);

/// Bodies by name, and how the device is led on each.
const BODIES: [Led; 13] = [
    ("plane below 10°", |lead| lead.planes(&FLAT)),
    ("plane", |lead| lead.planes(&TILTED)),
    ("sphere", |lead| lead.one(ball(None), Lead::on_ball)),
    ("torus", |lead| lead.one(torus(), Lead::on_torus)),
    ("cylinder", |lead| lead.one(cylinder(), Lead::on_cylinder)),
    ("bore", |lead| lead.one(bore(), Lead::in_bore)),
    ("ramp", |lead| lead.one(ramp(), Lead::over_ramp)),
    ("step up", |lead| {
        lead.one(step_of(lead.layer), Lead::up_step)
    }),
    ("step down", |lead| {
        lead.one(step_of(lead.layer), Lead::down_step)
    }),
    ("wedge", |lead| lead.one(wedge(), Lead::over_wedge)),
    ("shell of 1", |lead| lead.one(ball(Some(1)), Lead::on_ball)),
    ("shell of 2", |lead| lead.one(ball(Some(2)), Lead::on_ball)),
    ("shell of 3", |lead| lead.one(ball(Some(3)), Lead::on_ball)),
];

// --- bodies -----------------------------------------------------------------------------

/// A turn along no axis of the voxels.
fn askew() -> DMat3 {
    DMat3::from_rotation_x(0.6) * DMat3::from_rotation_y(0.4)
}

fn body(shape: Shape, turn: DMat3) -> Body {
    Body {
        shape,
        turn,
        centre: CENTRE,
        shell: None,
    }
}

fn profile(points: &[[f64; 2]], turn: DMat3) -> Body {
    let points = points.iter().map(|&point| DVec2::from_array(point));
    body(Shape::Profile(points.collect()), turn)
}

fn plane([about_x, about_y]: [f64; 2]) -> Body {
    let turn =
        DMat3::from_rotation_x(about_x.to_radians()) * DMat3::from_rotation_y(about_y.to_radians());
    profile(&[[0.0, 0.0], [1.0, 0.0]], turn)
}

fn ball(shell: Option<i32>) -> Body {
    Body {
        shell,
        ..body(Shape::Ball { radius: 20.0 }, askew())
    }
}

fn torus() -> Body {
    let shape = Shape::Torus {
        ring: 24.0,
        tube: 9.0,
    };
    body(shape, askew())
}

fn cylinder() -> Body {
    body(Shape::Cylinder { radius: 12.0 }, askew())
}

fn bore() -> Body {
    body(Shape::Bore { radius: 12.0 }, askew())
}

/// 20 degrees up between two floors.
const RAMP: [f64; 2] = [16.0, 5.823];

fn ramp() -> Body {
    let [length, height] = RAMP;
    let points = [
        [-1.0 - length / 2.0, 0.0],
        [-length / 2.0, 0.0],
        [length / 2.0, height],
        [1.0 + length / 2.0, height],
    ];
    profile(&points, DMat3::from_rotation_z(0.3))
}

/// A floor that goes up by one layer of voxels, along an axis of theirs.
fn step_of(height: f64) -> Body {
    // from one border between layers to the next
    let floor = (CENTRE.z / height).floor() * height - CENTRE.z;
    let [low, high] = [floor, floor + height];
    profile(
        &[[-1.0, low], [0.0, low], [0.0, high], [1.0, high]],
        DMat3::IDENTITY,
    )
}

/// Two flanks of 40 degrees.
const FLANK: f64 = 40.0;

fn wedge() -> Body {
    let down = -FLANK.to_radians().tan();
    profile(
        &[[-1.0, down], [0.0, 0.0], [1.0, down]],
        DMat3::from_rotation_z(0.3),
    )
}

// --- ways of the device -----------------------------------------------------------------

/// How the device is led; lengths in mm.
struct Lead {
    /// Under the body's own surface; a ball's middle may stay above it.
    depth: f64,
    step: f64,
    h: f64,
    /// Height of a layer of voxels.
    layer: f64,
}

impl Lead {
    fn one(&self, body: Body, device: impl Fn(&Self, &Body) -> Vec<DVec3>) -> Strokes {
        let points = device(self, &body);
        vec![(body, points)]
    }

    fn planes(&self, angles: &[[f64; 2]]) -> Strokes {
        let planes = angles.iter().map(|&angles| plane(angles));
        planes
            .map(|plane| {
                let points = self.on_plane(&plane);
                (plane, points)
            })
            .collect()
    }

    fn walk(&self, body: &Body, curve: impl Fn(f64) -> DVec3) -> Vec<DVec3> {
        walk(|share| body.in_scene(curve(share)), self.step, UPDATES)
    }

    /// Three quarters of a circle that grows a little: all headings, no place twice.
    fn on_plane(&self, body: &Body) -> Vec<DVec3> {
        self.walk(body, |share| {
            let turn = 0.75 * TAU * share;
            let radius = 18.0 + 4.0 * share;
            DVec3::new(radius * turn.cos(), radius * turn.sin(), -self.depth)
        })
    }

    /// Around and up and down.
    fn on_ball(&self, body: &Body) -> Vec<DVec3> {
        self.walk(body, |share| {
            let turn = 5.0 * TAU * share;
            let height = 0.9 * (0.37 * turn).sin();
            let flat = DVec3::new(turn.cos(), turn.sin(), 0.0);
            (flat * height.cos() + DVec3::Z * height.sin()) * (20.0 - self.depth)
        })
    }

    /// Around the ring and around the tube.
    fn on_torus(&self, body: &Body) -> Vec<DVec3> {
        self.walk(body, |share| {
            let turn = 1.5 * TAU * share;
            let flat = DVec3::new(turn.cos(), turn.sin(), 0.0);
            let out = flat * (1.7 * turn).cos() + DVec3::Z * (1.7 * turn).sin();
            flat * 24.0 + out * (9.0 - self.depth)
        })
    }

    fn on_cylinder(&self, body: &Body) -> Vec<DVec3> {
        self.around_y(body, 12.0 - self.depth)
    }

    fn in_bore(&self, body: &Body) -> Vec<DVec3> {
        self.around_y(body, 12.0 + self.depth)
    }

    /// A screw around y.
    fn around_y(&self, body: &Body, radius: f64) -> Vec<DVec3> {
        self.walk(body, |share| {
            let turn = 4.0 * TAU * share;
            let along = 36.0 * (share - 0.5);
            DVec3::new(radius * turn.cos(), along, radius * turn.sin())
        })
    }

    /// Along the profile, some depth below each of its pieces, askew to its edges.
    fn under(&self, body: &Body, points: &[DVec2]) -> Vec<DVec3> {
        let count = (points.len() - 1).max(1) as f64;
        let points = points.iter().enumerate().map(|(number, point)| {
            let aside = 12.0 * (number as f64 / count - 0.5);
            DVec3::new(point.x, aside, point.y)
        });
        let curve = through(points.collect());
        self.walk(body, curve)
    }

    fn over_ramp(&self, body: &Body) -> Vec<DVec3> {
        let [length, height] = RAMP;
        let up = DVec2::new(length, height).normalize();
        let below = -self.depth * up.perp();
        // under the upper edge the device turns where both faces are as near
        let turn = self.depth * (1.0 - up.x) / up.y;
        let points = [
            DVec2::new(-length / 2.0 - 20.0, -self.depth),
            DVec2::new(-length / 2.0, -self.depth),
            DVec2::new(-length / 2.0, 0.0) + below,
            DVec2::new(length / 2.0 + turn, height - self.depth),
            DVec2::new(length / 2.0 + 20.0, height - self.depth),
        ];
        self.under(body, &points)
    }

    fn up_step(&self, body: &Body) -> Vec<DVec3> {
        self.along_step(body, 1.0)
    }

    fn down_step(&self, body: &Body) -> Vec<DVec3> {
        self.along_step(body, -1.0)
    }

    /// Straight, below the lower floor.
    fn along_step(&self, body: &Body, heading: f64) -> Vec<DVec3> {
        let floor = match &body.shape {
            Shape::Profile(points) => points[0].y,
            _ => 0.0,
        };
        let reach = 25.0 * self.h * heading;
        let level = floor - self.depth;
        self.under(body, &[DVec2::new(-reach, level), DVec2::new(reach, level)])
    }

    /// Under one flank and, from where the other is as near, under that.
    fn over_wedge(&self, body: &Body) -> Vec<DVec3> {
        let angle = FLANK.to_radians();
        let ridge = -self.depth / angle.cos();
        let reach = 25.0 * self.h;
        let foot = ridge - reach * angle.tan();
        let points = [
            DVec2::new(-reach, foot),
            DVec2::new(0.0, ridge),
            DVec2::new(reach, foot),
        ];
        self.under(body, &points)
    }
}
