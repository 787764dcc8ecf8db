//! Cameras and appearances of which no picture can be drawn are refused.

use glam::DVec3;
use palpate_render::appearance::{Appearance, Blend, Plane, Shown, ShownSegment};
use palpate_render::camera::Camera;

use crate::common::{COLOUR, appearance, parallel};

const BAD: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

#[test]
fn a_camera_with_a_number_that_is_none_is_refused() {
    let good = parallel(DVec3::splat(8.0), DVec3::Z, 40.0);
    assert_eq!(good.check(), Ok(()));
    for bad in BAD {
        let cameras = [
            Camera {
                target: DVec3::new(1.0, bad, 1.0),
                ..good
            },
            Camera {
                distance: bad,
                ..good
            },
            Camera {
                back: DVec3::new(0.0, bad, 1.0),
                ..good
            },
            Camera {
                right: DVec3::new(bad, 0.0, 0.0),
                ..good
            },
            Camera {
                up: DVec3::splat(bad),
                ..good
            },
            Camera { field: bad, ..good },
            Camera {
                parallel: Some(bad),
                ..good
            },
            Camera { aside: bad, ..good },
        ];
        for camera in cameras {
            assert!(camera.check().is_err(), "{camera:?}");
        }
    }
    let askew = Camera {
        up: good.right,
        ..good
    };
    let message = askew.check().unwrap_err().to_string();
    assert!(
        message.contains("unit vectors at right angles"),
        "{message}"
    );
}

fn refused(change: impl Fn(&mut Appearance)) {
    let mut look = appearance(Blend::Shaded, 1.0);
    look.segments.push(ShownSegment {
        id: 1,
        range: Some((1.0, 2.0)),
        is_edited: false,
        shown: Shown::Solid,
        colour: COLOUR,
        ambient: 1.0,
        specular: 1.0,
    });
    look.clip.push(Plane {
        normal: DVec3::X,
        offset: 1.0,
    });
    assert_eq!(look.check(), Ok(()));
    change(&mut look);
    assert!(look.check().is_err(), "{look:?}");
}

#[test]
fn a_transfer_function_that_is_none_is_refused() {
    refused(|look| look.transfer.clear());
    refused(|look| look.transfer.truncate(1));
    refused(|look| look.transfer.reverse());
    refused(|look| look.transfer[1].value = look.transfer[0].value);
    refused(|look| look.transfer[0].extinction = -1.0);
    for bad in BAD {
        refused(|look| look.transfer[0].value = bad);
        refused(|look| look.transfer[1].extinction = bad as f32);
        refused(|look| look.transfer[1].colour.y = bad as f32);
    }
}

#[test]
fn numbers_that_are_none_and_empty_windows_are_refused() {
    refused(|look| look.window.0 = 0.0);
    refused(|look| look.window.0 = -5.0);
    refused(|look| look.slab = Some(0.0));
    refused(|look| look.clip[0].normal = DVec3::ZERO);
    refused(|look| look.segments[0].id = 0);
    for bad in BAD {
        refused(|look| look.window.0 = bad);
        refused(|look| look.window.1 = bad);
        refused(|look| look.iso_value = bad);
        refused(|look| look.iso_colour.x = bad as f32);
        refused(|look| look.tissue_from = bad);
        refused(|look| look.edge_gradient = bad);
        refused(|look| look.density = bad as f32);
        refused(|look| look.slab = Some(bad));
        refused(|look| look.lighting.shininess = bad as f32);
        refused(|look| look.lighting.edges = bad as f32);
        refused(|look| look.clip[0].offset = bad);
        refused(|look| look.segments[0].colour.z = bad as f32);
        refused(|look| look.segments[0].ambient = bad as f32);
        refused(|look| look.segments[0].specular = bad as f32);
    }
    refused(|look| look.segments[0].range = Some((f64::NAN, 1.0)));
}
