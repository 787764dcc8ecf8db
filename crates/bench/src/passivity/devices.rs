//! The devices that touch is tried with: their limits, and what else a simulation needs.
//!
//! Largest force, stiffness, damping and workspace are estimates of public device code.
//! Effective mass at the tip, dry friction, encoder step and continuous force are assumed, near
//! what makers give for such devices (an arm of 45 to 160 g for the Phantoms, 0.06 to 0.26 N of
//! backdrive friction, 0.02 to 0.06 mm of resolution); a device's own figures are wanted.

use palpate_device::DeviceLimits;
use palpate_device::simulated::SimulatedSettings;

/// A device by name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceModel {
    /// Its name.
    pub name: &'static str,
    /// Largest force [N], for a moment and for long.
    force: [f64; 2],
    /// Largest stiffness [N/mm].
    stiffness: f64,
    /// Viscous friction [N·s/mm].
    damping: f64,
    /// Radius of the workspace [mm].
    workspace: f64,
    /// Effective mass at the tip [kg]; assumed.
    mass: f64,
    /// Dry friction [N]; assumed.
    friction: f64,
    /// Step of the encoders [mm]; assumed.
    encoder_step: f64,
}

/// All of them.
pub const DEVICES: [DeviceModel; 10] = [
    model(
        "Touch",
        [3.3, 0.88],
        [0.4, 0.004, 75.0],
        [0.045, 0.26, 0.055],
    ),
    model(
        "Omni",
        [3.3, 0.88],
        [0.7, 0.005, 100.0],
        [0.045, 0.26, 0.055],
    ),
    model(
        "Desktop",
        [7.9, 1.75],
        [1.0, 0.005, 100.0],
        [0.045, 0.06, 0.023],
    ),
    model(
        "Premium 1.5",
        [8.5, 1.4],
        [0.8, 0.005, 120.0],
        [0.075, 0.04, 0.03],
    ),
    model(
        "Premium 3.0",
        [22.0, 3.0],
        [1.0, 0.005, 250.0],
        [0.159, 0.2, 0.02],
    ),
    model("omega", [12.0, 12.0], [5.0, 0.03, 75.0], [0.2, 0.1, 0.01]),
    model(
        "sigma.7",
        [12.0, 12.0],
        [4.0, 0.03, 75.0],
        [0.25, 0.1, 0.01],
    ),
    model(
        "lambda.7",
        [12.0, 12.0],
        [8.0, 0.03, 112.5],
        [0.25, 0.1, 0.01],
    ),
    model(
        "delta.3",
        [20.0, 20.0],
        [5.0, 0.03, 150.0],
        [0.25, 0.1, 0.02],
    ),
    model("Falcon", [8.0, 8.0], [3.0, 0.02, 40.0], [0.15, 0.5, 0.06]),
];

/// Forces [N]; stiffness, damping and workspace; mass, friction and encoder step.
const fn model(
    name: &'static str,
    force: [f64; 2],
    [stiffness, damping, workspace]: [f64; 3],
    [mass, friction, encoder_step]: [f64; 3],
) -> DeviceModel {
    DeviceModel {
        name,
        force,
        stiffness,
        damping,
        workspace,
        mass,
        friction,
        encoder_step,
    }
}

impl DeviceModel {
    /// The device in a relaxed hand, one tick between a force and its action.
    #[must_use]
    pub fn settings(&self) -> SimulatedSettings {
        let hand = SimulatedSettings::default();
        let [max_force, max_continuous_force] = self.force;
        SimulatedSettings {
            mass: self.mass,
            damping: self.damping,
            friction: self.friction,
            encoder_step: self.encoder_step,
            delay_ticks: 1,
            // critical: 2 sqrt(k m), k in N/m and the result per mm
            hand_damping: 2.0 * (1000.0 * hand.hand_stiffness * self.mass).sqrt() / 1000.0,
            limits: DeviceLimits {
                max_force,
                max_continuous_force,
                damping: self.damping,
                max_stiffness: self.stiffness,
                workspace_radius: self.workspace,
            },
            ..hand
        }
    }
}

/// What the device of sessions without a real one is called.
const SIMULATED: &str = "simulated";

/// Names of all devices: those of the table, and the one of sessions without a real one.
#[must_use]
pub fn device_names() -> Vec<&'static str> {
    let table = DEVICES.iter().map(|device| device.name);
    [SIMULATED].into_iter().chain(table).collect()
}

/// The device of this name in a relaxed hand, if there is one.
#[must_use]
pub fn device_named(name: &str) -> Option<SimulatedSettings> {
    if name == SIMULATED {
        return Some(SimulatedSettings::default());
    }
    let device = DEVICES.iter().find(|device| device.name == name)?;
    Some(device.settings())
}
