//! The person's end of the way to the device's hand: where it pulls to, and whether it presses.
//!
//! Shared by the session, which is told by pages, and the simulation, which leads a hand that
//! presses. Neither the servo nor the device ever sees the lock: both read the wait-free channel
//! behind it. Frame: scene; mm, N.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use glam::DVec3;

use crate::servo::HandTarget;

/// A finger on the picture: what is first on the ray is to be pressed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Press {
    /// Where the ray begins [mm].
    pub origin: DVec3,
    /// Where it goes, of length 1.
    pub direction: DVec3,
    /// The force on the surface [N].
    pub pressure: f64,
}

/// The hand of a session.
#[derive(Debug)]
pub struct HandEnd {
    targets: triple_buffer::Input<HandTarget>,
    number: u64,
    /// Of the spring by which the hand pulls the device [N/mm]; none where a person's hand does.
    stiffness: Option<f64>,
    press: Option<Press>,
    takeovers: u64,
}

/// It, as both have it.
#[derive(Clone, Debug)]
pub struct SharedHand(Arc<Mutex<HandEnd>>);

impl SharedHand {
    /// A hand that was not moved yet.
    #[must_use]
    pub fn new(targets: triple_buffer::Input<HandTarget>, stiffness: Option<f64>) -> Self {
        Self(Arc::new(Mutex::new(HandEnd {
            targets,
            number: 0,
            stiffness,
            press: None,
            takeovers: 0,
        })))
    }

    /// Somebody else leads the hand, see [`HandEnd::take_over`]; gives the number of its newest
    /// target.
    #[must_use]
    pub fn taken_over(&self) -> u64 {
        let mut hand = self.lock();
        hand.take_over();
        hand.number
    }

    /// Nobody holds it for longer than a copy takes.
    pub fn lock(&self) -> MutexGuard<'_, HandEnd> {
        // a hand is whole even where a thread failed while it held the lock
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl HandEnd {
    /// Moves the target to which the hand pulls the device.
    pub fn pull_to(&mut self, point: DVec3) {
        self.number += 1;
        self.targets.write(HandTarget {
            point,
            number: self.number,
        });
    }

    /// Number of the newest target.
    #[must_use]
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Stiffness of the hand [N/mm]; none where the device has a hand of its own.
    #[must_use]
    pub fn stiffness(&self) -> Option<f64> {
        self.stiffness
    }

    /// Presses there from now on, or lifts.
    pub fn set_press(&mut self, press: Option<Press>) {
        self.press = press;
    }

    /// What is pressed, and how often somebody else has taken the hand until now.
    #[must_use]
    pub fn press(&self) -> (Option<Press>, u64) {
        (self.press, self.takeovers)
    }

    /// Somebody else leads the hand: it neither presses any more nor lifts off.
    pub fn take_over(&mut self) {
        self.press = None;
        self.takeovers += 1;
    }
}
