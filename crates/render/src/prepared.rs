//! An appearance made ready for a scene: tables, segments, and which bricks are empty.

use glam::{DVec3, Vec4};
use palpate_volume::edit::SegmentId;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

use crate::appearance::{Appearance, Blend, Plane};
use crate::bricks::EmptySpace;
use crate::labels::Labels;
use crate::scene::Scene;
use crate::segments::{Segments, by_voxels};
use crate::transfer::Transfer;

/// All that many pictures of a scene have in common.
#[derive(Clone, Debug)]
pub struct Prepared {
    pub(crate) appearance: Appearance,
    pub(crate) transfer: Transfer,
    pub(crate) segments: Segments,
    pub(crate) empty: EmptySpace,
    /// The same with the bricks of segments that are drawn as surfaces; none where there are none.
    with_surfaces: Option<EmptySpace>,
    pub(crate) planes: Vec<Vec4>,
    /// Fraction of the window, or height over the iso-value, at a stored value: factor and term.
    pub(crate) grey: (f32, f32),
    pub(crate) tissue_from: f32,
}

impl Prepared {
    /// Makes an appearance ready.
    ///
    /// # Panics
    /// Where the transfer function has fewer than two points.
    #[must_use]
    pub fn new(scene: &Scene, appearance: Appearance) -> Self {
        assert!(
            appearance.transfer.len() >= 2,
            "a transfer function of fewer than two points"
        );
        let labels = Labels::of(scene.voxels(), &by_voxels(&appearance));
        Self::with_labels(scene, appearance, labels)
    }

    /// Shows the same scene in another way.
    pub(crate) fn show(&mut self, scene: &Scene, appearance: Appearance) {
        if self.appearance == appearance {
            return;
        }
        let asked = by_voxels(&appearance);
        let labels = if asked == by_voxels(&self.appearance) {
            self.segments.take_labels()
        } else {
            Labels::of(scene.voxels(), &asked)
        };
        *self = Self::with_labels(scene, appearance, labels);
    }

    /// Follows the scene to a later edit that changed voxels of a box.
    pub(crate) fn follow(&mut self, scene: &Scene, changed: &VoxelBox) {
        if changed.is_empty() {
            return;
        }
        let asked = by_voxels(&self.appearance);
        self.segments.renew(scene.voxels(), &asked, changed);
        // a brick's range tells of the voxels around it too
        let region = changed.dilate(1).intersect(&scene.grid().bounds());
        let Self {
            appearance,
            transfer,
            segments,
            grey,
            empty,
            with_surfaces,
            ..
        } = self;
        let drawn = Drawn {
            scene,
            appearance,
            transfer,
            segments,
            grey: *grey,
        };
        empty.renew(&region, |brick| drawn.is_in(brick));
        if let Some(space) = with_surfaces {
            let surfaces = surfaces_of(scene, appearance);
            space.renew(&region, |brick| {
                drawn.is_in(brick) || are_in(&surfaces, brick)
            });
        }
    }

    fn with_labels(scene: &Scene, appearance: Appearance, labels: Option<Labels>) -> Self {
        let scan = scene.voxels().intensities();
        let transfer = Transfer::new(&appearance.transfer, scan);
        let segments = Segments::new(&appearance, labels, scan);
        let grey = grey_of(&appearance, scan.slope(), scan.intercept());
        let window = appearance.window.0.max(1e-6);
        let tissue_from = (appearance.tissue_from - appearance.window.1) / window + 0.5;
        let drawn = Drawn {
            scene,
            appearance: &appearance,
            transfer: &transfer,
            segments: &segments,
            grey,
        };
        let counts = scene.ranges.counts;
        let empty = EmptySpace::new(counts, |brick| drawn.is_in(brick));
        let with_surfaces = (!appearance.surfaces.is_empty()).then(|| {
            let surfaces = surfaces_of(scene, &appearance);
            EmptySpace::new(counts, |brick| {
                drawn.is_in(brick) || are_in(&surfaces, brick)
            })
        });
        Self {
            planes: planes_in_grid(scene, &appearance.clip),
            with_surfaces,
            appearance,
            transfer,
            segments,
            empty,
            grey,
            tissue_from: tissue_from as f32,
        }
    }

    /// Where nothing is that keeps off light or is lit.
    pub(crate) fn unlit(&self) -> &EmptySpace {
        self.with_surfaces.as_ref().unwrap_or(&self.empty)
    }

    /// How the scan is drawn.
    #[must_use]
    pub fn appearance(&self) -> &Appearance {
        &self.appearance
    }
}

/// What tells whether anything is drawn in a brick.
struct Drawn<'a> {
    scene: &'a Scene,
    appearance: &'a Appearance,
    transfer: &'a Transfer,
    segments: &'a Segments,
    grey: (f32, f32),
}

impl Drawn<'_> {
    fn is_in(&self, brick: usize) -> bool {
        let (low, high) = self.scene.ranges.ranges[brick];
        let largest = |at: i16| f32::from(at) * self.grey.0 + self.grey.1;
        let blend = self.appearance.blend;
        let by_value = match blend {
            Blend::Mip => largest(low).max(largest(high)) > 0.0,
            Blend::Iso => largest(low).max(largest(high)) >= 0.0,
            Blend::MinIp | Blend::Average => true,
            _ => self.transfer.shows(low, high),
        };
        by_value
            || (blend.draws_solids() && self.segments.show(low, high))
            || self.segments.hold(brick)
    }
}

/// Segments on the scan's grid that are drawn as surfaces.
fn surfaces_of<'a>(scene: &'a Scene, appearance: &Appearance) -> Vec<&'a Segment> {
    let shown = appearance.surfaces.iter();
    shown
        .filter_map(|shown| scene.voxels().segment(SegmentId(shown.id)))
        .filter(|segment| segment.own_grid().is_none())
        .collect()
}

fn are_in(segments: &[&Segment], brick: usize) -> bool {
    let holds = |segment: &&Segment| segment.occupancy().bricks().get(brick as u32).is_some();
    segments.iter().any(holds)
}

fn grey_of(appearance: &Appearance, slope: f64, intercept: f64) -> (f32, f32) {
    let (factor, term) = if appearance.blend == Blend::Iso {
        (slope, intercept - appearance.iso_value)
    } else {
        let (window, level) = (appearance.window.0.max(1e-6), appearance.window.1);
        (slope / window, (intercept - level) / window + 0.5)
    };
    (factor as f32, term as f32)
}

/// Planes as four numbers over points of the grid: how far these lie before them [mm].
fn planes_in_grid(scene: &Scene, planes: &[Plane]) -> Vec<Vec4> {
    let to_patient = scene.grid().patient_from_grid();
    planes
        .iter()
        .map(|plane| {
            let normal: DVec3 = to_patient.matrix3.transpose() * plane.normal;
            let term = plane.normal.dot(to_patient.translation) - plane.offset;
            normal.extend(term).as_vec4()
        })
        .collect()
}
