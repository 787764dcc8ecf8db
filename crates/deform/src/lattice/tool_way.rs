//! The way of the tools since the last answer, in steps that nodes can follow.
//!
//! A tool that is put past the middle of tissue pushes it out at its other side, and falls through: on its way
//! it would have pushed it ahead. Between slow answers a tool goes that far. So it takes tissue along with it,
//! step by step, and tissue comes nearer to rest after each.

use glam::DVec3;

use super::moving_box::MovingBox;
use super::nodes::Lattice;
use super::tool_contact::{LatticeTool, ToolForce};
use crate::model::ToolState;

/// How far a tool goes in a step [its smallest half axis].
const STEP: f64 = 0.5;
/// As far as this tissue follows a tool by itself [its smallest half axis].
const SHORT: f64 = 0.1;
/// Steps at most: a tool that is farther from where it was has been put elsewhere.
const MOST: f64 = 16.0;

/// Where the tools were on the way from `last` to where they are, these last; none where one has been put
/// elsewhere.
pub(super) fn on_the_way(last: &[ToolState], tools: &[&ToolState]) -> Vec<Vec<ToolState>> {
    let starts = tools.iter().map(|tool| {
        let last = last.iter().find(|last| last.id == tool.id);
        last.map_or(tool.position, |last| last.position)
    });
    let starts: Vec<DVec3> = starts.collect();
    let steps = |(tool, start): (&&ToolState, &DVec3)| {
        let way = tool.position.distance(*start);
        (way / (STEP * tool.shape.half_axes().min_element())).ceil()
    };
    let steps = tools.iter().zip(&starts).map(steps).fold(1.0, f64::max);
    if steps > MOST {
        return Vec::new();
    }
    let at = |step: u32| {
        let share = f64::from(step) / steps;
        let both = tools.iter().zip(&starts);
        both.map(|(tool, start)| ToolState {
            position: start.lerp(tool.position, share),
            ..**tool
        })
        .collect()
    };
    (1..=steps as u32).map(at).collect()
}

/// Has the tissue of a box go on with the tools from one step to the next; `felt` is what each felt at the first.
pub(super) fn take_along(
    matter: &mut MovingBox,
    felt: &[ToolForce],
    from: &[ToolState],
    to: &[ToolState],
) {
    for (tool, felt) in from.iter().zip(felt) {
        if let Some(next) = to.iter().find(|next| next.id == tool.id) {
            let [start, end] = [tool, next].map(|tool| matter.tool(tool));
            push_ahead(&mut matter.lattice, &start, end.centre, felt.force);
        }
    }
}

/// Moves what a tool presses as far as the tool goes into it, and all around the less the farther away it is:
/// nearly to where it comes to rest, and never behind the tool. Where a tool goes along tissue or out of it,
/// nothing is moved.
///
/// Far from a small punch displacements are as one over the distance (Boussinesq 1885; Johnson, Contact
/// Mechanics, 1985, section 3.2).
fn push_ahead(lattice: &mut Lattice, tool: &LatticeTool, end: DVec3, felt: DVec3) {
    let outwards = felt.normalize_or_zero();
    let inwards = (end - tool.centre).dot(outwards);
    let short = SHORT * tool.half_axes.min_element();
    if !inwards.is_finite() || inwards > -short {
        return;
    }
    // nodes that the tool touches are half a spacing away from it
    let all = tool.half_axes.max_element() + lattice.spacing;
    for node in 0..lattice.layout.len() {
        let away = lattice.place(node).distance(tool.centre);
        let step = inwards * (all / away).min(1.0) * outwards;
        for axis in 0..3 {
            if !lattice.held[axis][node] {
                lattice.moved[axis][node] += step[axis];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{DQuat, UVec3};

    use super::*;
    use crate::lattice::{Border, NodeMaterial};
    use crate::material::Solid;
    use crate::model::ToolShape;

    fn ball(z: f64) -> ToolState {
        ToolState {
            id: 4,
            shape: ToolShape::Ball(3.0),
            position: DVec3::new(1.0, 2.0, z),
            orientation: DQuat::IDENTITY,
        }
    }

    #[test]
    fn a_tool_goes_half_its_radius_at_a_time() {
        let way = on_the_way(&[ball(0.0)], &[&ball(6.0)]);
        let depths: Vec<f64> = way.iter().map(|tools| tools[0].position.z).collect();
        assert_eq!(depths, [1.5, 3.0, 4.5, 6.0]);
    }

    #[test]
    fn a_short_way_and_that_of_a_new_tool_are_one_step_and_a_tool_put_elsewhere_has_none() {
        let now = ball(1.4);
        assert_eq!(on_the_way(&[ball(0.0)], &[&now]), [[now]]);
        assert_eq!(on_the_way(&[], &[&now]), [[now]]);
        assert!(on_the_way(&[ball(40.0)], &[&now]).is_empty());
    }

    #[test]
    fn tissue_goes_ahead_of_a_tool_that_presses_and_stays_where_it_goes_along_or_out() {
        let soft = Solid {
            young: 5.5e-3,
            poisson: 0.3,
            density: 1.06e-6,
            fracture_energy: f64::INFINITY,
            friction: 0.0,
            stiffening: 0.0,
        };
        let matter = |_| NodeMaterial::Deformable(soft);
        let at_rest = Lattice::new(UVec3::splat(11), 1.0, Border::Free, matter);
        let tool = LatticeTool::ball(DVec3::new(5.0, 5.0, 12.0), 3.0);
        let nodes = [8, 2, 0].map(|z| UVec3::new(5, 5, z));
        let moved = |step: DVec3, hold: bool| {
            let mut lattice = at_rest.clone();
            let [.., bottom] = nodes.map(|node| lattice.layout().index(node));
            (0..3).for_each(|axis| lattice.hold(bottom, axis, hold));
            push_ahead(&mut lattice, &tool, tool.centre + step, DVec3::Z);
            nodes.map(|node| lattice.moved(lattice.layout().index(node)))
        };
        let [touched, deep, bottom] = moved(DVec3::new(1.0, 0.0, -2.0), true);
        assert_eq!(touched, DVec3::new(0.0, 0.0, -2.0));
        assert!((deep.z + 2.0 * 4.0 / 10.0).abs() < 1e-12, "{deep}");
        assert_eq!(bottom, DVec3::ZERO);
        for step in [DVec3::X, DVec3::Z, DVec3::splat(f64::NAN)] {
            assert_eq!(moved(step, false), [DVec3::ZERO; 3]);
        }
    }
}
