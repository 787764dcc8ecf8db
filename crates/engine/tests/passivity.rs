//! Device and servo at their own rates give the hand no energy, and no steps.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests may fail a test, as the tests themselves"
)]

mod common;

use common::grid;
use glam::{DVec3, UVec3};
use palpate_device::simulated::SimulatedSettings;
use palpate_engine::bench::passivity::{Case, DEVICES, Motion, Outcome, Wall, rub};
use palpate_engine::settings::Settings;
use palpate_volume::bits::Bits;
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;

/// Device and servo [Hz].
const RATES: [(u32, u32); 4] = [(4000, 1000), (1000, 4000), (1000, 1000), (4000, 4000)];

struct Floor {
    grid: Grid,
    solid: Bits,
}

impl Floor {
    fn new() -> Self {
        let dimensions = UVec3::new(48, 48, 32);
        let segment = Segment::from_fn(dimensions, |voxel| voxel.z < 16);
        Self {
            grid: grid(dimensions),
            solid: segment.occupancy().clone(),
        }
    }

    fn wall(&self) -> Wall<'_> {
        Wall {
            grid: &self.grid,
            solid: &self.solid,
            point: DVec3::new(24.3, 24.6, 16.0),
            outward: DVec3::Z,
        }
    }
}

fn case(device: SimulatedSettings, (device_hz, servo_hz): (u32, u32), motion: Motion) -> Case {
    Case {
        device,
        device_hz,
        servo_hz,
        settings: Settings::default().within(&device.limits),
        motion,
        seconds: 10.0,
        take_back: true,
    }
}

#[test]
fn at_all_rates_pressing_tapping_and_sliding_give_the_hand_no_energy() {
    let floor = Floor::new();
    for rates in RATES {
        for motion in Motion::ALL {
            let case = case(SimulatedSettings::default(), rates, motion);
            let outcome = rub(&floor.wall(), &case);
            println!("{rates:?} {motion:?} {outcome:?}");
            assert!(
                outcome.contacts > 1 && outcome.contact_share > 0.1,
                "{outcome:?}"
            );
            assert_eq!(outcome.violations, 0);
            assert!(
                outcome.is_passive(&case),
                "{rates:?} {motion:?} {outcome:?}"
            );
        }
    }
}
