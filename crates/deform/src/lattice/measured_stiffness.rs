//! How stiff a contact was while the tool moved, since the last answer or since tissue was last at rest.

use glam::DVec3;
use palpate_volume::material::LocalContact;

use crate::model::ToolState;

/// A tool that has moved by so much has measured its stiffness [spacings]; where that is less than this
/// share of what was told, it counts.
const MEASURED_WAY: f64 = 0.01;
const MEASURED_SHARE: f64 = 0.7;
/// Least part of its way that a tool has gone against its force, to measure: aside, tissue is other tissue.
const STRAIGHT: f64 = 0.5;
/// Least fraction of the stiffness found that is reported, of tissue that is at rest and of tissue that is not:
/// there the force also changes because nodes go on, and a tool that followed it would fall through.
const LEAST_SHARE: f64 = 0.02;
const UNSURE_SHARE: f64 = 0.5;

/// What the way of a tool since an answer tells of its stiffness [N/mm].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Measured {
    /// How much the force has grown along itself for the way that the tool has gone against it.
    Stiffness(f64),
    /// The tool stands still: the stiffness reported last holds [N/mm].
    AsBefore(f64),
    /// Nothing is known: there was no contact, or the tool has moved away.
    Nothing,
}

impl Measured {
    /// The stiffness to be told where the linear problem found this.
    pub fn of(self, found: f64, is_at_rest: bool) -> f64 {
        let least = if is_at_rest {
            LEAST_SHARE
        } else {
            UNSURE_SHARE
        };
        match self {
            Self::Stiffness(seen) if seen < MEASURED_SHARE * found => seen.max(least * found),
            Self::AsBefore(reported) => found.min(reported),
            _ => found,
        }
    }
}

/// Measures the stiffness of a contact by its force [N, patient]. Where tissue of very different
/// stiffness comes to rest slowly, the linear problem finds it too stiff.
pub(super) fn measured(
    last: Option<LocalContact>,
    tool: &ToolState,
    force: DVec3,
    spacing: f64,
) -> Measured {
    let (Some(last), Some(normal)) = (last, force.try_normalize()) else {
        return Measured::Nothing;
    };
    let gone = last.position - tool.position;
    let way = gone.dot(normal);
    if way > MEASURED_WAY * spacing && way >= STRAIGHT * gone.length() {
        Measured::Stiffness((force - last.force).dot(normal) / way)
    } else if gone.length() <= MEASURED_WAY * spacing {
        Measured::AsBefore(along(&last, normal))
    } else {
        Measured::Nothing
    }
}

/// The stiffness of a contact along its force as it was told last [N/mm]; 0 where there was none.
pub(super) fn told_before(last: Option<LocalContact>) -> f64 {
    last.map_or(0.0, |last| along(&last, last.force.normalize_or_zero()))
}

/// The stiffness of a contact along a unit vector [N/mm].
fn along(contact: &LocalContact, normal: DVec3) -> f64 {
    -normal.dot(contact.stiffness * normal)
}
