//! What a line meets in several grids at once, compared with looking at points of it.

use glam::{DAffine3, DMat3, DVec3, IVec3, UVec3};
use palpate_haptics::needle::stretches::{NeedleBody, Stretch, Stretches, finest, met_at};
use palpate_haptics::needle::tissues::{Layered, Met, NeedleScan, TissueMap, Tissues, World};
use palpate_volume::grid::Grid;
use palpate_volume::tissue::Tissue;

/// A chequered scan and chequered bodies in it, each with voxels of its own size.
struct Chequers {
    poses: Vec<DAffine3>,
    wall: bool,
}

impl TissueMap for Chequers {
    fn at(&self, body: usize, voxel: IVec3, _tissues: &Tissues) -> Met {
        let sum = voxel.x + voxel.y + 2 * voxel.z;
        match sum.rem_euclid(3) {
            0 => Met::Nothing,
            1 if self.wall && body == 1 => Met::Wall(9),
            _ => Met::Tissue(Layered::of(body as u8)),
        }
    }

    fn body(&self, number: usize) -> Option<NeedleBody<'_>> {
        Some(NeedleBody {
            body_from_scan: self.poses.get(number - 1)?,
            low: DVec3::NEG_INFINITY,
            high: DVec3::INFINITY,
            spacing: 0.25,
        })
    }

    fn is_open(&self) -> bool {
        false
    }
}

fn poses(count: usize) -> Vec<DAffine3> {
    let pose = |number: usize| {
        let turn = DMat3::from_euler(glam::EulerRot::XYZ, 0.3 * number as f64, 0.5, 0.1);
        let finer = DMat3::from_diagonal(DVec3::splat(1.0 + number as f64));
        DAffine3::from_mat3_translation(finer * turn, DVec3::new(0.3, 0.1, -0.4))
    };
    (1..=count).map(pose).collect()
}

fn grid() -> Grid {
    let grid = Grid::new(
        UVec3::splat(64),
        DVec3::ONE,
        DVec3::splat(0.5),
        DMat3::IDENTITY,
    );
    grid.expect("a grid")
}

#[test]
fn stretches_are_without_a_gap_and_each_is_what_stands_at_its_points() {
    let (grid, tissues) = (grid(), Tissues::of([(1, Tissue::FAT)]));
    for (count, wall) in [(0, false), (1, false), (1, true), (3, false), (5, true)] {
        let map = Chequers {
            poses: poses(count),
            wall,
        };
        let world = World {
            scan: NeedleScan {
                grid: &grid,
                map: &map,
            },
            tissues: &tissues,
        };
        let (from, to) = (DVec3::new(3.2, 4.9, 5.1), DVec3::new(19.7, 9.3, 14.8));
        let mut stretches = Stretches::new(from, to, &world).expect("a move");
        assert_eq!(stretches.grids() as usize, count + 1);
        let (mut reached, mut number) = (0.0, 0);
        loop {
            let Stretch { begin, end, met } = stretches.now();
            assert!((begin - reached).abs() < 1e-12, "{begin} {reached}");
            assert!(end >= begin);
            // rounding decides who has the points at a border
            if end - begin > 1e-9 {
                for share in [0.01, 0.5, 0.99] {
                    let point = from.lerp(to, begin + share * (end - begin));
                    assert_eq!(met, met_at(point, &world), "{count} bodies at {point}");
                }
            }
            (reached, number) = (end, number + 1);
            if !stretches.advance() {
                break;
            }
        }
        assert_eq!(reached, 1.0);
        assert!(number > 20, "{number}");
        assert_eq!(finest(&world), if count == 0 { 1.0 } else { 0.25 });
    }
}

#[test]
fn a_body_that_is_not_near_is_not_walked() {
    struct Far(DAffine3);
    impl TissueMap for Far {
        fn at(&self, body: usize, _voxel: IVec3, _tissues: &Tissues) -> Met {
            if body == 0 {
                Met::Nothing
            } else {
                Met::Wall(1)
            }
        }
        fn body(&self, number: usize) -> Option<NeedleBody<'_>> {
            (number == 1).then_some(NeedleBody {
                body_from_scan: &self.0,
                low: DVec3::splat(20.0),
                high: DVec3::splat(30.0),
                spacing: 1.0,
            })
        }
        fn is_open(&self) -> bool {
            false
        }
    }
    let (grid, tissues) = (grid(), Tissues::default());
    let map = Far(DAffine3::IDENTITY);
    let world = World {
        scan: NeedleScan {
            grid: &grid,
            map: &map,
        },
        tissues: &tissues,
    };
    let grids = |to: f64| {
        let stretches = Stretches::new(DVec3::splat(5.0), DVec3::splat(to), &world);
        stretches.expect("a move").grids()
    };
    assert_eq!((grids(10.0), grids(25.0)), (1, 2));
    assert!(Stretches::new(DVec3::NAN, DVec3::ONE, &world).is_none());
}
