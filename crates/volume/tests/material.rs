//! The linear law of a contact near a tool.

use glam::{DMat3, DVec3};
use palpate_volume::material::LocalContact;

#[test]
fn a_local_contact_is_a_spring_within_its_validity() {
    let contact = LocalContact {
        position: DVec3::new(1.0, 2.0, 3.0),
        force: DVec3::new(0.0, 0.0, 2.0),
        stiffness: DMat3::from_diagonal(DVec3::new(0.0, 0.0, -0.5)),
        validity: 1.5,
    };
    let at = |z: f64| contact.force_at(DVec3::new(1.0, 2.0, z));
    assert_eq!(at(3.0), Some(contact.force));
    // deeper by one mm: half a newton more
    assert_eq!(at(2.0), Some(DVec3::new(0.0, 0.0, 2.5)));
    assert_eq!(at(4.6), None);
    assert_eq!(at(f64::NAN), None);
}
