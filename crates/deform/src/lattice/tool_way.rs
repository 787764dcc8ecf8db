//! The way of the tools since the last answer, in steps that nodes can follow.
//!
//! A tool that is put past the middle of tissue pushes it out at its other side, and falls through: on its way
//! it would have pushed it ahead. Between slow answers a tool goes that far.

use glam::DVec3;

use crate::model::ToolState;

/// How far a tool goes in a step [its smallest half axis].
const STEP: f64 = 0.5;
/// Steps at most: a tool that is farther from where it was has been put elsewhere.
const MOST: f64 = 16.0;

/// Where the tools were on the way from `last` to where they are, without both ends.
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
    (1..steps as u32).map(at).collect()
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;
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
        assert_eq!(depths, [1.5, 3.0, 4.5]);
    }

    #[test]
    fn a_short_way_a_new_tool_and_one_put_elsewhere_have_none() {
        let now = ball(1.4);
        assert!(on_the_way(&[ball(0.0)], &[&now]).is_empty());
        assert!(on_the_way(&[], &[&now]).is_empty());
        assert!(on_the_way(&[ball(40.0)], &[&now]).is_empty());
    }
}
