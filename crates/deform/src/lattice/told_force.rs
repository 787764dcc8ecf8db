//! What a tool is told to feel before the nodes are at rest.
//!
//! Nodes that a tool has reached are pushed against others that have not moved yet. Until they have, the force is
//! several times too high, and a hand that is told of it is thrown back: its tool leaves, the next force is too
//! low, and so on. So a force that is higher than the last law foresaw counts the less the farther nodes are from
//! rest.

use glam::DVec3;
use palpate_volume::material::LocalContact;

use crate::model::ToolState;

/// Unbalanced force, as a share of what was foreseen, up to which the force counts in full.
const NEAR_REST: f64 = 0.1;
/// What was foreseen counts as this share of the force found, at least: at rest that one counts, whatever was foreseen.
const LEAST_FORESEEN: f64 = 0.1;

/// The force to be told of a tool where this one was found [N, patient], by what it was told last. The
/// `residual` is the unbalanced force as a share of the force found.
pub(super) fn told_force(
    last: Option<LocalContact>,
    tool: &ToolState,
    found: DVec3,
    residual: f64,
) -> DVec3 {
    let Some(foreseen) = last.and_then(|last| foreseen(&last, tool)) else {
        return found;
    };
    let (expected, felt) = (foreseen.length(), found.length());
    if felt <= expected {
        return found;
    }
    let unbalanced = residual * felt / expected.max(LEAST_FORESEEN * felt);
    let share = (NEAR_REST / unbalanced).powi(2).min(1.0);
    foreseen.lerp(found, share)
}

/// What a law has a tool feel where it is now; none where it would not be pushed.
fn foreseen(last: &LocalContact, tool: &ToolState) -> Option<DVec3> {
    let force = last.force + last.stiffness * (tool.position - last.position);
    (force.dot(last.force) > 0.0).then_some(force)
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DQuat};

    use super::*;
    use crate::model::ToolShape;

    /// A ball so deep, where 2 mm had 0.2 N and 0.1 N/mm.
    fn told(deep: f64, found: f64, residual: f64) -> f64 {
        let at = |deep: f64| DVec3::new(1.0, 2.0, 20.0 - deep);
        let last = LocalContact {
            position: at(2.0),
            force: DVec3::Z * 0.2,
            stiffness: DMat3::from_diagonal(DVec3::Z * -0.1),
            validity: 1.0,
        };
        let tool = ToolState {
            id: 0,
            shape: ToolShape::Ball(2.0),
            position: at(deep),
            orientation: DQuat::IDENTITY,
        };
        told_force(Some(last), &tool, DVec3::Z * found, residual).z
    }

    #[test]
    fn a_force_of_nodes_that_have_not_yet_moved_on_counts_little() {
        // 0.5 N are foreseen
        let far = told(5.0, 2.5, 0.2);
        assert!((0.5..0.7).contains(&far), "{far}");
        assert!(told(5.0, 2.5, 0.05) > far);
        // and the longer it lasts the more
        assert!(told(2.0, 2.5, 0.2) > 0.2);
    }

    #[test]
    fn at_rest_the_force_that_is_found_is_told() {
        for deep in [0.1, 2.0, 5.0, 12.0] {
            assert_eq!(told(deep, 2.5, 0.01), 2.5, "{deep} mm");
            assert_eq!(told(deep, 2.5, 0.0), 2.5, "{deep} mm");
        }
    }

    #[test]
    fn lower_forces_and_those_where_nothing_is_known_are_told_at_once() {
        assert_eq!(told(5.0, 0.4, 0.5), 0.4);
        // it had left
        assert_eq!(told(-1.0, 2.5, 0.5), 2.5);
        let tool = ToolState {
            id: 0,
            shape: ToolShape::Ball(2.0),
            position: DVec3::ZERO,
            orientation: DQuat::IDENTITY,
        };
        assert_eq!(told_force(None, &tool, DVec3::X, 0.5), DVec3::X);
    }
}
