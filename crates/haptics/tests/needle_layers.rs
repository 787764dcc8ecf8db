//! Needles through more layers and segments than anybody counts.

use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_haptics::needle::stretches::NeedleBody;
use palpate_haptics::needle::tissues::{Layered, Met, NeedleScan, TissueMap, Tissues, World};
use palpate_haptics::needle::track::{Line, Track};
use palpate_volume::grid::Grid;
use palpate_volume::tissue::{MAX_TISSUES, Tissue};

const SEGMENTS: i32 = 250;
const KINDS: [Tissue; 4] = [Tissue::SKIN, Tissue::FAT, Tissue::MUSCLE, Tissue::LIVER];

/// A segment to each plane of voxels, with bone behind the last.
struct Planes;

impl TissueMap for Planes {
    fn at(&self, _body: usize, voxel: IVec3, tissues: &Tissues) -> Met {
        if voxel.z < 0 {
            return Met::Nothing;
        }
        let segment = u8::try_from(voxel.z + 1).unwrap_or(u8::MAX);
        let place = tissues.place_of(segment);
        place.map_or(Met::Wall(segment), |place| Met::Tissue(Layered::of(place)))
    }

    fn body(&self, _number: usize) -> Option<NeedleBody<'_>> {
        None
    }

    fn is_open(&self) -> bool {
        false
    }
}

fn tissues() -> Tissues {
    Tissues::of((1..=SEGMENTS).map(|segment| (segment as u8, KINDS[segment as usize % 4])))
}

/// What lies on a line across all planes, after as many looks as a needle of that length has ticks.
fn seen_through(tissues: &Tissues) -> Track {
    let grid = Grid::new(
        UVec3::splat(300),
        DVec3::ONE,
        DVec3::splat(0.5),
        DMat3::IDENTITY,
    );
    let grid = grid.expect("a grid");
    let world = World {
        scan: NeedleScan {
            grid: &grid,
            map: &Planes,
        },
        tissues,
    };
    let line = Line {
        entry: DVec3::ZERO,
        direction: DVec3::Z,
    };
    let mut track = Track::default();
    for _ in 0..40 {
        track.look(&line, 400.0, &world);
    }
    track
}

#[test]
fn each_of_250_layers_holds_the_shaft_by_its_own_tissue_and_bone_ends_them() {
    let tissues = tissues();
    let track = seen_through(&tissues);
    let planes = f64::from(SEGMENTS);
    assert_eq!(track.wall(), Some((planes, SEGMENTS as u8 + 1)));
    for depth in [1.0_f64, 40.5, 100.0, 249.0] {
        let whole = depth as i32;
        let friction = |segment: i32| KINDS[segment as usize % 4].friction;
        let sum: f64 = (1..=whole).map(friction).sum();
        let sum = sum + depth.fract() * friction(whole + 1);
        let felt = track.along(depth, &tissues, |tissue| tissue.friction);
        assert!((felt - sum).abs() < 1e-9, "{depth}: {felt} N, {sum} N");
    }
    for segment in [1, 33, 65, 129, 250] {
        let place = track.place_at(f64::from(segment) - 0.5);
        let Met::Tissue(layer) = track.met(place) else {
            panic!("segment {segment} is no layer");
        };
        let top = tissues.top(layer).map(|(segment, _)| i32::from(segment));
        assert_eq!(top, Some(segment));
    }
}

#[test]
fn where_segments_overlap_the_last_of_all_counts() {
    let tissues = tissues();
    for last in [1_u8, 63, 64, 128, 249] {
        let layer = Layered::of(0).and(Layered::of(last));
        assert_eq!(
            tissues.top(layer).map(|(segment, _)| segment),
            Some(last + 1)
        );
        assert_eq!(tissues.segments_of(layer).count(), 2);
    }
    assert_eq!(tissues.top(Layered::default()), None);
}

#[test]
fn segments_of_more_tissues_than_are_told_apart_stay_hard() {
    let kind = |segment: u8| Tissue {
        puncture: 1.0 + f64::from(segment),
        ..Tissue::LIVER
    };
    let tissues = Tissues::of((1..=40).map(|segment| (segment, kind(segment))));
    assert_eq!(tissues.segments().count(), MAX_TISSUES);
    assert!(tissues.place_of(32).is_some() && tissues.place_of(33).is_none());
}
