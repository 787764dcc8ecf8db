//! What a hand feels: the one thing that the yardstick asks of a way of touch.

use glam::DVec3;
use palpate_haptics::contact::ContactModel;
use palpate_haptics::exact::Exact;
use palpate_haptics::proxy::Proxy;
use palpate_haptics::scene::TouchScene;
use palpate_haptics::smooth::Smoothing;
use palpate_haptics::surface::Uniform;
use palpate_haptics::thesis_improved::ThesisImproved;
use palpate_haptics::thesis_original::ThesisOriginal;
use palpate_haptics::tick::{TickCache, TickInput, TickState, tick};
use palpate_volume::bits::Bits;
use palpate_volume::grid::Grid;

/// Stiffness that forces are given at [N/mm].
pub const STIFFNESS: f64 = 1.0;

/// What came of one update. Frame: scene [mm].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Felt {
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
pub type Feel<'a> = Box<dyn FnMut(DVec3) -> Felt + 'a>;

/// A way of touch by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Touch {
    /// As the servo touches.
    Exact,
    /// The same without smoothing: the force of the hard proxy.
    Stairs,
    /// Contact model `thesis-original`.
    ThesisOriginal,
    /// Contact model `thesis-improved`.
    ThesisImproved,
}

impl Touch {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::Exact,
        Self::Stairs,
        Self::ThesisOriginal,
        Self::ThesisImproved,
    ];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Stairs => "stairs",
            Self::ThesisOriginal => "thesis-original",
            Self::ThesisImproved => "thesis-improved",
        }
    }

    /// The one of this name, if there is one.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|touch| touch.name() == name)
    }

    /// A hand that touches a solid in this way, from a free point of the scene on.
    #[must_use]
    pub fn start<'a>(self, solid: &'a Bits, grid: &'a Grid, start: DVec3) -> Feel<'a> {
        match self {
            Self::Exact => feel(Exact::default(), Smoothing::Bits, solid, grid, start),
            Self::Stairs => feel(Exact::default(), Smoothing::Off, solid, grid, start),
            Self::ThesisOriginal => feel(
                ThesisOriginal::default(),
                Smoothing::Off,
                solid,
                grid,
                start,
            ),
            Self::ThesisImproved => feel(
                ThesisImproved::default(),
                Smoothing::Off,
                solid,
                grid,
                start,
            ),
        }
    }
}

/// A spring without damper between the hand and the proxy of a contact model.
fn feel<'a, M: ContactModel + 'a>(
    model: M,
    smoothing: Smoothing,
    solid: &'a Bits,
    grid: &'a Grid,
    start: DVec3,
) -> Feel<'a> {
    let scene = TouchScene::of_world(solid, grid);
    let start = grid.grid_from_patient().transform_point3(start);
    let mut state = TickState::new(Proxy::at(start).expect("a hand starts beside the body"));
    let mut cache = TickCache::default();
    Box::new(move |device| {
        let input = TickInput {
            device_in_scene: device,
            velocity_in_scene: DVec3::ZERO,
            damping: 0.0,
            smoothing,
        };
        let surface = Uniform::smooth(STIFFNESS);
        let output = tick(&scene, &model, &surface, &input, &mut state, &mut cache);
        Felt {
            force: output.force,
            proxy: output.proxy_in_scene,
            force_point: output.contact_point_in_scene,
            contact: output.contact,
        }
    })
}
