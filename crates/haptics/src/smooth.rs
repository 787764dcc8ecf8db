//! The smooth contact point beside the hard proxy: where the force comes from.
//!
//! Frame: grid at the door; inside, mm along the axes of the grid.

pub mod blur;
pub mod field;
mod window;

use crate::proxy::Proxy;
use field::Field;
use glam::DVec3;
use palpate_volume::grid::Grid;

/// How the smooth point is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smoother {
    /// Most samples of a field per tick.
    pub max_steps: u32,
    /// Converged: the last step was shorter [h].
    pub tolerance: f64,
    /// Longest step [cells].
    pub trust: f64,
    /// Farthest from the proxy [cells].
    pub reach: f64,
    /// On or off.
    pub enabled: bool,
}

impl Default for Smoother {
    fn default() -> Self {
        Self {
            max_steps: 8,
            tolerance: 1e-3,
            trust: 0.75,
            reach: 1.25,
            enabled: true,
        }
    }
}

/// What changes from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SmoothState {
    /// From the device to the contact point [mm], grid axes.
    offset: DVec3,
    device: DVec3,
    started: bool,
}

/// The smooth contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SmoothContact {
    /// Grid frame.
    pub point_in_grid: DVec3,
    /// Outward; mm axes of the grid.
    pub normal: DVec3,
    /// From the device to the point.
    pub depth_mm: f64,
    /// Share of the smooth point beside the proxy.
    pub weight: f64,
    /// Before the limit.
    pub target: DVec3,
    /// Samples taken.
    pub samples: u32,
}

impl Smoother {
    /// The contact point for this tick.
    pub fn contact_point(
        &self,
        field: &impl Field,
        grid: &Grid,
        proxy: &Proxy,
        device_in_grid: DVec3,
        state: &mut SmoothState,
    ) -> SmoothContact {
        let spacing = grid.spacing();
        let h = grid.smallest_spacing();
        let device = device_in_grid * spacing;
        let hard = proxy.point() * spacing;
        let (smooth, weight, samples) = self.descend(field, spacing, hard, device);
        let target = (smooth - device) * weight + (hard - device) * (1.0 - weight);

        // never a step of the force beyond the hand's motion and a tenth of a voxel
        let moved = if state.started {
            (device_in_grid - state.device) * spacing
        } else {
            DVec3::ZERO
        };
        let allowed = moved.length() + 0.1 * h;
        let change = target - state.offset;
        let offset = if change.length() <= allowed {
            target
        } else {
            state.offset + change * (allowed / change.length())
        };
        *state = SmoothState {
            offset,
            device: device_in_grid,
            started: true,
        };
        SmoothContact {
            point_in_grid: device_in_grid + offset / spacing,
            normal: offset.normalize_or_zero(),
            depth_mm: offset.length(),
            weight,
            target,
            samples,
        }
    }

    fn descend(
        &self,
        field: &impl Field,
        spacing: DVec3,
        hard: DVec3,
        device: DVec3,
    ) -> (DVec3, f64, u32) {
        let sigma = field.sigma() * spacing;
        let cell = field.cell() * spacing;
        let mut at = hard;
        let mut last = DVec3::ZERO;
        let mut ease = 1.0;
        let mut weight = 1.0;
        for sample in 0..self.max_steps {
            let here = field.sample(at / spacing);
            let gradient = here.gradient / spacing;
            let steepness = gradient.length();
            if steepness * sigma.min_element() < 1e-3 {
                return (at, if sample == 0 { 0.0 } else { weight }, sample + 1);
            }
            let outward = -gradient / steepness;
            let sigma_n = (sigma * outward).length();
            let ratio = (here.value - 0.5) / (steepness * sigma_n);
            let depth = sigma_n * ratio / (1.0 + ratio * ratio / 3.0).sqrt();
            if sample == 0 {
                let far = depth.abs() / (cell * outward).length();
                weight = 1.0 - smoothstep((far - 0.6) / 0.5);
                if weight == 0.0 {
                    return (at, 0.0, 1);
                }
            }
            // onto the tangent plane, as near to the device as the free side allows
            let under = depth - outward.dot(device - at);
            let goal = device + outward * under.max(0.0);
            let mut step = goal - at;
            let length = (step / cell).length();
            if length > self.trust {
                step *= self.trust / length;
            }
            if step.dot(last) < 0.0 {
                ease *= 0.5;
            }
            step *= ease;
            let from_hard = at + step - hard;
            let distance = (from_hard / cell).length();
            let next = if distance > self.reach {
                hard + from_hard * (self.reach / distance)
            } else {
                at + step
            };
            let moved = next - at;
            at = next;
            last = moved;
            if moved.length() < self.tolerance * spacing.min_element() {
                return (at, weight, sample + 1);
            }
        }
        (at, weight, self.max_steps)
    }
}

fn smoothstep(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
