//! A needle's track and tissues in recordings, as they are written and as 0.1 wrote them.

use palpate_haptics::needle::tissues::{Layered, Met, Tissues};
use palpate_haptics::needle::track::Track;
use palpate_volume::tissue::Tissue;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// As 0.1 wrote it: places without a layer too, and one number for layers that overlap.
#[derive(Serialize, Deserialize)]
struct OldTrack {
    layers: [OldLayer; 32],
    count: u8,
    seen: f64,
    wall: Option<(f64, u8)>,
}

#[derive(Clone, Copy, Serialize, Deserialize)]
struct OldLayer {
    from: f64,
    met: OldMet,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum OldMet {
    Nothing,
    Tissue(u16),
    Wall(u8),
}

fn read<T: DeserializeOwned>(value: &impl Serialize) -> T {
    let bytes = rmp_serde::to_vec_named(value).expect("bytes");
    rmp_serde::from_slice(&bytes).expect("a value")
}

#[test]
fn a_track_of_0_1_is_read_with_all_its_layers() {
    let mut layers = [OldLayer {
        from: 0.0,
        met: OldMet::Nothing,
    }; 32];
    layers[1] = OldLayer {
        from: 2.5,
        met: OldMet::Tissue(1 << 15 | 1),
    };
    let track: Track = read(&OldTrack {
        layers,
        count: 2,
        seen: 7.0,
        wall: Some((7.0, 4)),
    });
    assert_eq!(track.met(0), Met::Nothing);
    assert_eq!(track.met(1), Met::Tissue(Layered::of(0).with(15)));
    assert_eq!((track.end(0), track.end(1)), (Some(2.5), None));
    assert_eq!((track.seen(), track.wall()), (7.0, Some((7.0, 4))));
    let again: Track = read(&track);
    assert_eq!(again, track);
    // and 0.1 reads what is written
    let old: OldTrack = read(&track);
    assert_eq!(
        (old.count, old.layers[1].met),
        (2, OldMet::Tissue(1 << 15 | 1))
    );
}

#[test]
fn tissues_of_0_1_are_read_and_all_segments_are_written() {
    let mut old = [None; 16];
    old[0] = Some((7_u8, Tissue::SKIN));
    old[1] = Some((200, Tissue::LIVER));
    let tissues: Tissues = read(&old);
    assert_eq!(
        (tissues.place_of(7), tissues.place_of(200)),
        (Some(0), Some(1))
    );
    assert_eq!(tissues.segments().count(), 2);
    let written: [Option<(u8, Tissue)>; 16] = read(&tissues);
    assert_eq!(written, old);
    let many = Layered::of(3).with(200);
    assert_eq!(read::<Layered>(&many), many);
    let all = Tissues::of((1..=255).map(|segment| (segment, Tissue::FAT)));
    assert_eq!(read::<Tissues>(&all), all);
    assert_eq!(all.segments().count(), 255);
}

#[test]
fn what_no_file_should_hold_is_refused_or_none() {
    #[derive(Serialize)]
    struct Short {
        layers: Vec<u8>,
        count: u16,
        seen: f64,
        wall: Option<(f64, u8)>,
    }
    let track: Track = read(&Short {
        layers: Vec::new(),
        count: 900,
        seen: 1.0,
        wall: None,
    });
    assert_eq!((track.met(0), track.end(0)), (Met::Nothing, None));
}
