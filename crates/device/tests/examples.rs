//! The example of `docs/extend/adding-a-device.md` does what the page says.

#[path = "../examples/udp_device.rs"]
mod udp_device;

use std::net::UdpSocket;
use std::time::{Duration, Instant};

use glam::DVec3;
use palpate_device::simulated::SimulatedSettings;
use palpate_device::velocity_estimate::VelocityEstimate;
use palpate_device::{DeviceLimits, DeviceState, HapticDevice};
use udp_device::UdpDevice;

/// So that what is lost fails the test and does not hang it, on a machine however busy.
const PATIENCE: Duration = Duration::from_secs(60);

/// A device and the other end of its line.
fn connected() -> (UdpDevice, UdpSocket) {
    let [ours, theirs] = [(); 2].map(|()| UdpSocket::bind("127.0.0.1:0").expect("a port"));
    let address = |socket: &UdpSocket| socket.local_addr().expect("an address");
    ours.connect(address(&theirs)).expect("a line");
    theirs.connect(address(&ours)).expect("a line");
    ours.set_nonblocking(true)
        .expect("a socket that never waits");
    theirs
        .set_read_timeout(Some(PATIENCE))
        .expect("a time limit");
    let device = UdpDevice {
        socket: ours,
        limits: DeviceLimits {
            max_force: 3.0,
            ..SimulatedSettings::default().limits
        },
        velocity: VelocityEstimate::new(DVec3::ZERO, 0.0),
        state: DeviceState::default(),
    };
    (device, theirs)
}

#[test]
fn the_example_reads_the_newest_place_and_sends_no_more_than_it_bears() {
    udp_device::main();
    let (mut device, theirs) = connected();
    assert_eq!(device.read(0.001).position, DVec3::ZERO);

    for text in ["0.5 0 0", "0.01 0.02 0", "nan 0 0", "no place"] {
        theirs.send(text.as_bytes()).expect("sent");
    }
    let expected = DVec3::new(10.0, 20.0, 0.0);
    // the system delivers when it likes
    let start = Instant::now();
    let mut state = device.read(0.001);
    while state.position != expected {
        assert!(start.elapsed() < PATIENCE, "the newest place never came");
        std::thread::yield_now();
        state = device.read(0.001);
    }
    assert!(state.velocity.is_finite() && device.name() == "udp");

    device.write(DVec3::Z * 99.0, DVec3::ZERO);
    let mut text = [0; 96];
    let length = theirs.recv(&mut text).expect("a force");
    assert_eq!(&text[..length], b"0 0 -3");
}
