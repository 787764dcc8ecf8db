//! What an answer of the thesis' global prototype costs, by counts: a ball in a body whose
//! particles take tens of thousands of voxels along.

use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_deform::material::{Materials, SegmentMaterial, preset};
use palpate_deform::model::{Budget, ModelAnswer};
use palpate_deform::particles::{GlobalModel, GlobalSettings};
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;

use crate::model_support::answer_to_ball;

/// Voxels of the scan along each axis, and the face of the tissue in it.
const SIZE: UVec3 = UVec3::new(120, 110, 84);
const TOP: i32 = 68;
/// Of the ball [voxels].
const RADIUS: f64 = 16.0;
const ITERATIONS: u32 = 40;
/// Voxels that an answer looks at and works out anew, and nodes that it tells, at most.
const LOOKED_AT: u64 = 32 * 4096;
const FOLLOWED: u64 = 6_000 + 4_096;
const REPORTED: usize = 28 * 28 * 28;
/// Voxels along each edge of what an answer changes, at most.
const CHANGED: u32 = 48;

struct Scan {
    voxels: Voxels,
    materials: Materials,
    model: GlobalModel,
}

impl Scan {
    /// A block of liver, the particles some 14 voxels apart.
    fn new() -> Self {
        let grid = Grid::new(SIZE, DVec3::ONE, DVec3::splat(0.5), DMat3::IDENTITY);
        let values = (0..SIZE.element_product()).map(|i| (i % 37) as i16);
        let intensities = Intensities::new(SIZE, values.collect::<Vec<i16>>(), 1.0, 0.0);
        let mut voxels = Voxels::new(grid.expect("a grid"), intensities.expect("all values"))
            .expect("the same grid");
        let end = SIZE.as_ivec3() - 4;
        let solid = |v: IVec3| v.min_element() >= 4 && v.x < end.x && v.y < end.y && v.z < TOP;
        let segment = voxels
            .add_segment(Segment::from_fn(SIZE, solid))
            .expect("its grid");
        let law = preset("liver").and_then(|preset| preset.law());
        let matter = SegmentMaterial {
            segment,
            law: law.expect("liver is a preset"),
            regions: Vec::new(),
        };
        Self {
            voxels,
            materials: Materials {
                segments: vec![matter],
            },
            model: GlobalModel::global_lj(GlobalSettings {
                max_particles: 400,
                ..GlobalSettings::default()
            }),
        }
    }

    /// An answer to the ball's lowest point so deep below the face, its work held to what is
    /// promised; its edit is applied.
    fn answer(&mut self, along: f64, depth: f64) -> ModelAnswer {
        let place = DVec3::new(along, 55.0, f64::from(TOP) + RADIUS - depth);
        let (model, budget) = (&mut self.model, Budget::iterations(ITERATIONS));
        let ball = (place, RADIUS);
        let answer = answer_to_ball(model, &mut self.voxels, &self.materials, ball, budget);
        let effort = answer.report.effort;
        assert!(effort.looked_at <= LOOKED_AT, "{effort:?}");
        assert!(effort.followed <= FOLLOWED, "{effort:?}");
        assert!(effort.evaluations <= u64::from(ITERATIONS) + 1);
        let told = answer.displacement.as_ref();
        assert!(told.is_none_or(|field| field.moved.len() <= REPORTED));
        let changed = answer.edit.as_ref().map(|edit| edit.dirty.size());
        assert!(
            changed.is_none_or(|size| size.max_element() <= CHANGED),
            "{changed:?}"
        );
        answer
    }

    fn look(voxels: &Voxels, voxel: IVec3) -> (Option<i16>, bool) {
        let mut segments = voxels.segments();
        let is_solid = segments.any(|(_, segment)| segment.contains(voxel));
        (voxels.stored(voxel), is_solid)
    }

    /// A box around all voxels that are not as they were.
    fn changed_since(&self, then: &Voxels) -> VoxelBox {
        let bounds = VoxelBox::of_dimensions(SIZE).voxels();
        let differ = bounds.filter(|v| Self::look(&self.voxels, *v) != Self::look(then, *v));
        differ.fold(VoxelBox::EMPTY, |all, voxel| {
            all.union(&VoxelBox::of_voxel(voxel))
        })
    }
}

#[test]
fn an_answer_takes_the_same_work_however_much_moves_and_the_rest_follows() {
    let mut scan = Scan::new();
    let untouched = scan.voxels.clone();
    // in, and along
    let mut busy = 0;
    for step in 0..24 {
        let along = 50.0 + f64::from(step.max(12) - 12);
        let answer = scan.answer(along, f64::from(step.min(12)));
        busy += u32::from(answer.report.effort.followed >= 6_000);
    }
    assert!(busy >= 3, "{busy} answers had all work that they may do");
    // it stays: what was left over follows, and then nothing is left
    let mut followed = u64::MAX;
    let mut moved = 0;
    for _ in 0..60 {
        let report = scan.answer(61.0, 12.0).report;
        (followed, moved) = (report.effort.followed, report.moved_voxels);
    }
    println!("{busy} busy answers, {moved} voxels moved, {followed} worked out in the last");
    assert!(moved > 30_000, "{moved} voxels moved");
    assert!(followed < 500, "{followed} voxels are still worked out");
    let dent = scan.changed_since(&untouched);
    assert!(dent.size().min_element() > CHANGED / 2, "{dent:?}");
    // it leaves: all comes back to the bit
    let mut answers = 0;
    while moved > 0 && answers < 200 {
        moved = scan.answer(61.0, -30.0).report.moved_voxels;
        answers += 1;
    }
    assert_eq!(moved, 0, "left after {answers} answers");
    assert!(scan.changed_since(&untouched).is_empty());
}

#[test]
fn what_somebody_else_changes_while_voxels_follow_counts() {
    let mut scan = Scan::new();
    for step in 0..12 {
        scan.answer(50.0, f64::from(step));
    }
    // a hole below the ball, in tissue that has moved
    let hole = VoxelBox::new(IVec3::new(46, 51, 44), IVec3::new(54, 59, 52));
    let cut = scan.voxels.voxel_edit(&hole, |_, mut matter| {
        (matter.stored, matter.segments) = (-1000, Default::default());
        matter
    });
    scan.voxels.apply(cut).expect("of these voxels");
    let untouched = scan.voxels.clone();
    let mut moved = 1;
    let mut answers = 0;
    while moved > 0 && answers < 200 {
        moved = scan.answer(50.0, -30.0).report.moved_voxels;
        answers += 1;
    }
    assert_eq!(moved, 0, "left after {answers} answers");
    let mut inside = hole.voxels();
    assert!(inside.all(|v| Scan::look(&scan.voxels, v) == Scan::look(&untouched, v)));
    // tissue that had moved away from there is back around it
    let beside = IVec3::new(50, 55, 60);
    assert!(Scan::look(&scan.voxels, beside).1);
}
