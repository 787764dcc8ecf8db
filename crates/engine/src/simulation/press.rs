//! A hand that presses with the mouse, led by the simulation.

use super::Simulation;
use crate::simulation::hand_end::{Press, SharedHand};
use crate::simulation::led_hand::{HandMove, HandStep, LedHand};
use crate::threads::SIMULATION_HZ;

/// Of the largest force, how much a hand presses with at most.
const SHARE_OF_LIMIT: f64 = 0.95;

/// The hand of a person, and how it is led.
#[derive(Debug)]
pub struct PressingHand {
    hand: SharedHand,
    led: LedHand,
    takeovers: u64,
}

impl Simulation {
    /// Leads this hand from now on, as far as it presses.
    pub fn lead(&mut self, hand: SharedHand) {
        self.pressing = Some(PressingHand {
            hand,
            led: LedHand::default(),
            takeovers: 0,
        });
    }

    /// Moves the hand where it presses.
    pub(super) fn advance_press(&mut self) {
        let Some(mut pressing) = self.pressing.take() else {
            return;
        };
        self.advance_hand(&mut pressing);
        self.pressing = Some(pressing);
    }

    fn advance_hand(&mut self, pressing: &mut PressingHand) {
        let (stiffness, (press, takeovers)) = {
            let hand = pressing.hand.lock();
            (hand.stiffness(), hand.press())
        };
        if takeovers != pressing.takeovers || self.clutched {
            pressing.takeovers = takeovers;
            pressing.led.forget();
        }
        let Some(stiffness) = stiffness.filter(|_| !self.clutched) else {
            return;
        };
        // a wall that pushes with the limit holds nothing that pulls harder
        let most = SHARE_OF_LIMIT * self.settings.force_limit;
        let step = HandStep {
            press: press.map(|press| Press {
                pressure: press.pressure.min(most),
                ..press
            }),
            ahead_per_newton: self.settings.gain / stiffness,
            commands: self.touch.commands(),
            has_needle: self.needle.now().place.is_some(),
            dt: 1.0 / f64::from(SIMULATION_HZ),
        };
        let servo = *self.touch.status();
        match pressing.led.step(&step, &servo, &*self) {
            HandMove::Stay => {}
            HandMove::PullTo(point) => {
                let mut hand = pressing.hand.lock();
                // whoever took the hand meanwhile has it
                if hand.press().1 == takeovers {
                    hand.pull_to(point);
                }
            }
            HandMove::Place(point) => {
                let number = pressing.hand.lock().number();
                if self.place_free(point, number, true).is_err() {
                    pressing.led.forget();
                }
            }
        }
    }
}
