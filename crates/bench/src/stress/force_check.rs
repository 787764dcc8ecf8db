//! Whether forces kept their promises: safe, never a pull, and no step.
//!
//! Frames: the world's grid for places; the scene for forces [N] and the spring [mm].

use glam::DVec3;
use palpate_haptics::contact::Proxy;
use palpate_haptics::tick::TickOutput;

use super::constants::Constants;
use super::guarantee::{Guarantee, Violation, hold};

/// What force over stiffness may change by in a tick beyond the hand's own move [smallest spacings].
const STEP: f64 = 0.1;

/// What was felt last, and what was sent.
#[derive(Clone, Copy, Debug)]
pub struct ForceCheck {
    constants: Constants,
    /// Force over stiffness [mm].
    felt: DVec3,
    /// Where the device was.
    device: DVec3,
    /// Force [N].
    sent: DVec3,
    /// How often guarantee 6 took more away than guarantee 8 lets go in a tick.
    pub cuts: u64,
}

impl ForceCheck {
    /// Nothing was felt, with the device at a place of the world's grid.
    pub fn new(constants: Constants, device: DVec3) -> Self {
        Self {
            constants,
            felt: DVec3::ZERO,
            device,
            sent: DVec3::ZERO,
            cuts: 0,
        }
    }

    /// After a tick that led the proxy toward the device.
    pub fn after_tick(
        &mut self,
        device: DVec3,
        proxy: &Proxy,
        output: &TickOutput,
    ) -> Result<(), Violation> {
        self.work(output)?;
        let out = self.constants.direction * ((proxy.point() - device) * self.constants.spacing);
        if self.constants.frictionless {
            self.pull(out, output)?;
        }
        self.step(device, out, output)
    }

    /// Guarantee 3, of forces.
    fn work(&self, output: &TickOutput) -> Result<(), Violation> {
        hold(
            output.contact || output.force == DVec3::ZERO,
            Guarantee::BoundedWork,
            || format!("{} N without contact", output.force),
        )
    }

    /// Guarantee 6, by the way `out` from the device to the probe [mm].
    fn pull(&self, out: DVec3, output: &TickOutput) -> Result<(), Violation> {
        let along = output.force.dot(out);
        // rounding: of the force itself, and of the spring that made it, whose ends are some 100 mm
        // from the corner of the grid
        let rounding =
            1e-9 * output.force.length() + 1e-12 * self.constants.stiffness * out.length();
        hold(along >= -rounding, Guarantee::NeverPulls, || {
            format!("{} N while the probe is {out} mm away", output.force)
        })
    }

    /// Guarantee 8: the force changes by no more than stiffness times the hand's own move and a
    /// tenth of the smallest spacing, but for what guarantee 6 takes away at once: the part of
    /// the last force that would pull now, since the probe went elsewhere.
    ///
    /// Voxels that were edited and objects that moved under the probe since the last tick are
    /// no excuse: whatever they did to it, its spring goes on from where it was.
    ///
    /// Not asked for: of stairs, which are felt on request as they are; of models that promise
    /// none; of friction, which holds the probe back and lets it go; of the damper, which follows
    /// the hand's speed and so leaves the spring to be looked at.
    fn step(&mut self, device: DVec3, out: DVec3, output: &TickOutput) -> Result<(), Violation> {
        let Constants {
            spacing,
            stiffness,
            damping,
            ..
        } = self.constants;
        let felt = if damping == 0.0 {
            output.force / stiffness
        } else {
            output.spring
        };
        let moved = ((device - self.device) * spacing).length();
        let last = std::mem::replace(&mut self.felt, felt);
        self.device = device;
        if !(self.constants.felt.is_smooth() && self.constants.frictionless) {
            return Ok(());
        }
        // rounding of places some 1000 mm from the origin
        let allowed = moved + STEP * spacing.min_element() + 1e-9;
        if felt.distance(last) <= allowed {
            return Ok(());
        }
        self.cuts += 1;
        hold(
            felt.distance(without_pull(last, out)) <= allowed,
            Guarantee::StepsLittle,
            || format!("felt {last} mm, then {felt} mm, while the hand moved {moved} mm"),
        )
    }

    /// Input that is none: nothing moves and nothing is felt.
    pub fn after_nonsense(
        &mut self,
        [from, to]: [&Proxy; 2],
        output: &TickOutput,
    ) -> Result<(), Violation> {
        // a device without a place has no force, and the next contact begins from none
        self.felt = DVec3::ZERO;
        hold(
            from == to && output.force == DVec3::ZERO,
            Guarantee::SafeForce,
            || format!("{} N from an input that is none", output.force),
        )
    }

    /// Guarantee 5, of what was wanted and what the safety stage made of it.
    pub fn after_safety(&mut self, wanted: DVec3, sent: DVec3) -> Result<(), Violation> {
        let Constants { limits, dt, .. } = self.constants;
        let last = std::mem::replace(&mut self.sent, sent);
        let told = || format!("wanted {wanted} N, sent {sent} N after {last} N");
        hold(
            wanted.is_finite() && sent.is_finite(),
            Guarantee::SafeForce,
            told,
        )?;
        hold(
            sent.length() <= limits.max_force,
            Guarantee::SafeForce,
            told,
        )?;
        hold(
            sent.dot(wanted) >= -1e-9 * sent.length(),
            Guarantee::SafeForce,
            told,
        )?;
        // what fell is free: any part of the last force, without what points against the wanted
        let along = last.dot(wanted);
        let kept = if along < 0.0 {
            last - wanted * (along / wanted.length_squared())
        } else {
            last
        };
        let square = kept.length_squared();
        let share = if square > 0.0 {
            (sent.dot(kept) / square).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let grown = (sent - kept * share).length();
        // rounding
        hold(
            grown <= limits.max_growth * dt * (1.0 + 1e-9),
            Guarantee::SafeForce,
            told,
        )
    }
}

/// What is left of a force without its part that pulls away from the probe.
fn without_pull(felt: DVec3, out: DVec3) -> DVec3 {
    let along = felt.dot(out);
    if along >= 0.0 {
        return felt;
    }
    felt - out * (along / out.length_squared())
}

#[cfg(test)]
mod tests {
    use super::super::examples::{DEVICE, constants, output, proxy};
    use super::super::felt::Felt;
    use super::*;

    /// What the last of some ticks breaks; each has the device's x and the force along x [N].
    fn broken_by(constants: Constants, ticks: &[(f64, TickOutput)]) -> Option<Guarantee> {
        let mut check = ForceCheck::new(constants, DEVICE);
        let mut found = Ok(());
        for (x, output) in ticks {
            found = check.after_tick(DEVICE.with_x(*x), &proxy(7.5), output);
        }
        found.err().map(|violation| violation.guarantee)
    }

    fn broken(ticks: &[(f64, TickOutput)]) -> Option<Guarantee> {
        broken_by(constants(), ticks)
    }

    #[test]
    fn no_force_pulls_and_none_is_without_contact() {
        assert_eq!(broken(&[(9.5, output(-0.1))]), None);
        assert_eq!(broken(&[(9.5, output(1e-6))]), Some(Guarantee::NeverPulls));
        let loose = TickOutput {
            contact: false,
            ..output(-0.1)
        };
        assert_eq!(broken(&[(9.5, loose)]), Some(Guarantee::BoundedWork));
    }

    #[test]
    fn a_force_changes_by_little_more_than_the_hand_moves() {
        // a tenth of a voxel at 2 N/mm, and what the hand moved
        let small = [(9.5, output(-0.2)), (9.5, output(-0.4))];
        assert_eq!(broken(&small), None);
        let with_hand = [(9.5, output(-0.2)), (10.5, output(-2.4))];
        assert_eq!(broken(&with_hand), None);
        let beyond = [(9.5, output(-0.2)), (10.5, output(-2.41))];
        assert_eq!(broken(&beyond), Some(Guarantee::StepsLittle));
        let falls = [
            (9.5, output(-0.2)),
            (10.5, output(-2.4)),
            (10.5, output(0.0)),
        ];
        assert_eq!(broken(&falls), Some(Guarantee::StepsLittle));
        // beside a damper the spring is looked at
        let damped = Constants {
            damping: 0.01,
            ..constants()
        };
        let spring = TickOutput {
            force: DVec3::X * -5.0,
            ..output(-0.2)
        };
        assert_eq!(broken_by(damped, &[(9.5, spring)]), None);
        assert_eq!(broken(&[(9.5, spring)]), Some(Guarantee::StepsLittle));
        // stairs are stairs
        let stairs = Constants {
            felt: Felt::Stairs,
            ..constants()
        };
        assert_eq!(broken_by(stairs, &[(9.5, output(-4.0))]), None);
    }

    #[test]
    fn a_device_without_a_place_has_no_force_and_contact_begins_anew() {
        let mut check = ForceCheck::new(constants(), DEVICE);
        let [still, moved] = [proxy(7.5), proxy(7.4)];
        assert!(check.after_nonsense([&still, &still], &output(0.0)).is_ok());
        assert!(
            check
                .after_nonsense([&still, &moved], &output(0.0))
                .is_err()
        );
        assert!(
            check
                .after_nonsense([&still, &still], &output(1e-9))
                .is_err()
        );
        assert!(check.after_tick(DEVICE, &still, &output(-0.2)).is_ok());
    }

    #[test]
    fn each_promise_of_what_is_sent_is_asked_for() {
        // wanted and sent along x, one after the other; whether the last is safe
        let is_safe = |forces: &[(f64, f64)]| {
            let mut check = ForceCheck::new(constants(), DEVICE);
            let mut last = Ok(());
            for &(wanted, sent) in forces {
                last = check.after_safety(DVec3::X * wanted, DVec3::X * sent);
            }
            last.is_ok()
        };
        assert!(is_safe(&[(0.9, 0.9), (1.8, 1.8), (0.1, 0.1), (-0.9, -0.9)]));
        assert!(is_safe(&[(9.0, 1.0), (9.0, 2.0), (9.0, 3.0), (9.0, 4.0)]));
        // grows too fast, at the start and later, and around zero
        assert!(!is_safe(&[(1.1, 1.1)]));
        assert!(!is_safe(&[(0.9, 0.9), (2.0, 2.0)]));
        assert!(!is_safe(&[(0.9, 0.9), (-1.1, -1.1)]));
        // too large, against what is wanted, not a number
        let ramp = [(9.0, 1.0), (9.0, 2.0), (9.0, 3.0), (9.0, 4.0), (9.0, 4.9)];
        assert!(is_safe(&ramp));
        assert!(!is_safe(&[&ramp[..], &[(9.0, 5.1)]].concat()));
        assert!(!is_safe(&[(0.5, -0.1)]));
        assert!(!is_safe(&[(f64::NAN, 0.0)]));
        assert!(!is_safe(&[(0.0, f64::NAN)]));
    }
}
