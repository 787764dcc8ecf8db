//! A whole block between plates that it sticks to.

use crate::support::solid;
use glam::{DVec3, UVec3};
use palpate_deform::pressed_block::{BlockAtRest, PressedBlock};

fn press(nodes: u32, spacing: f64, poisson: f64, plates: [DVec3; 2]) -> BlockAtRest {
    let block = PressedBlock {
        nodes: UVec3::splat(nodes),
        spacing,
        solid: solid(poisson),
        plates,
        tolerance: 1e-6,
        iterations: 20_000,
    };
    let rest = block.relax();
    assert!(rest.report.residual <= 1e-6, "{:?}", rest.report);
    rest
}

fn at(rest: &BlockAtRest, nodes: u32, node: [u32; 3]) -> DVec3 {
    let [x, y, z] = node;
    rest.moved[(x + nodes * (y + nodes * z)) as usize]
}

#[test]
fn plates_that_move_together_carry_the_block_along_without_a_force() {
    let way = DVec3::new(1.0, -2.0, 0.5);
    let rest = press(9, 2.5, 0.4, [way, way]);
    assert!(rest.force.length() < 1e-9, "{}", rest.force);
    assert!(rest.moved.iter().all(|moved| moved.distance(way) < 1e-9));
}

#[test]
fn a_pressed_block_bulges_alike_on_all_sides_and_is_still_at_its_plates() {
    let nodes = 17;
    let rest = press(nodes, 0.5, 0.45, [DVec3::Z * 0.4, DVec3::ZERO]);
    let middle = nodes / 2;
    let right = at(&rest, nodes, [nodes - 1, middle, middle]);
    let left = at(&rest, nodes, [0, middle, middle]);
    let front = at(&rest, nodes, [middle, 0, middle]);
    // mirror images: to what the residual leaves
    assert!((right.x + left.x).abs() < 1e-4 && (left.x - front.y).abs() < 1e-4);
    assert!(right.x > 0.0, "{right}");
    assert_eq!(at(&rest, nodes, [0, 0, 0]), DVec3::Z * 0.4);
    assert_eq!(at(&rest, nodes, [3, 5, nodes - 1]), DVec3::ZERO);
}

/// A cube that sticks to both plates, of E = 1 and ν = 0.25: a finer lattice, and half the size of
/// it at the same strain, push with the same stress.
#[test]
fn the_stress_depends_on_the_shape_alone() {
    let stress = |nodes: u32, side: f64| {
        let spacing = side / f64::from(nodes - 1);
        let rest = press(nodes, spacing, 0.25, [DVec3::Z * 0.01 * side, DVec3::ZERO]);
        -rest.force.z / (side * side)
    };
    let (coarse, fine, small) = (stress(9, 8.0), stress(17, 8.0), stress(9, 4.0));
    assert!((coarse / small - 1.0).abs() < 1e-6, "{coarse} {small}");
    // the stress in the edges of the plates is endless: the mesh counts by some per cent
    assert!((coarse / fine - 1.0).abs() < 0.05, "{coarse} {fine}");
    // free sides would give 1 %, sides that are held 1.2 %
    assert!((0.010..0.012).contains(&fine), "{fine}");
}

/// A cube that sticks to both plates, nearly incompressible, beside finite elements: a quarter of it by
/// 6 · 6 · 12 hexahedra with quadratic shape functions (scikit-fem), pressed by 1 %. Places from the
/// middle of the lower plate, in sides; displacements for those of the plate.
#[test]
fn a_nearly_incompressible_cube_is_as_in_finite_elements() {
    let stress_over_strain = 1.238;
    let expected = [
        ([0.5, 0.0, 0.5], [0.3200, 0.0, 0.5]),
        ([0.5, 0.5, 0.5], [0.2868, 0.2868, 0.5]),
        ([0.5, 0.0, 0.25], [0.2896, 0.0, 0.7671]),
        ([0.25, 0.25, 0.25], [0.1324, 0.1324, 0.8174]),
        ([0.25, 0.0, 0.25], [0.1417, 0.0, 0.8262]),
        ([0.0, 0.0, 0.25], [0.0, 0.0, 0.8352]),
    ];
    let (nodes, side) = (17, 8.0);
    let stroke = 0.01 * side;
    let rest = press(nodes, 0.5, 0.49, [DVec3::Z * stroke, DVec3::ZERO]);
    let stress = -rest.force.z / (side * side) / 0.01;
    println!("{stress} beside {stress_over_strain}, {:?}", rest.report);
    assert!((stress / stress_over_strain - 1.0).abs() < 0.05, "{stress}");
    for (place, moved) in expected {
        let [x, y, z] = place;
        let node = [x + 0.5, y + 0.5, z].map(|share: f64| (16.0 * share).round() as u32);
        let found = at(&rest, nodes, node) / stroke;
        println!("{place:?}: {found} beside {moved:?}");
        assert!(
            found.distance(DVec3::from(moved)) < 0.03,
            "{place:?}: {found}"
        );
    }
}
