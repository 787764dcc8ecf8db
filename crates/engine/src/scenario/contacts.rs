//! Contacts of a driven tool that begin and end.

use super::drive::Sample;
use super::rig::TICKS_PER_PASS;

/// A contact that is gone for so long is over [ticks]; voxels that go part it for less.
const APART_TICKS: u64 = 100;

/// A contact that began or ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactEvent {
    /// Whether the tool came to the bone, or came free.
    pub is_contact: bool,
    /// When [s].
    pub time: f64,
    /// How far the drive was [mm].
    pub travel: f64,
    /// With which force [N].
    pub force: f64,
}

/// Contacts that began and ended, by their force, which can begin later than voxels hold the tool; one
/// that is gone for some passes of the simulation goes on.
pub(super) fn contacts(samples: &[Sample]) -> Vec<ContactEvent> {
    let apart = APART_TICKS.max(TICKS_PER_PASS) as usize;
    let mut events = Vec::new();
    let mut last_contact = None;
    for (place, sample) in samples.iter().enumerate() {
        let is_contact = sample.force > 0.0;
        let event = |is_contact, sample: &Sample| ContactEvent {
            is_contact,
            time: sample.time,
            travel: sample.travel,
            force: sample.force,
        };
        match (is_contact, last_contact) {
            (true, None) => events.push(event(true, sample)),
            (false, Some(last)) if place - last >= apart => {
                events.push(event(false, &samples[last]));
                last_contact = None;
            }
            _ => {}
        }
        if is_contact {
            last_contact = Some(place);
        }
    }
    events
}
