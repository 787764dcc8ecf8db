//! Voxels that follow the lattice: they move, come back to the bit, and stay cut where cut.

use crate::model_support::{Bench, LIVER, RADIUS, TOP};
use glam::{DVec3, IVec3};
use palpate_deform::lattice::{LatticeModel, LatticeSettings};
use palpate_deform::material::SolidSi;
use palpate_deform::model::{DisplacementField, ModelAnswer};
use palpate_volume::voxel_box::VoxelBox;

/// Where the probe goes in, between voxels.
const AT: DVec3 = DVec3::new(18.2, 18.3, TOP + RADIUS);

fn at_depth(depth: f64) -> DVec3 {
    AT - DVec3::Z * depth
}

/// Presses to a depth in steps, and gives the last answer.
fn press(bench: &mut Bench, from: f64, to: f64) -> ModelAnswer {
    let steps = 8;
    let mut last = ModelAnswer::default();
    for step in 1..=steps {
        let share = f64::from(step) / f64::from(steps);
        last = bench.advance(at_depth(from + share * (to - from)));
    }
    last
}

#[test]
fn a_dent_moves_voxels_with_their_intensity_and_leaves_the_tools_body_free() {
    let mut bench = Bench::new(LIVER);
    let untouched = bench.picture();
    let answer = press(&mut bench, 0.0, 3.0);
    let changed = bench.changed(&untouched);
    assert!(changed > 60, "{changed} voxels moved");
    assert_eq!(answer.report.moved_voxels, changed);

    let tool = at_depth(3.0);
    for voxel in bench.grid().bounds().voxels() {
        // rounding to voxels and the margin
        let free = (voxel.as_dvec3() + 0.5).distance(tool) >= RADIUS - 0.15;
        assert!(free || !bench.is_solid(voxel), "{voxel} is in the tool");
    }
    // under the tool the body shows what was above: its texture has moved with it
    let below = IVec3::new(18, 18, TOP as i32 - 4);
    assert!(bench.is_solid(below));
    let (now, then) = (bench.layer_of(below), below.z);
    assert!(now > then && now < TOP as i32, "{now} at {then}");
}

#[test]
fn matter_comes_back_to_the_bit_when_the_tool_leaves() {
    let mut bench = Bench::new(LIVER);
    let untouched = bench.picture();
    press(&mut bench, 0.0, 3.0);
    assert!(bench.changed(&untouched) > 60);
    // up, and then so far away that the box leaves the dent at once
    press(&mut bench, 3.0, -1.0);
    assert_eq!(bench.changed(&untouched), 0);
    press(&mut bench, 0.0, 3.0);
    for _ in 0..3 {
        let answer = bench.advance(AT + DVec3::new(15.0, 0.0, 5.0));
        assert!(answer.contacts[0].contact.is_none());
    }
    assert_eq!(bench.changed(&untouched), 0);

    // a reset forgets displacements, and what stands in voxels comes back as well
    press(&mut bench, 0.0, 3.0);
    bench.model.reset();
    bench.advance(AT + DVec3::Z * 5.0);
    assert_eq!(bench.changed(&untouched), 0);
}

#[test]
fn a_tool_that_trembles_changes_no_voxel() {
    let mut bench = Bench::new(LIVER);
    press(&mut bench, 0.0, 2.0);
    for _ in 0..6 {
        bench.advance(at_depth(2.0));
    }
    let mut edits = 0;
    for step in 0..20 {
        let tremor = if step % 2 == 0 { 0.02 } else { -0.02 };
        edits += u32::from(bench.advance(at_depth(2.0 + tremor)).edit.is_some());
    }
    assert!(edits <= 1, "{edits} edits");
}

/// How high the body is shown to reach over a place: voxels and field together [mm].
fn shown_height(bench: &Bench, field: Option<&DisplacementField>, x: i32, y: i32) -> f64 {
    let solid = |z: &i32| bench.is_solid(IVec3::new(x, y, *z));
    let top = (0..36).rev().find(solid).expect("a body") + 1;
    let face = DVec3::new(f64::from(x) + 0.5, f64::from(y) + 0.5, f64::from(top));
    let moved = field.map_or(0.0, |field| {
        // the upper face lies between two nodes
        let at = (face - field.origin) / field.spacing;
        let node = |z: f64| {
            let node = DVec3::new(at.x, at.y, z).round().as_uvec3();
            let size = field.size;
            let inside = node.cmplt(size).all();
            let index = node.x + size.x * (node.y + size.y * node.z);
            if inside {
                f64::from(field.moved[index as usize].z)
            } else {
                0.0
            }
        };
        let low = at.z.floor();
        node(low) + (at.z - low) * (node(low + 1.0) - node(low))
    });
    face.z + moved
}

#[test]
fn voxels_and_field_together_show_a_dent_that_deepens_smoothly() {
    let mut bench = Bench::new(LIVER);
    let (mut worst_step, mut last) = (0.0f64, TOP);
    for step in 0..=60 {
        let depth = 0.05 * f64::from(step);
        let answer = bench.advance(at_depth(depth));
        // beside the tool's lowest point, where its body clears no voxel
        let height = shown_height(&bench, answer.displacement.as_ref(), 21, 18);
        assert!(height < last + 0.2, "step {step}: {last} {height}");
        worst_step = worst_step.max((height - last).abs());
        last = height;
    }
    // voxels alone would fall by one at once
    assert!(worst_step < 0.4, "{worst_step} mm at once");
    assert!(last < TOP - 0.7, "{last}");
}

#[test]
fn a_dent_below_a_voxel_is_in_the_field_alone() {
    let mut bench = Bench::new(LIVER);
    let answer = press(&mut bench, 0.0, 0.3);
    let field = answer.displacement.expect("a field");
    let deepest = field.moved.iter().map(|moved| moved.z).fold(0.0, f32::min);
    assert!((-0.4..-0.2).contains(&deepest), "{deepest}");
    let rest = bench.advance(AT + DVec3::Z * 3.0);
    assert!(rest.displacement.is_none() && rest.report.moved_voxels == 0);
}

#[test]
fn what_somebody_cut_meanwhile_stays_cut() {
    let mut bench = Bench::new(LIVER);
    let untouched = bench.picture();
    press(&mut bench, 0.0, 3.0);
    let cut = VoxelBox::new(IVec3::new(16, 16, 12), IVec3::new(20, 20, 14));
    let layers: Vec<_> = cut.voxels().map(|voxel| bench.layer_of(voxel)).collect();
    assert!(layers.iter().any(|layer| !(12..14).contains(layer)));
    bench.cut(&cut);
    for _ in 0..3 {
        let answer = bench.advance(at_depth(3.0));
        assert!(answer.report.residual.is_finite());
    }
    press(&mut bench, 3.0, -1.0);
    // what stood there is missing now where it is at rest, and nothing else
    for (voxel, then) in bench.grid().bounds().voxels().zip(&untouched) {
        let inside = (16..20).contains(&voxel.x) && (16..20).contains(&voxel.y);
        let cut = inside && layers.contains(&voxel.z);
        assert!(cut || bench.is_solid(voxel) == then.1, "{voxel}");
    }
    let missing = u64::from(bench.changed(&untouched));
    assert!(missing > 0 && missing <= cut.voxel_count(), "{missing}");
}

#[test]
fn an_edit_changes_the_force_and_undo_gives_it_back() {
    let mut bench = Bench::new(LIVER);
    let tool = at_depth(1.0);
    let force = |bench: &mut Bench| {
        let mut force = DVec3::ZERO;
        for _ in 0..4 {
            let contact = bench.advance(tool).contacts[0].contact;
            force = contact.expect("contact").force;
        }
        force
    };
    let whole = force(&mut bench);
    // a hollow under the contact; the box is elsewhere than where it would be made now
    let hollow = VoxelBox::new(IVec3::new(14, 14, 10), IVec3::new(23, 23, 14));
    let inverse = bench.cut(&hollow);
    let hollowed = force(&mut bench);
    assert!(hollowed.z < 0.9 * whole.z, "{hollowed} {whole}");
    bench.undo(inverse);
    let again = force(&mut bench);
    assert!(
        (again - whole).length() < 2e-3 * whole.length(),
        "{again} {whole}"
    );
}

#[test]
fn bonds_that_broke_are_still_broken_when_the_box_comes_back() {
    let brittle = SolidSi {
        // breaks at a strain of 0.08 on 1 mm
        fracture_energy: 11.1,
        ..LIVER
    };
    let press_deep = |bench: &mut Bench| {
        let mut force = DVec3::ZERO;
        for step in 0..=30 {
            let answer = bench.advance(at_depth(0.1 * f64::from(step)));
            force = answer.contacts[0].contact.map_or(DVec3::ZERO, |c| c.force);
        }
        (force, bench.advance(AT + DVec3::Z).report.bonds_broken)
    };
    let mut bench = Bench::new(brittle);
    let (_, first) = press_deep(&mut bench);
    assert!(first > 10, "{first} bonds");
    // far away and back
    for aside in [-14.0, 0.0] {
        bench.advance(AT + DVec3::new(aside, aside, 12.0));
    }
    let (_, second) = press_deep(&mut bench);
    // what broke cannot break again; a whole body would lose as many as at first
    assert!(
        second - first < first / 2,
        "{first} then {}",
        second - first
    );
}

#[test]
fn the_model_works_with_flat_voxels_too() {
    let model = LatticeModel::new(LatticeSettings::default());
    let mut bench = Bench::with(LIVER, DVec3::new(0.75, 0.75, 2.0), Box::new(model));
    let untouched = bench.picture();
    press(&mut bench, 0.0, 3.0);
    assert!(bench.changed(&untouched) > 60);
    press(&mut bench, 3.0, -1.0);
    assert_eq!(bench.changed(&untouched), 0);
}

#[test]
fn what_voxels_do_not_show_is_near_them_also_at_the_walls_of_a_dent() {
    for spacing in [DVec3::ONE, DVec3::new(0.75, 0.75, 2.0)] {
        let model = LatticeModel::new(LatticeSettings::default());
        let mut bench = Bench::with(LIVER, spacing, Box::new(model));
        let mut farthest = 0.0_f32;
        for step in 0..=24 {
            let answer = bench.advance(at_depth(0.25 * f64::from(step)));
            let field = answer.displacement.into_iter();
            let moved = field
                .flat_map(|field| field.moved)
                .map(|moved| moved.length());
            let here = moved.fold(0.0, f32::max);
            farthest = farthest.max(here);
        }
        // a face is up to 0.65 voxels beside where they show it, and a node beyond it goes on from
        // the tissue before it through that
        let most = 2.2 * spacing.max_element() as f32;
        assert!(farthest <= most, "{farthest} mm beside voxels of {spacing}");
    }
}
