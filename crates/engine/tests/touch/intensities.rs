//! The force of segments that a threshold made comes from the scan's values: it knows no stairs,
//! follows a threshold between voxels, and leaves masks and edited voxels as they are.

use crate::common::*;
use glam::{DAffine3, DMat3, DVec3, IVec3, UVec3};
use palpate_engine::replay::{ReplayEnd, Tape, TapeColumns, replay};
use palpate_engine::scene::Properties;
use palpate_engine::session::{Reference, Session, SessionConfig};
use palpate_engine::touch::Settings;
use palpate_haptics::smooth::Smoothing;
use palpate_volume::edit::SegmentId;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::threshold::threshold;
use palpate_volume::voxel_box::VoxelBox;

/// Voxels of 1 mm, so that h is 1 mm.
const DIMENSIONS: UVec3 = UVec3::new(72, 40, 40);
/// A point of the plane.
const MIDDLE: DVec3 = DVec3::new(36.0, 20.3, 20.2);
/// Half way between nothing and the body.
const HALF: (f64, f64) = (500.0, 3000.0);
/// How far the values go from 1000 to 0 across the plane [mm].
const WIDTH: f64 = 2.0;
const DEPTH: f64 = 2.0;
const STIFFNESS: f64 = 0.5;
/// Along x, in voxels.
const WAY: std::ops::Range<i32> = 12..60;

/// Out of the plane, 5° about y from z.
fn outward() -> DVec3 {
    DMat3::from_rotation_y(5_f64.to_radians()) * DVec3::Z
}

/// Half a space, with partial volumes at its surface.
fn scan() -> Intensities {
    let values: Vec<i16> = VoxelBox::of_dimensions(DIMENSIONS)
        .voxels()
        .map(|voxel| {
            let distance = outward().dot(voxel.as_dvec3() + 0.5 - MIDDLE);
            (1000.0 * (0.5 - distance / WIDTH).clamp(0.0, 1.0)) as i16
        })
        .collect();
    Intensities::new(DIMENSIONS, values, 1.0, 0.0).unwrap()
}

/// A device that slides along x under the plane, 0.2 mm a tick, after it has come down to it.
fn slide() -> Vec<[f64; 4]> {
    let along = DVec3::Y.cross(outward());
    let foot = |x: i32| MIDDLE + along * ((f64::from(x) - MIDDLE.x) / along.x);
    let start = foot(WAY.start) + outward() * 4.0;
    let mut path = vec![[0.0, start.x, start.y, start.z]];
    for (step, x) in WAY.enumerate() {
        let device = foot(x) - outward() * DEPTH;
        path.push([0.1 + 5e-3 * step as f64, device.x, device.y, device.z]);
    }
    path
}

fn session(segment: Segment, made_by: Option<(f64, f64)>, smoothing: Smoothing) -> Session {
    let config = offline(
        DIMENSIONS,
        segment.clone(),
        scripted(&slide()),
        Reference::Scene,
    );
    let settings = Settings {
        stiffness: STIFFNESS,
        damping: 0.0,
        smoothing,
        ..Settings::default()
    };
    started(SessionConfig {
        segments: vec![(segment, Properties::of_threshold(true, made_by))],
        intensities: scan(),
        settings,
        mask_fractions: true,
        ..config
    })
}

fn of_threshold(range: (f64, f64)) -> Segment {
    threshold(&scan(), None, range.0, range.1)
}

/// How high above the plane the force comes from while the device slides from `first` to `last`
/// [mm along x].
fn heights(session: &Session, first: f64, last: f64) -> Vec<f64> {
    session.start_recording().unwrap();
    session.run(0.34).unwrap();
    let recording = session.stop_recording().unwrap();
    let ticks = recording.device.iter().zip(&recording.force);
    ticks
        .filter(|(device, _)| (first..last).contains(&device.x))
        .map(|(device, force)| outward().dot(*device + *force / STIFFNESS - MIDDLE))
        .collect()
}

fn mean(heights: &[f64]) -> f64 {
    heights.iter().sum::<f64>() / heights.len() as f64
}

/// Root mean square about the mean [mm].
fn ripple(heights: &[f64]) -> f64 {
    let middle = mean(heights);
    let square = |height: &f64| (height - middle).powi(2);
    (heights.iter().map(square).sum::<f64>() / heights.len() as f64).sqrt()
}

/// The stretch away from both ends.
const INNER: (f64, f64) = (18.0, 56.0);

#[test]
fn a_plane_of_5_degrees_has_no_stairs_where_a_threshold_made_it() {
    let felt = |made_by, smoothing| {
        let session = session(of_threshold(HALF), made_by, smoothing);
        let heights = heights(&session, INNER.0, INNER.1);
        assert!(heights.len() > 150, "{} ticks", heights.len());
        (ripple(&heights), mean(&heights))
    };
    let (intensities, height) = felt(Some(HALF), Smoothing::Intensities);
    // the goal of the design for planes
    assert!(intensities < 0.05, "{intensities} h");
    // no bias: a twentieth of a voxel, as the ripple
    assert!(height.abs() < 0.05, "{height} mm");
    // nor where the same voxels are an imported mask
    let (mask, height) = felt(None, Smoothing::Intensities);
    assert!(mask < 0.05, "{mask} h");
    assert!(height.abs() < 0.1, "{height} mm");
    // the bits alone, on request, have some
    let (bits, _) = felt(Some(HALF), Smoothing::Bits);
    assert!(bits > 2.0 * intensities.max(mask), "{bits} h");
    assert_eq!(felt(None, Smoothing::Bits).0, bits);
    // and stairs are stairs
    let (stairs, _) = felt(Some(HALF), Smoothing::Off);
    assert!(stairs > 2.0 * bits, "{stairs} h, {bits} h");
}

/// A threshold that is dragged: limits and voxels change at once, and the surface goes where the
/// values say, by less than a voxel.
#[test]
fn the_surface_follows_a_threshold_between_voxels() {
    for step in 0..6 {
        let low = 400.0 + 40.0 * f64::from(step);
        let session = session(of_threshold(HALF), Some(HALF), Smoothing::Intensities);
        let id = SegmentId(1);
        session.threshold(Some(id), (low, HALF.1)).unwrap();
        let heights = heights(&session, INNER.0, INNER.1);
        let expected = WIDTH * (500.0 - low) / 1000.0;
        assert!(ripple(&heights) < 0.05, "{low}: {} h", ripple(&heights));
        // as above
        let height = mean(&heights);
        assert!(
            (height - expected).abs() < 0.05,
            "{low}: {height} mm for {expected} mm"
        );
    }
}

/// A segment that was moved is a body of its own, in whose grid the same values hold.
#[test]
fn a_moved_segment_takes_its_shares_along() {
    let session = session(of_threshold(HALF), Some(HALF), Smoothing::Intensities);
    let up = 0.37 * outward();
    let pose = DAffine3::from_translation(up);
    session.move_segment(SegmentId(1), pose).unwrap();
    let heights = heights(&session, INNER.0, INNER.1);
    // as above
    assert!(ripple(&heights) < 0.05, "{} h", ripple(&heights));
    let height = mean(&heights);
    assert!((height - 0.37).abs() < 0.05, "{height} mm");
}

#[test]
fn a_segment_that_was_edited_keeps_its_shares_where_it_was_not_and_undo_brings_all_back() {
    let edited = |undo: bool| {
        let session = session(of_threshold(HALF), Some(HALF), Smoothing::Intensities);
        let id = SegmentId(1);
        // one voxel of the surface is taken away and one beyond it put on, far from each other
        let (hole, speck) = (IVec3::new(24, 20, 20), IVec3::new(30, 20, 24));
        session
            .fill_box(id, hole, hole + IVec3::new(2, 2, 2), false)
            .unwrap();
        session
            .fill_box(id, speck, speck + IVec3::ONE, true)
            .unwrap();
        assert_eq!(session.segments().unwrap()[0].range, None);
        if undo {
            while session.undo().unwrap() {}
            assert_eq!(session.segments().unwrap()[0].range, Some(HALF));
        }
        session
    };
    let plain = session(of_threshold(HALF), Some(HALF), Smoothing::Intensities);
    let plain = heights(&plain, INNER.0, INNER.1);
    assert_eq!(heights(&edited(true), INNER.0, INNER.1), plain);
    // 40 mm on: beyond the window of all edits
    let far = heights(&edited(false), 46.0, INNER.1);
    let as_far = &plain[plain.len() - far.len()..];
    assert!(far.len() > 40);
    assert_eq!(far, as_far);
    assert_ne!(heights(&edited(false), INNER.0, INNER.1), plain);
}

/// Half of the plane is a mask, half a threshold's: each is as it is alone, away from where they
/// meet, and the force makes no step there.
#[test]
fn a_mask_beside_a_threshold_keeps_its_own_surface() {
    let whole = of_threshold(HALF);
    let meet = MIDDLE.x as i32;
    let half = |first: bool| {
        Segment::from_fn(DIMENSIONS, |voxel| {
            whole.contains(voxel) && (voxel.x < meet) == first
        })
    };
    // the first half is what is left of the threshold after an edit
    let mixed = session(half(true), Some(HALF), Smoothing::Intensities);
    mixed.add_segment(half(false), OBSTACLE, false).unwrap();
    let mixed = heights(&mixed, INNER.0, INNER.1);
    let alone = [Some(HALF), None].map(|made_by| {
        let session = session(of_threshold(HALF), made_by, Smoothing::Intensities);
        heights(&session, INNER.0, INNER.1)
    });
    // half a window of 8 cells of 2 voxels, and the way a tick's limit takes to fade
    let away = 60;
    let middle = mixed.len() * 18 / 38;
    assert_eq!(mixed[..middle - away], alone[0][..middle - away]);
    // the end of the mask is worked out too, and flat slopes carry far
    for (mixed, alone) in mixed[middle + away..]
        .iter()
        .zip(&alone[1][middle + away..])
    {
        assert!((mixed - alone).abs() < 0.05, "{mixed} mm, alone {alone} mm");
    }
    assert_ne!(alone[0][middle + away..], alone[1][middle + away..]);
    for pair in mixed.windows(2) {
        // the hand's move and a tenth of a voxel
        assert!((pair[1] - pair[0]).abs() < 0.3 + 1e-9);
    }
}

/// A recording that begins in a contact, and while a threshold is dragged, is a file of its own:
/// of the scan it holds what the servo read since, and that is enough.
#[test]
fn a_recording_holds_the_values_that_its_replay_needs() {
    let session = session(of_threshold(HALF), Some(HALF), Smoothing::Intensities);
    session.run(0.2).unwrap();
    session.start_recording().unwrap();
    for step in 0..10 {
        session.run(0.013).unwrap();
        let low = 500.0 - 20.0 * f64::from(step % 4);
        session
            .threshold(Some(SegmentId(1)), (low, HALF.1))
            .unwrap();
    }
    let (recording, tape) = session.finish_recording().unwrap();
    assert!(recording.contact.iter().all(|touches| *touches));
    let columns = TapeColumns::from(&tape.unwrap());
    // what goes on afterwards is not in it
    session.run(0.05).unwrap();
    let bricks = (DIMENSIONS / 8).as_usizevec3().element_product();
    let kept = columns.values.index.len();
    assert!(kept > 3 && kept < bricks / 4, "{kept} of {bricks} bricks");
    let outcome = replay(&recording, &Tape::try_from(&columns).unwrap()).unwrap();
    assert!(outcome.is_equal(), "{:?}", outcome.first_difference);
    assert_eq!(outcome.end, ReplayEnd::Whole);

    // also where a resting hand makes nothing new
    let session = self::session(of_threshold(HALF), Some(HALF), Smoothing::Intensities);
    session.run(0.6).unwrap();
    session.start_recording().unwrap();
    session.run(0.05).unwrap();
    let (rest, tape) = session.finish_recording().unwrap();
    let at_rest = TapeColumns::from(&tape.unwrap());
    let outcome = replay(&rest, &Tape::try_from(&at_rest).unwrap()).unwrap();
    assert!(outcome.is_equal(), "{:?}", outcome.first_difference);

    // other values are another scan
    let mut other = columns;
    for brick in &mut other.values.stored {
        *brick = brick.map(|stored| stored / 2 + 300);
    }
    let outcome = replay(&recording, &Tape::try_from(&other).unwrap()).unwrap();
    assert!(!outcome.is_equal());
}
