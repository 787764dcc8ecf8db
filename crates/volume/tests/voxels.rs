//! Edits against a dense model, their inverses and dirty boxes.

use std::collections::BTreeMap;

use crate::support::{Random, box_where};
use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_volume::edit::{Edit, EditKind, SegmentId};
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::segment_set::SegmentSet;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxel_state::VoxelState;
use palpate_volume::voxels::{Voxels, VoxelsError};

const DIMENSIONS: UVec3 = UVec3::new(25, 18, 33);
const AIR: i16 = -1000;

/// Everything a person could see, voxel by voxel.
#[derive(Clone, Debug, PartialEq)]
struct Dense {
    stored: Vec<i16>,
    masks: BTreeMap<SegmentId, Vec<u8>>,
}

impl Dense {
    fn of(voxels: &Voxels) -> Self {
        let all = VoxelBox::of_dimensions(DIMENSIONS).voxels();
        Self {
            stored: all
                .map(|voxel| voxels.stored(voxel).expect("inside"))
                .collect(),
            masks: voxels
                .segments()
                .map(|(id, segment)| (id, segment.mask()))
                .collect(),
        }
    }

    fn changed(&self, other: &Self, grid: &Grid) -> VoxelBox {
        box_where(DIMENSIONS, |voxel| {
            let place = grid.index(voxel);
            let mut masks = self.masks.iter().zip(&other.masks);
            self.stored[place] != other.stored[place]
                || masks.any(|((_, ours), (_, theirs))| ours[place] != theirs[place])
        })
    }
}

fn grid() -> Grid {
    Grid::new(DIMENSIONS, DVec3::ONE, DVec3::ZERO, DMat3::IDENTITY).expect("a plain scan")
}

/// A scan of noise with three overlapping segments.
fn voxels(random: &mut Random) -> Voxels {
    let values: Vec<i16> = (0..grid().voxel_count())
        .map(|_| random.integer(-100, 900) as i16)
        .collect();
    let intensities = Intensities::new(DIMENSIONS, values, 2.0, -5.0).expect("one per voxel");
    let mut voxels = Voxels::new(grid(), intensities).expect("one grid");
    for _ in 0..3 {
        let mask = random.mask(DIMENSIONS);
        let segment = Segment::from_mask(DIMENSIONS, &mask).expect("one per voxel");
        voxels.add_segment(segment).expect("few segments");
    }
    voxels
}

/// An edit of one of the kinds that tools make, in a box or a ball.
fn random_edit(voxels: &Voxels, random: &mut Random) -> Edit {
    let (region, reach) = (random.voxel_box(DIMENSIONS), random.number(1.0, 20.0));
    let centre = random.voxel(0, 18).as_dvec3();
    let near = move |voxel: IVec3| voxel.as_dvec3().distance(centre) < reach;
    let id = SegmentId(random.integer(1, 4) as u8);
    let drilled = VoxelState {
        stored: AIR,
        segments: SegmentSet::EMPTY,
    };
    match random.integer(0, 4) {
        0 => voxels.label_edit(id, &region, |_, _| true),
        1 => voxels.label_edit(id, &region, |voxel, was| was && !near(voxel)),
        2 => Ok(voxels.voxel_edit(
            &region,
            |voxel, was| if near(voxel) { drilled } else { was },
        )),
        _ => Ok(voxels.voxel_edit(&region, |voxel, was| VoxelState {
            stored: was.stored.wrapping_add(voxel.x as i16),
            segments: if near(voxel) {
                was.segments.with(id)
            } else {
                was.segments
            },
        })),
    }
    .expect("the segment exists")
}

#[test]
fn a_label_edit_sets_what_it_says_and_never_touches_intensities() {
    let mut random = Random::new(121);
    for _ in 0..20 {
        let mut voxels = voxels(&mut random);
        let (before, region) = (Dense::of(&voxels), random.voxel_box(DIMENSIONS));
        let id = SegmentId(2);
        let flipped = |voxel: IVec3, was: bool| was != (voxel.element_sum() % 3 == 0);
        let edit = voxels.label_edit(id, &region, flipped).expect("it exists");
        assert_eq!((edit.kind, edit.intensities.len()), (EditKind::Label, 0));
        assert_eq!(
            Dense::of(&voxels),
            before,
            "building an edit changes nothing"
        );

        voxels.apply(edit).expect("it fits");
        let mut expected = before;
        for voxel in region.intersect(&grid().bounds()).voxels() {
            let solid = &mut expected.masks.get_mut(&id).expect("it exists")[grid().index(voxel)];
            *solid = u8::from(flipped(voxel, *solid != 0));
        }
        assert_eq!(Dense::of(&voxels), expected);
        assert!(voxels.overlay().bricks().is_empty());
    }
}

#[test]
fn a_label_edit_of_several_segments_is_their_single_edits_in_turn() {
    let mut random = Random::new(29);
    for _ in 0..40 {
        let mut together = voxels(&mut random);
        let mut in_turn = together.clone();
        // boxes that overlap, reach beyond the grid or are empty; a number given twice
        let boxes: Vec<_> = (0..3).map(|_| random.voxel_box(DIMENSIONS)).collect();
        let inside = |voxel| boxes.iter().any(|region| region.contains(voxel));
        let ids: Vec<_> = together.segments().map(|(id, _)| id).collect();
        let given: Vec<_> = ids.iter().chain(&ids).copied().collect();
        let solid = |id: SegmentId, voxel: IVec3, was: bool| {
            if inside(voxel) {
                (voxel.x + i32::from(id.0)) % 2 == 0
            } else {
                was
            }
        };

        let edit = together
            .label_edit_of(&given, &boxes, solid)
            .expect("they exist");
        let before = Dense::of(&together);
        let dirty = edit.dirty;
        let inverse = together.apply(edit).expect("it fits");
        for id in ids {
            let all = grid().bounds();
            let edit = in_turn.label_edit(id, &all, |voxel, was| solid(id, voxel, was));
            in_turn.apply(edit.expect("it exists")).expect("it fits");
        }

        let after = Dense::of(&together);
        assert_eq!(after, Dense::of(&in_turn));
        assert_eq!(dirty, before.changed(&after, &grid()));
        together.apply(inverse).expect("it fits");
        assert_eq!(Dense::of(&together), before);
    }
}

#[test]
fn a_drilled_voxel_is_air_and_belongs_to_no_segment() {
    let mut random = Random::new(122);
    for _ in 0..20 {
        let mut voxels = voxels(&mut random);
        let scan = voxels.intensities().clone();
        let (before, region) = (Dense::of(&voxels), random.voxel_box(DIMENSIONS));
        let edit = voxels.voxel_edit(&region, |_, _| VoxelState {
            stored: AIR,
            segments: SegmentSet::EMPTY,
        });
        assert_eq!(edit.kind, EditKind::Voxel);
        let undo = voxels.apply(edit).expect("it fits");

        let mut expected = before.clone();
        for voxel in region.intersect(&grid().bounds()).voxels() {
            let place = grid().index(voxel);
            expected.stored[place] = AIR;
            for mask in expected.masks.values_mut() {
                mask[place] = 0;
            }
        }
        assert_eq!(Dense::of(&voxels), expected);
        assert!(std::sync::Arc::ptr_eq(
            scan.values(),
            voxels.intensities().values()
        ));

        voxels.apply(undo).expect("it fits");
        assert_eq!(Dense::of(&voxels), before);
        assert!(voxels.overlay().bricks().is_empty());
    }
}

#[test]
fn matter_moved_takes_its_segments_along() {
    let mut random = Random::new(123);
    let mut voxels = voxels(&mut random);
    let before = voxels.clone();
    let region = grid().bounds();
    let source = |voxel: IVec3| IVec3::new(DIMENSIONS.x as i32 - 1 - voxel.x, voxel.y, voxel.z);
    let edit = voxels.voxel_edit(&region, |voxel, _| VoxelState {
        stored: before.stored(source(voxel)).expect("inside"),
        segments: before
            .segments()
            .filter(|(_, segment)| segment.contains(source(voxel)))
            .map(|(id, _)| id)
            .collect(),
    });
    voxels.apply(edit).expect("it fits");
    for voxel in region.voxels() {
        assert_eq!(voxels.stored(voxel), before.stored(source(voxel)));
        for ((_, now), (_, was)) in voxels.segments().zip(before.segments()) {
            assert_eq!(now.contains(voxel), was.contains(source(voxel)));
        }
    }
}

#[test]
fn inverses_in_turn_restore_every_state_bit_for_bit() {
    let mut random = Random::new(124);
    for _ in 0..10 {
        let mut voxels = voxels(&mut random);
        let (mut states, mut undo) = (Vec::new(), Vec::new());
        for _ in 0..12 {
            states.push(Dense::of(&voxels));
            let edit = random_edit(&voxels, &mut random);
            undo.push(voxels.apply(edit).expect("it fits"));
        }
        let last = Dense::of(&voxels);

        let mut redo = Vec::new();
        for (state, inverse) in states.iter().zip(undo).rev() {
            redo.push(voxels.apply(inverse).expect("it fits"));
            assert_eq!(Dense::of(&voxels), *state);
        }
        for edit in redo.into_iter().rev() {
            voxels.apply(edit).expect("it fits");
        }
        assert_eq!(Dense::of(&voxels), last);
    }
}

#[test]
fn a_dirty_box_is_the_smallest_of_all_changed_voxels() {
    let mut random = Random::new(125);
    let mut voxels = voxels(&mut random);
    let mut empty = 0;
    for _ in 0..80 {
        let (before, edit) = (Dense::of(&voxels), random_edit(&voxels, &mut random));
        let (dirty, kind) = (edit.dirty, edit.kind);
        let inverse = voxels.apply(edit).expect("it fits");
        let changed = Dense::of(&voxels).changed(&before, voxels.grid());
        assert_eq!(dirty, changed, "{kind:?}");
        assert_eq!(inverse.dirty, dirty);
        empty += usize::from(dirty.is_empty());
    }
    assert!(
        empty < 40,
        "{empty} edits changed nothing: the test is idle"
    );
}

#[test]
fn count_and_bounding_box_follow_edits() {
    let mut random = Random::new(126);
    let mut voxels = voxels(&mut random);
    for _ in 0..80 {
        let edit = random_edit(&voxels, &mut random);
        voxels.apply(edit).expect("it fits");
        for (_, segment) in voxels.segments() {
            let solid = segment.mask().iter().filter(|&&value| value != 0).count();
            assert_eq!(segment.count(), solid as u64);
            let around = box_where(DIMENSIONS, |voxel| segment.contains(voxel));
            assert_eq!(segment.bounding_box().unwrap_or_default(), around);
        }
    }
}

/// The servo's copy: it gets the new bricks of an edit and swaps them on its own.
#[test]
fn a_copy_of_the_bits_follows_by_swaps_alone() {
    let mut random = Random::new(127);
    let mut voxels = voxels(&mut random);
    let id = SegmentId(1);
    let mut copy = voxels.segment(id).expect("it exists").occupancy().clone();
    for _ in 0..40 {
        let edit = random_edit(&voxels, &mut random);
        let mut for_servo = edit.clone();
        voxels.apply(edit).expect("it fits");
        let ours = for_servo.segments.iter_mut().filter(|(of, _)| *of == id);
        for swap in ours.flat_map(|(_, swaps)| swaps) {
            copy.swap(swap);
        }
        let segment = voxels.segment(id).expect("it exists");
        assert!(copy.difference(segment.occupancy()).is_empty());
    }
}

/// As many bricks as make an edit parallel.
#[test]
fn a_large_edit_is_that_of_its_voxels() {
    let dimensions = UVec3::splat(80);
    let grid = Grid::new(dimensions, DVec3::ONE, DVec3::ZERO, DMat3::IDENTITY).expect("a scan");
    let scan = Intensities::new(dimensions, vec![0; grid.voxel_count()], 1.0, 0.0);
    let mut voxels = Voxels::new(grid, scan.expect("one per voxel")).expect("one grid");
    let id = voxels
        .add_segment(Segment::empty(dimensions))
        .expect("the first");
    let stripes = |voxel: IVec3| voxel.x % 5 == 0;
    let edit = voxels.label_edit(id, &grid.bounds(), |voxel, _| stripes(voxel));
    let dirty = VoxelBox::new(IVec3::ZERO, IVec3::new(76, 80, 80));
    let edit = edit.expect("it exists");
    assert_eq!(edit.dirty, dirty);
    voxels.apply(edit).expect("it fits");
    let segment = voxels.segment(id).expect("it exists");
    assert_eq!(segment.count(), 16 * 80 * 80);
    assert!(
        grid.bounds()
            .voxels()
            .all(|voxel| segment.contains(voxel) == stripes(voxel))
    );
}

#[test]
fn a_threshold_sees_what_edits_made_of_the_scan() {
    let mut random = Random::new(128);
    let mut voxels = voxels(&mut random);
    let hole = VoxelBox::new(IVec3::splat(3), IVec3::splat(14));
    let edit = voxels.voxel_edit(&hole, |_, was| VoxelState { stored: AIR, ..was });
    voxels.apply(edit).expect("it fits");
    let bone = voxels.threshold(500.0, f64::INFINITY);
    for voxel in voxels.grid().bounds().voxels() {
        let value = voxels.value(voxel).expect("inside");
        assert_eq!(bone.contains(voxel), value >= 500.0, "{voxel}");
    }
    assert!(hole.voxels().all(|voxel| !bone.contains(voxel)));
}

#[test]
fn a_removal_leaves_air_in_its_mask_and_nothing_else_changes() {
    let mut random = Random::new(131);
    for _ in 0..10 {
        let mut voxels = voxels(&mut random);
        let (before, mask) = (
            Dense::of(&voxels),
            Segment::from_mask(DIMENSIONS, &random.mask(DIMENSIONS)).expect("a mask"),
        );
        let undo = voxels
            .apply(voxels.removal(&mask, AIR).expect("one grid"))
            .expect("it fits");
        let after = Dense::of(&voxels);
        for voxel in grid().bounds().voxels() {
            let place = grid().index(voxel);
            let is_gone = mask.contains(voxel);
            let stored = if is_gone { AIR } else { before.stored[place] };
            assert_eq!(after.stored[place], stored, "{voxel}");
            for (id, was) in &before.masks {
                let is_in = was[place] != 0 && !is_gone;
                assert_eq!(after.masks[id][place] != 0, is_in, "{voxel}");
            }
        }
        voxels.apply(undo).expect("it fits");
        assert_eq!(Dense::of(&voxels), before);
    }
    let other = Segment::empty(UVec3::splat(4));
    assert!(matches!(
        voxels(&mut random).removal(&other, AIR),
        Err(VoxelsError::Dimensions { .. })
    ));
}

#[test]
fn a_threshold_of_the_scan_is_brought_to_what_edits_made_of_it() {
    let mut random = Random::new(132);
    let mut voxels = voxels(&mut random);
    let scan = voxels.intensities().clone();
    let [one, other] = [650, 750].map(|stored| scan.physical(stored));
    let (low, high) = (one.min(other), one.max(other));
    let of_scan = voxels.threshold(low, high);
    let hole = VoxelBox::new(IVec3::splat(3), IVec3::splat(14));
    let edit = voxels.voxel_edit(&hole, |voxel, was| VoxelState {
        stored: if voxel.x % 2 == 0 { AIR } else { 700 },
        ..was
    });
    voxels.apply(edit).expect("it fits");
    let now = voxels.as_edited(&of_scan, low, high).expect("one grid");
    assert_eq!(now.mask(), voxels.threshold(low, high).mask());
    assert_ne!(now.mask(), of_scan.mask());
    // what is not edited stays as it was made
    let empty = Segment::empty(DIMENSIONS);
    let only = voxels.as_edited(&empty, low, high).expect("one grid");
    assert!(only.count() > 0);
    assert!(only.bounding_box().expect("some").min.cmpge(hole.min).all());
}

#[test]
fn segments_take_the_lowest_free_number_and_every_change_is_numbered() {
    let mut random = Random::new(129);
    let mut voxels = voxels(&mut random);
    let ids: Vec<_> = voxels.segments().map(|(id, _)| id.0).collect();
    assert_eq!((ids, voxels.edit_number()), (vec![1, 2, 3], 3));

    let removed = voxels.remove_segment(SegmentId(2)).expect("it exists");
    assert_eq!(voxels.segment(SegmentId(2)).map(Segment::count), None);
    assert_eq!(voxels.add_segment(removed), Ok(SegmentId(2)));

    let old = voxels.segment(SegmentId(3)).expect("it exists").clone();
    let returned = voxels.replace_segment(SegmentId(3), Segment::empty(DIMENSIONS));
    assert_eq!(returned.expect("it exists").mask(), old.mask());
    assert_eq!(voxels.segment(SegmentId(3)).map(Segment::count), Some(0));
    assert_eq!(voxels.edit_number(), 6);
}

#[test]
fn a_256th_segment_is_refused() {
    let mut voxels = voxels(&mut Random::new(130));
    for id in 4..=255 {
        let added = voxels.add_segment(Segment::empty(DIMENSIONS));
        assert_eq!(added, Ok(SegmentId(id)));
    }
    let error = voxels.add_segment(Segment::empty(DIMENSIONS));
    assert_eq!(error, Err(VoxelsError::TooManySegments));
}

#[test]
fn what_does_not_fit_is_refused_and_changes_nothing() {
    let mut random = Random::new(131);
    let mut voxels = voxels(&mut random);
    let (before, number) = (Dense::of(&voxels), voxels.edit_number());
    let missing = SegmentId(9);
    let unknown = VoxelsError::UnknownSegment(9);
    let other = Segment::empty(UVec3::splat(8));

    assert_eq!(voxels.remove_segment(missing).map(|_| ()), Err(unknown));
    let label = voxels.label_edit(missing, &grid().bounds(), |_, _| true);
    assert_eq!(label.map(|_| ()), Err(unknown));
    assert!(matches!(
        voxels.add_segment(other),
        Err(VoxelsError::Dimensions { .. })
    ));

    let all = grid().bounds();
    let mut edit = voxels
        .label_edit(SegmentId(1), &all, |_, was| !was)
        .expect("it exists");
    let mut far = edit.clone();
    edit.segments[0].0 = missing;
    assert_eq!(voxels.apply(edit).map(|_| ()), Err(unknown));
    far.segments[0].1[3].index = 1_000_000;
    let error = voxels
        .apply(far)
        .map(|_| ())
        .expect_err("beyond the directory");
    assert!(
        error
            .to_string()
            .starts_with("brick 1000000 given; allowed: below"),
        "{error}"
    );

    assert_eq!((Dense::of(&voxels), voxels.edit_number()), (before, number));
}

#[test]
fn intensities_of_another_grid_are_refused() {
    let scan = Intensities::new(UVec3::splat(2), vec![0; 8], 1.0, 0.0).expect("one per voxel");
    let error = Voxels::new(grid(), scan)
        .map(|_| ())
        .expect_err("another grid");
    assert_eq!(
        error.to_string(),
        "dimensions [2, 2, 2] given; allowed: those of the scan, [25, 18, 33]"
    );
}
