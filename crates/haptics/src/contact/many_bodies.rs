//! `exact` where objects are near: the same rule, with every move walked in each body.
//!
//! The proxy descends: straight toward the device, then along the faces that it meets. Where
//! they hold it, it slides through a lattice of nodes, as long as that brings it nearer to the
//! device by more than rounding. So the distance to the device falls as with one body, the
//! proxy comes to rest, and at rest it is not touched: a gain too small is no move.
//!
//! Frame: the world's grid, lengths in mm. `docs/decisions/objects.md` has the measurements.

use crate::contact::Contact;
use crate::contact::bodies::{Bodies, Visits};
use crate::contact::descent::{Descent, descend};
use crate::contact::exact::ExactLimits;
use crate::contact::proxy::Proxy;
use crate::contact::slide_many::{LEAST_GAIN, Slide};
use glam::DVec3;
use palpate_volume::occupancy::Occupancy;

/// Visits of straight moves are this many times those of the world alone: each is walked in
/// every body, and a skin before a face is walked once more.
const WALKS: u32 = 4;
/// Voxels that slides may read, each on average.
const SLIDE_VISITS: u32 = 2048;

/// Most voxels that one call reads, whatever the number of bodies; where they are used up the
/// proxy stays where it has got to.
pub(crate) fn visit_bound(limits: &ExactLimits) -> u32 {
    let walks = limits.max_visits.saturating_mul(WALKS);
    let slides = limits.max_slides.saturating_mul(SLIDE_VISITS);
    walks.saturating_add(slides)
}

/// Moves the proxy toward the device point among the bodies that are near.
pub(crate) fn advance<O: Occupancy>(
    limits: &ExactLimits,
    bodies: &Bodies<'_, O>,
    device: DVec3,
    proxy: &mut Proxy,
) -> Contact {
    let mut contact = Contact::default();
    if Proxy::at(device).is_none() {
        return contact;
    }
    if bodies.solid_at(proxy.point()).is_some() {
        contact.violation = true;
        return contact;
    }
    let mut visits = Visits::new(visit_bound(limits));

    // straight, then along the faces; what is hardly nearer is no move
    let most_visits = limits.max_visits;
    let here = proxy.point();
    let mut best = descend(bodies, here, device, most_visits, &mut visits);
    let distance = |point: DVec3| bodies.squared_distance(point, device).sqrt();
    let least_gain = LEAST_GAIN * bodies.smallest_spacing();
    if best.stopped_by.is_some() && distance(best.point) > distance(here) - least_gain {
        best.point = here;
    }

    // then over whatever holds it, to where the device is nearer
    while !best.arrived && best.stopped_by.is_some() && contact.slides < limits.max_slides {
        let slide = Slide {
            bodies,
            from: best.point,
            device,
            met: best.met,
            most_visits,
        };
        let Some(nearer) = slide.find(&mut visits) else {
            break;
        };
        best = nearer;
        contact.slides += 1;
    }
    settle(contact, &best, &visits, proxy)
}

/// Puts the proxy where a tick has brought it.
fn settle(contact: Contact, best: &Descent, visits: &Visits, proxy: &mut Proxy) -> Contact {
    *proxy = Proxy::at(best.point).unwrap_or(*proxy);
    Contact {
        touching: best.stopped_by.is_some(),
        stopped_by: best.stopped_by,
        visits: visits.used(),
        ..contact
    }
}
