//! Sets of segments.

use palpate_volume::edit::SegmentId;
use palpate_volume::segment_set::SegmentSet;

#[test]
fn a_set_holds_the_segments_put_into_it() {
    let ids = [0, 1, 63, 64, 127, 128, 255].map(SegmentId);
    let set: SegmentSet = ids.into_iter().collect();
    for id in (0..=255).map(SegmentId) {
        assert_eq!(set.contains(id), ids.contains(&id), "{id:?}");
        assert!(set.with(id).contains(id) && !set.without(id).contains(id));
    }
    assert!(ids.into_iter().fold(set, SegmentSet::without).is_empty());
}

#[test]
fn a_set_lists_its_segments_and_meets_another() {
    let ids = [1, 63, 64, 200, 255].map(SegmentId);
    let set: SegmentSet = ids.into_iter().collect();
    assert_eq!(set.ids().collect::<Vec<_>>(), ids);
    let other: SegmentSet = [2, 64, 255].map(SegmentId).into_iter().collect();
    let both: Vec<_> = set.intersect(&other).ids().collect();
    assert_eq!(both, [64, 255].map(SegmentId));
}
