//! The needle's law on layers across the z axis, without a servo around it.

use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_haptics::force::Coupling;
use palpate_haptics::needle::events::EventKind;
use palpate_haptics::needle::stretches::NeedleBody;
use palpate_haptics::needle::tissues::{Layered, Met, NeedleScan, TissueMap, Tissues};
use palpate_haptics::needle::{Needle, NeedleForces, NeedleInput};
use palpate_haptics::scene::Solid;
use palpate_haptics::tick::TickOutput;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::tissue::Tissue;

pub const SKIN: u8 = 1;
pub const FAT: u8 = 2;
pub const LIVER: u8 = 3;
pub const BONE: u8 = 4;
/// Where each layer begins [mm]; the last goes on for ever.
pub const LAYERS: [(f64, u8); 4] = [(10.0, SKIN), (14.0, FAT), (30.0, LIVER), (60.0, BONE)];
pub const COUPLING: Coupling = Coupling {
    stiffness: 1.0,
    damping: 0.0,
};

/// Layers below z = 10, and whether those that were punctured are open.
pub struct Body {
    pub open: bool,
    /// What an edit has put instead, from a plane z to another one [voxels]; nothing where it is 0.
    pub edit: Option<([i32; 2], u8)>,
}

impl TissueMap for Body {
    fn at(&self, _body: usize, voxel: IVec3, tissues: &Tissues) -> Met {
        let above = LAYERS
            .iter()
            .take_while(|(from, _)| *from <= f64::from(voxel.z));
        let edited = self
            .edit
            .filter(|([from, to], _)| (*from..*to).contains(&voxel.z));
        let id = edited.map_or_else(|| above.last().map_or(0, |(_, id)| *id), |(_, id)| id);
        match id {
            0 => Met::Nothing,
            id => tissues
                .place_of(id)
                .map_or(Met::Wall(id), |place| Met::Tissue(Layered::of(place))),
        }
    }

    fn body(&self, _number: usize) -> Option<NeedleBody<'_>> {
        None
    }

    fn is_open(&self) -> bool {
        self.open
    }
}

/// A needle with a hard proxy that stops at the first layer which is not punctured.
pub struct Bench {
    grid: Grid,
    pub needle: Needle,
    tissues: Tissues,
    pub last: DVec3,
    now: f64,
    edit: Option<([i32; 2], u8)>,
}

/// One tick: the spring's force [N] and what holds the needle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Felt {
    pub force: DVec3,
    pub parts: NeedleForces,
    pub tip: Option<f64>,
}

impl Bench {
    pub fn new() -> Self {
        let tissues = Tissues::of([
            (SKIN, Tissue::SKIN),
            (FAT, Tissue::FAT),
            (LIVER, Tissue::LIVER),
        ]);
        let mut needle = Needle::default();
        needle.hold(true, &tissues);
        let grid = Grid::new(
            UVec3::splat(80),
            DVec3::ONE,
            DVec3::splat(0.5),
            DMat3::IDENTITY,
        );
        Self {
            grid: grid.expect("a grid"),
            needle,
            tissues,
            last: DVec3::ZERO,
            now: 0.0,
            edit: None,
        }
    }

    pub fn tick(&mut self, device: DVec3) -> Felt {
        self.now += 1e-3;
        let map = Body {
            open: self.needle.punctured() != Default::default(),
            edit: self.edit,
        };
        let scan = NeedleScan {
            grid: &self.grid,
            map: &map,
        };
        let input = NeedleInput {
            device,
            velocity: (device - self.last) / 1e-3,
            coupling: COUPLING,
            spacing: 1.0,
            time: self.now,
            dt: self.needle.pass(self.now),
        };
        self.last = device;
        let tool = self.needle.lead(&input, scan);
        let (mut output, holder) = match tool.unwrap_or(device) {
            to if to.length() < 1e6 => self.hard(to),
            // touch has no input
            _ => (self.hard(DVec3::ZERO).0, None),
        };
        self.needle.follow(&input, holder, scan, &mut output);
        Felt {
            force: output.force,
            parts: self.needle.forces(),
            tip: self.needle.insertion().map(|insertion| insertion.shaft.tip),
        }
    }

    /// The hard contact of a probe that is led to a point.
    fn hard(&self, to: DVec3) -> (TickOutput, Option<u8>) {
        let punctured = self.needle.punctured();
        let holder = LAYERS
            .iter()
            .find(|(_, id)| !punctured.contains(SegmentId(*id)));
        let holder = holder.filter(|(from, _)| to.z > *from);
        let proxy = holder.map_or(to, |(from, _)| to.with_z(*from));
        let output = TickOutput {
            proxy_in_scene: proxy,
            contact_point_in_scene: proxy,
            normal: DVec3::NEG_Z,
            force: COUPLING.force(proxy - to, DVec3::ZERO),
            spring: proxy - to,
            coupling: COUPLING,
            sticks: true,
            held_by: holder.map(|(from, _)| Solid::of_world(IVec3::Z * *from as i32)),
            contact: holder.is_some(),
            depth: proxy.distance(to),
            visits: 1,
            violation: false,
        };
        (output, holder.map(|(_, id)| *id))
    }

    /// Goes straight to a point at a speed [mm/s].
    pub fn go(&mut self, to: DVec3, speed: f64) -> Vec<Felt> {
        let (from, way) = (self.last, to - self.last);
        let ticks = (way.length() / speed * 1000.0).round().max(1.0) as u32;
        (1..=ticks)
            .map(|tick| self.tick(from + way * f64::from(tick) / f64::from(ticks)))
            .collect()
    }

    pub fn events(&self) -> Vec<(EventKind, u8)> {
        let events = self.needle.events().since(0);
        events.map(|event| (event.kind, event.segment)).collect()
    }
}

/// Forces that hold a needle 42 mm deep half a second after an edit, and the events since.
fn edited(edit: Option<([i32; 2], u8)>) -> (NeedleForces, usize) {
    let mut bench = inserted(42.0);
    let before = bench.events().len();
    bench.edit = edit;
    // on by as much as bends the bristle
    let felt = bench.go(AT.with_z(44.0), 4.0);
    (
        felt.last().expect("some ticks").parts,
        bench.events().len() - before,
    )
}

#[test]
fn what_is_cut_away_behind_the_tip_holds_the_shaft_no_more() {
    let (whole, _) = edited(None);
    let (cut, events) = edited(Some(([14, 30], 0)));
    // the fat beside the shaft is gone, skin and liver still hold it; nothing has happened to the tip
    let fat = 16.0 * Tissue::FAT.friction;
    assert!(
        (whole.friction - cut.friction - fat).abs() < 0.1 * fat,
        "{} {}",
        whole.friction,
        cut.friction
    );
    assert!((whole.cutting - cut.cutting).abs() < 1e-9);
    assert_eq!(events, 0);
}

#[test]
fn what_is_put_behind_the_tip_holds_the_shaft() {
    let (whole, _) = edited(None);
    let (filled, events) = edited(Some(([14, 30], SKIN)));
    let more = 16.0 * (Tissue::SKIN.friction - Tissue::FAT.friction);
    assert!(
        (filled.friction - whole.friction - more).abs() < 0.1 * more,
        "{} {}",
        whole.friction,
        filled.friction
    );
    assert_eq!(events, 0);
    // bone around the shaft neither stops the tip nor rubs
    let (bone, events) = edited(Some(([14, 30], BONE)));
    assert!(bone.friction < whole.friction && bone.wall == 0.0 && events == 0);
}

#[test]
fn what_is_cut_away_at_the_tip_leaves_it_free_and_bone_before_it_stops_it() {
    let (free, _) = edited(Some(([30, 60], 0)));
    assert_eq!(free.cutting, 0.0);
    let mut bench = inserted(42.0);
    let insertion = *bench.needle.insertion().unwrap();
    let (entry, tip) = (insertion.line.entry.z, insertion.shaft.tip);
    let plane = (entry + tip).ceil() as i32 + 1;
    bench.edit = Some(([plane, plane + 1], BONE));
    bench.go(AT.with_z(42.0 + 0.5), 1.0);
    bench.go(AT.with_z(50.0), 10.0);
    let now = bench.needle.insertion().unwrap().shaft.tip;
    assert!(
        entry + now <= f64::from(plane) + 1e-6,
        "{entry} {now} {plane}"
    );
    assert!(bench.needle.forces().wall > 0.0);
}

pub const AT: DVec3 = DVec3::new(40.2, 40.3, 0.0);

fn inserted(depth: f64) -> Bench {
    let mut bench = Bench::new();
    bench.last = AT;
    bench.go(AT.with_z(depth), 10.0);
    bench
}

#[test]
fn each_layer_yields_is_punctured_and_is_cut_and_bone_stops_the_needle() {
    let mut bench = Bench::new();
    bench.last = AT;
    let way = bench.go(AT.with_z(75.0), 10.0);
    use EventKind::{Punctured, Stopped};
    assert_eq!(
        bench.events(),
        [
            (Punctured, SKIN),
            (Punctured, FAT),
            (Punctured, LIVER),
            (Stopped, BONE)
        ]
    );
    // each part is what its tissue allows
    for felt in &way {
        assert!(felt.parts.stiffness <= Tissue::SKIN.puncture + 0.02);
        assert!(felt.parts.cutting <= Tissue::LIVER.cutting + 1e-9);
        assert!(felt.tip.is_none_or(|tip| tip + 10.0 <= 60.0), "{felt:?}");
        assert!(felt.force.is_finite() && felt.force.x == 0.0);
    }
    // pressing on against bone, the coupling alone gives
    let last = way.last().expect("a way");
    let over = 75.0 - 60.0;
    assert!(
        (last.force.z + over * COUPLING.stiffness).abs() < 1e-6,
        "{last:?}"
    );
    let parts = last.parts;
    let sum = parts.stiffness + parts.cutting + parts.friction + parts.wall;
    assert!((sum - over).abs() < 1e-6, "{parts:?}");
}

#[test]
fn the_force_rises_to_the_puncture_falls_and_rises_again_at_the_next_capsule() {
    let mut bench = Bench::new();
    bench.last = AT;
    let way = bench.go(AT.with_z(50.0), 10.0);
    let force: Vec<f64> = way.iter().map(|felt| -felt.force.z).collect();
    let event = |segment: u8| {
        let mut events = bench.needle.events().since(0);
        let event = events
            .find(|event| event.segment == segment)
            .expect("an event");
        (event.time * 1000.0).round() as usize
    };
    let (skin, liver) = (event(SKIN), event(LIVER));
    let peak = |around: usize| {
        let (low, high) = (around - 50, around + 1);
        force[low..high].iter().copied().fold(0.0, f64::max)
    };
    // a tick of 0.01 mm at 1 N/mm beyond the threshold
    assert!((peak(skin) - Tissue::SKIN.puncture).abs() < 0.02);
    assert!(peak(liver) > Tissue::LIVER.puncture);
    assert!(force[skin + 5] < 0.5 * peak(skin));
    assert!(force[liver + 5] < peak(liver) - 0.4);
    let between = force[skin + 5..liver]
        .iter()
        .copied()
        .fold(f64::INFINITY, f64::min);
    assert!(between < 0.6, "{between}");
}

#[test]
fn half_the_speed_gives_the_same_force_at_the_same_depth() {
    let run = |speed: f64| {
        let mut bench = Bench::new();
        bench.last = AT;
        bench.go(AT.with_z(58.0), speed)
    };
    let (fast, slow) = (run(10.0), run(5.0));
    let mut apart = 0_u32;
    for (tick, felt) in fast.iter().enumerate() {
        let same = slow[2 * tick + 1];
        // what a tip relaxes in a millisecond, and the step between two ticks
        if (felt.force.z - same.force.z).abs() > 0.02 {
            apart += 1;
        }
    }
    // a puncture may come some ticks earlier in one of them: three layers
    assert!(apart < 30, "{apart}");
}

#[test]
fn a_needle_that_is_drawn_back_feels_friction_only_and_comes_out() {
    let mut bench = inserted(50.0);
    let way = bench.go(AT.with_z(0.0), 10.0);
    let most =
        4.0 * Tissue::SKIN.friction + 16.0 * Tissue::FAT.friction + 20.0 * Tissue::LIVER.friction;
    // once the bristles and the tissue ahead have straightened
    for felt in &way[600..] {
        assert_eq!(felt.parts.cutting + felt.parts.stiffness, 0.0);
        // it pulls the hand in, never by more than the shaft's friction
        assert!((0.0..=most + 1e-9).contains(&felt.force.z), "{felt:?}");
    }
    assert!(way[700].force.z > 0.3);
    assert_eq!(way.last().expect("a way").force, DVec3::ZERO);
    assert!(bench.needle.insertion().is_none());
    assert_eq!(bench.events().last(), Some(&(EventKind::Withdrawn, 0)));
    // the channel closes: the next time the skin is punctured again
    bench.go(AT.with_z(20.0), 10.0);
    let skins = bench
        .events()
        .iter()
        .filter(|event| **event == (EventKind::Punctured, SKIN))
        .count();
    assert_eq!(skins, 2);
}

#[test]
fn at_rest_the_force_relaxes_and_then_stays_to_the_bit() {
    let mut bench = inserted(45.0);
    let first = bench.tick(bench.last);
    let mut resting = first;
    for _ in 0..30_000 {
        let next = bench.tick(bench.last);
        // it only ever falls
        assert!(next.force.z >= resting.force.z - 1e-12);
        resting = next;
    }
    let lost = Tissue::LIVER.relaxation * Tissue::LIVER.cutting;
    let fell = resting.force.z - first.force.z;
    // the coupling gives a little as the tissue does, so that it loses less than it would alone
    assert!(fell > 0.5 * lost && fell <= lost + 1e-9, "{fell} of {lost}");
    for _ in 0..100 {
        assert_eq!(bench.tick(bench.last), resting);
    }
}

#[test]
fn beside_its_line_the_needle_is_pulled_back_and_goes_no_deeper() {
    let mut bench = inserted(45.0);
    let tip = bench.needle.insertion().expect("it is in").shaft.tip;
    let way = bench.go(bench.last + DVec3::X * 8.0, 20.0);
    let felt = way.last().expect("a way");
    let after = felt.tip.expect("it is in");
    // it relaxes for 0.4 s
    assert!((after - tip).abs() < 0.1, "{tip} {after}");
    // coupling and tissue in a row; the cut ends somewhere before the tip, in the liver
    let pulled = |liver: f64| {
        let shallow = 4.0 * Tissue::SKIN.lateral + 16.0 * Tissue::FAT.lateral;
        let lateral = shallow + liver * Tissue::LIVER.lateral;
        8.0 * lateral / (1.0 + lateral)
    };
    let pull = -felt.force.x;
    assert!((pulled(9.0)..pulled(14.0)).contains(&pull), "{felt:?}");
    assert!((felt.parts.lateral - -felt.force.x).abs() < 1e-6);
    for two in way.windows(2) {
        // 20 mm/s are 0.02 mm in a tick
        assert!((two[1].force - two[0].force).length() < 0.021);
    }
}

#[test]
fn around_a_turn_the_friction_goes_through_zero_without_a_jump() {
    let mut bench = inserted(45.0);
    for step in 0..400 {
        let back = 0.6 * (f64::from(step) * 0.05).sin();
        let before = bench.tick(bench.last).force;
        let after = bench.tick(AT.with_z(45.0 - back)).force;
        // the fastest step is 0.03 mm
        assert!((after - before).length() <= 0.031, "{before} {after}");
    }
}

#[test]
fn a_device_that_is_nowhere_gives_no_force_and_comes_back_from_nothing() {
    let mut bench = inserted(45.0);
    let here = bench.last;
    let before = bench.tick(here);
    for nonsense in [DVec3::NAN, DVec3::INFINITY, DVec3::splat(1e300)] {
        let felt = bench.tick(nonsense);
        assert_eq!(felt.force, DVec3::ZERO);
        assert_eq!(bench.needle.insertion().map(|i| i.shaft.tip), before.tip);
    }
    let first = bench.tick(here).force.length();
    assert!(first <= 0.02 + 1e-9, "{first}");
}

#[test]
fn without_the_needle_the_hard_contact_is_felt_as_it_was() {
    let mut bench = Bench::new();
    bench.needle.hold(false, &bench.tissues.clone());
    let felt = bench.tick(AT.with_z(13.0));
    assert_eq!(felt.force, DVec3::Z * -3.0);
    assert!(bench.events().is_empty());
}
