//! Whether a tick and what was sent after it kept their guarantees, asked anew at each of them.
//!
//! Who promises is not asked: places are looked up in the voxels again, forces are compared with
//! where device and probe are. That no wall was crossed between two ticks cannot be seen from
//! their ends; `palpate bench stress` looks for that.
//!
//! Frame: scene; mm, N, s. Source: design, section 5, guarantees 1, 3, 5 and 6.

use glam::DVec3;
use palpate_haptics::contact::Proxy;
use palpate_haptics::force::ForceLimits;
use palpate_haptics::scene::TouchScene;
use palpate_haptics::tick::TickOutput;
use palpate_volume::occupancy::Occupancy;

/// Rounding of a force, and of the spring that made it, whose ends are some 1000 mm from the
/// origin.
const OF_FORCE: f64 = 1e-9;
const OF_PLACES: f64 = 1e-12;

/// Whether the probe is out of all that is solid, and the force a push out of it, and none where
/// there is no contact. `alone` says that the force is that of the spring alone, without friction,
/// so that it may not pull at all.
#[must_use]
pub fn keeps_guarantees<O: Occupancy>(
    scene: &TouchScene<'_, O>,
    proxy: &Proxy,
    device: DVec3,
    output: &TickOutput,
    alone: bool,
) -> bool {
    let is_out = !output.violation && scene.solid_at(proxy.point()).is_none();
    is_out && pushes(device, output, alone)
}

fn pushes(device: DVec3, output: &TickOutput, alone: bool) -> bool {
    let force = output.force;
    // a device without a place has no force
    if force == DVec3::ZERO {
        return true;
    }
    let out = output.proxy_in_scene - device;
    let rounding = OF_FORCE * force.length() + OF_PLACES * output.coupling.stiffness * out.length();
    force.is_finite() && output.contact && (!alone || force.dot(out) >= -rounding)
}

/// Whether a force that was sent `dt` [s] after the last one is finite, within its limit, and has
/// grown no faster than it may.
#[must_use]
pub fn is_safe(sent: DVec3, last: DVec3, limits: &ForceLimits, dt: f64) -> bool {
    let rounding = 1.0 + OF_FORCE;
    let most = limits.max_force.min(last.length() + limits.max_growth * dt);
    sent.is_finite() && sent.length() <= most * rounding
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, IVec3, UVec3};
    use palpate_haptics::force::Coupling;
    use palpate_volume::grid::Grid;
    use palpate_volume::segment::Segment;

    use super::*;

    /// The device is 1 mm below the floor at z = 8 mm, the probe on it.
    const DEVICE: DVec3 = DVec3::new(8.0, 8.0, 7.0);

    fn kept(proxy: DVec3, force: DVec3, contact: bool, alone: bool) -> bool {
        let size = UVec3::splat(16);
        let half = DVec3::splat(0.5);
        let grid = Grid::new(size, DVec3::ONE, half, DMat3::IDENTITY).expect("cubes of 1 mm");
        let floor = Segment::from_fn(size, |voxel: IVec3| voxel.z < 8);
        let scene = TouchScene {
            occupancy: floor.occupancy(),
            grid: &grid,
            objects: &[],
        };
        let proxy = Proxy::at(proxy).expect("a point");
        let output = TickOutput {
            proxy_in_scene: proxy.point(),
            contact_point_in_scene: proxy.point(),
            normal: DVec3::Z,
            force,
            spring: force,
            coupling: Coupling {
                stiffness: 1.0,
                damping: 0.0,
            },
            sticks: false,
            held_by: None,
            contact,
            depth: 1.0,
            visits: 0,
            violation: false,
        };
        keeps_guarantees(&scene, &proxy, DEVICE, &output, alone)
    }

    const ON_FLOOR: DVec3 = DVec3::new(8.0, 8.0, 8.0 + 1e-9);

    #[test]
    fn a_push_out_of_the_floor_is_kept_and_each_other_force_is_found() {
        assert!(kept(ON_FLOOR, DVec3::Z, true, true));
        assert!(kept(ON_FLOOR, DVec3::ZERO, false, true));
        assert!(!kept(ON_FLOOR, DVec3::Z, false, true), "without contact");
        assert!(!kept(ON_FLOOR, -1e-6 * DVec3::Z, true, true), "a pull");
        assert!(!kept(ON_FLOOR, DVec3::NAN, true, false));
        // friction holds a probe beside the device back
        let aside = ON_FLOOR + DVec3::X;
        assert!(kept(aside, DVec3::new(-2.0, 0.0, 1.0), true, false));
        assert!(!kept(aside, DVec3::new(-2.0, 0.0, 1.0), true, true));
    }

    #[test]
    fn a_probe_in_the_floor_is_found_whatever_is_felt() {
        assert!(!kept(ON_FLOOR - DVec3::Z, DVec3::ZERO, false, true));
    }

    #[test]
    fn forces_over_the_limit_or_too_fast_are_found() {
        let limits = ForceLimits {
            max_force: 5.0,
            max_growth: 1000.0,
        };
        let is_safe =
            |sent: f64, last: f64| is_safe(DVec3::X * sent, DVec3::X * last, &limits, 1e-3);
        assert!(is_safe(1.0, 0.0) && is_safe(5.0, 4.5) && is_safe(0.0, 5.0));
        assert!(!is_safe(1.1, 0.0) && !is_safe(5.1, 5.0) && !is_safe(f64::NAN, 0.0));
    }
}
