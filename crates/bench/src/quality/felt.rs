//! What a hand feels: the one thing that the yardstick asks of a way of touch.

use std::sync::Arc;

use glam::DVec3;
use palpate_engine::scene::{Properties, Scene, Step};
use palpate_engine::touch::{Part, ScanValues, Threshold, Touchable};
use palpate_haptics::contact::{ContactModel, Exact, Proxy};
use palpate_haptics::force::Uniform;
use palpate_haptics::smooth::Smoothing;
use palpate_haptics::thesis::{ThesisImproved, ThesisOriginal};
use palpate_haptics::tick::{TickCache, TickInput, TickState, tick};
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::occupancy_fractions::OccupancyFractions;
use palpate_volume::relax::{self, relaxed_fractions};
use palpate_volume::segment::Segment;
use palpate_volume::voxels::Voxels;

use super::body::Body;
use super::solid::{FULL, Solid, THRESHOLD};

/// Stiffness that forces are given at [N/mm].
pub const STIFFNESS: f64 = 1.0;

/// What came of one update. Frame: scene [mm].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FeltForce {
    /// Force on the hand [N], before the safety stage.
    pub force: DVec3,
    /// The hard proxy.
    pub proxy: DVec3,
    /// The point that the spring pulls to; the proxy where nothing is smoothed.
    pub force_point: DVec3,
    /// Whether a solid voxel holds the proxy back.
    pub contact: bool,
}

/// One hand on one body: a device point of the scene in, what is felt out.
pub type ForceModel<'a> = Box<dyn FnMut(DVec3) -> FeltForce + 'a>;

/// A way of touch by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Touch {
    /// As the servo touches what a mask made: the force comes from the bits.
    Exact,
    /// As it touches what a threshold made: the force comes from the values.
    Intensities,
    /// The same where the threshold ends with the highest value of the scan, which all voxels inside
    /// have, as metal does.
    RangeEnd,
    /// With a ball of this radius [h].
    Ball(u8),
    /// The same as `exact` without smoothing: the force of the hard proxy.
    Stairs,
    /// Contact model `thesis-original`.
    ThesisOriginal,
    /// Contact model `thesis-improved`.
    ThesisImproved,
}

impl Touch {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Exact,
        Self::Intensities,
        Self::RangeEnd,
        Self::Ball(1),
        Self::Ball(2),
        Self::Ball(5),
        Self::Stairs,
        Self::ThesisOriginal,
        Self::ThesisImproved,
    ];

    /// Its name.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::Exact => "exact".into(),
            Self::Intensities => "exact, intensities".into(),
            Self::RangeEnd => "exact, range's end".into(),
            Self::Ball(radius) => format!("exact, r {radius}"),
            Self::Stairs => "stairs".into(),
            Self::ThesisOriginal => "thesis-original".into(),
            Self::ThesisImproved => "thesis-improved".into(),
        }
    }

    /// The one of this name, if there is one.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|touch| touch.name() == name)
    }

    /// Radius of the probe [h]; 0 is a point.
    #[must_use]
    pub fn radius(self) -> f64 {
        match self {
            Self::Ball(radius) => f64::from(radius),
            _ => 0.0,
        }
    }

    /// A body as this touch is given it.
    #[must_use]
    pub fn solid(self, body: &Body, grid: &Grid) -> Solid {
        match self {
            Self::Intensities | Self::RangeEnd => Solid::of_fractions(body, grid),
            _ => Solid::of_middles(body, grid),
        }
    }

    /// A hand that touches a solid in this way, from a free point of the scene on.
    #[must_use]
    pub fn start<'a>(self, solid: &Solid, grid: &'a Grid, start: DVec3) -> ForceModel<'a> {
        let fractions = match self {
            Self::Exact | Self::Ball(_) => Some(fractions_of(solid, grid)),
            _ => None,
        };
        let part = match self {
            Self::RangeEnd => part_of_scene(solid, grid),
            _ => part_of(solid, fractions),
        };
        let touched = Touchable::new(grid, vec![part], self.radius() * grid.smallest_spacing())
            .expect("a ball of some voxels fits");
        let exact = Exact {
            limits: touched.limits(),
        };
        match self {
            Self::Exact | Self::Ball(_) | Self::Intensities | Self::RangeEnd => {
                feel(exact, Smoothing::Intensities, touched, grid, start)
            }
            Self::Stairs => feel(exact, Smoothing::Off, touched, grid, start),
            Self::ThesisOriginal => {
                let model = ThesisOriginal::default();
                feel(model, Smoothing::Off, touched, grid, start)
            }
            Self::ThesisImproved => {
                let model = ThesisImproved::default();
                feel(model, Smoothing::Off, touched, grid, start)
            }
        }
    }
}

/// The occupancy fractions of a mask, as a session works them out.
fn fractions_of(solid: &Solid, grid: &Grid) -> Arc<OccupancyFractions> {
    let mut fractions = OccupancyFractions::unknown(grid.dimensions());
    for region in relax::regions(&solid.bits) {
        for mut swap in relaxed_fractions(
            &solid.bits,
            grid.spacing().as_vec3(),
            &region,
            &OccupancyFractions::unknown(grid.dimensions()),
        ) {
            fractions.swap(&mut swap);
        }
    }
    Arc::new(fractions)
}

fn part_of(solid: &Solid, fractions: Option<Arc<OccupancyFractions>>) -> Part {
    let made_from = |values| Threshold {
        range: (THRESHOLD, f64::INFINITY),
        values: ScanValues::of(values),
    };
    Part {
        id: SegmentId(1),
        bits: solid.bits.clone(),
        moved: None,
        threshold: solid.values.as_ref().map(made_from),
        fractions,
        punctured: false,
        rigid: None,
    }
}

/// What a session makes of a threshold that ends with the highest value.
fn part_of_scene(solid: &Solid, grid: &Grid) -> Part {
    let values = solid.values.clone().expect("values of a threshold");
    let voxels = Voxels::new(*grid, values).expect("values on their grid");
    let mut scene = Scene::new(voxels);
    let range = (THRESHOLD, FULL);
    let insert = Step::Insert {
        id: SegmentId(1),
        segment: Segment::from_bits(solid.bits.clone()),
        properties: Box::new(Properties::of_threshold(true, Some(range))),
    };
    scene.perform(insert).expect("a segment of this scan");
    let mut parts = scene.touchable_parts();
    parts.pop().expect("the segment can be touched")
}

/// A spring without damper between the hand and the proxy of a contact model.
fn feel<'a, M: ContactModel + 'a>(
    model: M,
    smoothing: Smoothing,
    touched: Touchable,
    grid: &'a Grid,
    start: DVec3,
) -> ForceModel<'a> {
    let start = grid.grid_from_patient().transform_point3(start);
    let mut state = TickState::new(Proxy::at(start).expect("a hand starts beside the body"));
    let mut cache = TickCache::default();
    Box::new(move |device| {
        let scene = touched.scene(grid);
        let input = TickInput {
            device_in_scene: device,
            velocity_in_scene: DVec3::ZERO,
            damping: 0.0,
            smoothing,
        };
        let surface = Uniform::smooth(STIFFNESS);
        let output = tick(&scene, &model, &surface, &input, &mut state, &mut cache);
        FeltForce {
            force: output.force,
            proxy: output.proxy_in_scene,
            force_point: output.contact_point_in_scene,
            contact: output.contact,
        }
    })
}
