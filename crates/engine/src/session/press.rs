//! A press with the mouse: on what a ray of the view meets first. Frame: scene; mm, N.

use glam::DVec3;

use super::Session;
use crate::error::SessionError;
use crate::session::config::check_point;
use crate::simulation::Press;
use crate::touch::MOST_PRESSURE;

impl Session {
    /// Has the hand bring the probe onto the first surface on a ray and press there with so much
    /// force, at most that of the settings. Again it goes on from there; the latest press holds.
    ///
    /// # Errors
    /// Where ray or force are not allowed, the device has a hand of its own, or the session has
    /// ended.
    pub fn press(
        &self,
        origin: DVec3,
        direction: DVec3,
        pressure: f64,
    ) -> Result<(), SessionError> {
        check_point("press", origin)?;
        let direction = Some(direction)
            .filter(|direction| direction.is_finite())
            .and_then(DVec3::try_normalize)
            .ok_or(SessionError::PressDirection(direction))?;
        if !(pressure > 0.0 && pressure <= MOST_PRESSURE) {
            return Err(SessionError::Pressure(pressure));
        }
        self.check_running()?;
        let mut hand = self.hand.lock();
        if hand.stiffness().is_none() {
            return Err(SessionError::NoHand(self.device_name.clone()));
        }
        hand.set_press(Some(Press {
            origin,
            direction,
            pressure,
        }));
        Ok(())
    }

    /// Lifts the hand off what it presses; nothing where it does not.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn lift(&self) -> Result<(), SessionError> {
        self.check_running()?;
        self.hand.lock().set_press(None);
        Ok(())
    }
}
