//! A needle as the servo knows it: what its voxels mean to the law of `palpate_haptics::needle`,
//! and what the simulation is told.
//!
//! Each moved segment is a body of its own, met where it stands by now.
//! Frame: scene [mm] and grid; N, s.

use glam::{DVec3, IVec3};
use palpate_deform::lattice::NeedleDrag;
use palpate_haptics::needle::approach::TIP_STICKS;
use palpate_haptics::needle::events::{Events, NeedleEvent};
use palpate_haptics::needle::insertion::Insertion;
use palpate_haptics::needle::press::Press;
use palpate_haptics::needle::stretches::NeedleBody;
use palpate_haptics::needle::tissues::{Layered, Met, TissueMap, Tissues};
use palpate_haptics::needle::{Needle, NeedleForces};
use palpate_volume::edit::SegmentId;
use palpate_volume::segment_set::SegmentSet;

use crate::touch::contact_model::Model;
use crate::touch::part::Part;
use crate::touch::settings::Settings;
use crate::touch::touchable::Touchable;

/// Friction of a tip that slides.
const TIP_SLIDES: f64 = 1.5;

/// Touch with a sharp tip.
#[must_use]
pub fn sharp(settings: &Settings) -> Settings {
    Settings {
        // the models of the thesis have no spring that a needle could follow
        model: Model::Exact,
        friction_static: TIP_STICKS,
        friction_kinetic: TIP_SLIDES,
        ..*settings
    }
}

impl TissueMap for Touchable {
    fn at(&self, body: usize, voxel: IVec3, tissues: &Tissues) -> Met {
        let met = |part: &Part| {
            if !part.bits.is_solid(voxel) {
                return Met::Nothing;
            }
            let place = tissues.place_of(part.id.0);
            place.map_or(Met::Wall(part.id.0), |place| {
                Met::Tissue(Layered::of(place))
            })
        };
        match body.checked_sub(1) {
            Some(place) => self.moved_part(place).map_or(Met::Nothing, met),
            None => {
                let standing = self.parts.iter().filter(|part| part.moved.is_none());
                standing.map(met).fold(Met::Nothing, Met::and)
            }
        }
    }

    fn body(&self, number: usize) -> Option<NeedleBody<'_>> {
        let object = self.objects.get(number.checked_sub(1)?)?;
        let (low, high) = object.box_in_world();
        Some(NeedleBody {
            body_from_scan: object.pose().object_from_world(),
            low,
            high,
            spacing: object.spacing().min_element(),
        })
    }

    fn is_open(&self) -> bool {
        self.parts.iter().any(|part| part.punctured)
    }
}

/// What the servo tells of the needle.
#[derive(Clone, Copy, Debug, Default)]
pub struct NeedleStatus {
    /// Whether it is in the hand.
    pub on: bool,
    /// Where it is in; none where it is out.
    pub place: Option<NeedlePlace>,
    /// What holds it [N].
    pub forces: NeedleForces,
    /// Segments that are to be no obstacle.
    pub punctured: SegmentSet,
    /// What happened to it.
    pub events: Events,
    /// What it does to the tissue around it, to be shown; none where it does nothing.
    pub drag: Option<NeedleDrag>,
}

/// Where a needle is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NeedlePlace {
    /// Where it went in [mm].
    pub entry: DVec3,
    /// Inward, of length 1.
    pub direction: DVec3,
    /// The tip, from the entry along that direction [mm].
    pub depth: f64,
    /// How far the tissue is cut [mm]: the rest of the depth is tissue that is pressed in.
    pub cut: f64,
    /// The segment at the tip; 0 where there is none.
    pub segment: u8,
}

impl NeedleStatus {
    /// What it is now; `press`: how it presses tissue in that it is not in.
    #[must_use]
    pub fn of(needle: &Needle, press: Option<Press>) -> Self {
        let place = needle.insertion().map(|insertion| NeedlePlace {
            entry: insertion.line.entry,
            direction: insertion.line.direction,
            depth: insertion.shaft.tip,
            cut: insertion.cut,
            segment: insertion.segment(needle.tissues()).unwrap_or(0),
        });
        Self {
            on: needle.is_felt(),
            place,
            forces: needle.forces(),
            punctured: needle.punctured(),
            events: *needle.events(),
            drag: match needle.insertion() {
                Some(insertion) => drag_in(insertion),
                None => press.map(drag_before),
            },
        }
    }
}

/// What a needle does before the puncture.
fn drag_before(press: Press) -> NeedleDrag {
    NeedleDrag {
        entry: press.push.entry,
        direction: press.push.direction,
        pressed: press.depth,
        ..NeedleDrag::default()
    }
}

/// What a needle does that is in; none where its tip is out.
fn drag_in(insertion: &Insertion) -> Option<NeedleDrag> {
    let shaft = insertion.shaft;
    (!insertion.is_out()).then(|| NeedleDrag {
        entry: insertion.line.entry,
        direction: insertion.line.direction,
        depth: shaft.tip.min(insertion.cut),
        pressed: (shaft.tip - insertion.cut).max(0.0),
        carried: shaft.tip - shaft.bristle,
    })
}

/// The needle as the picture shows it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NeedleDisplay {
    /// Where it is in; none where it is out.
    pub place: Option<NeedlePlace>,
    /// What holds it [N].
    pub forces: NeedleForces,
    /// How many events there were since the session began.
    pub events: u64,
    /// The direction that was set, inward, of length 1; none where it goes in along the push.
    pub direction: Option<DVec3>,
}

/// Events of one stroke that are kept, at most.
const MAX_KEPT: usize = 10_000;

/// What a needle has done since it was taken in the hand.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NeedleReport {
    /// Where it is in; none where it is out.
    pub place: Option<NeedlePlace>,
    /// What holds it [N].
    pub forces: NeedleForces,
    /// Segments that it is in, by rising number.
    pub punctured: Vec<SegmentId>,
    /// What happened, oldest first.
    pub events: Vec<NeedleEvent>,
}

/// Gathers what the servo tells.
#[derive(Debug, Default)]
pub struct NeedleWatch {
    report: NeedleReport,
    known: u64,
    /// What the servo says before it has executed so many commands does not count.
    from_command: u64,
    /// The direction that was set; none where it goes in along the push.
    direction: Option<DVec3>,
}

impl NeedleWatch {
    /// Notes the direction that is set.
    pub fn aim(&mut self, direction: Option<DVec3>) {
        self.direction = direction;
    }

    /// Begins a new report.
    pub fn begin(&mut self) {
        self.report.events.clear();
    }

    /// The probe jumps: what the servo says before this command is about the time before.
    pub fn jump(&mut self, command: u64) {
        self.from_command = command;
        self.report.place = None;
        self.report.punctured.clear();
    }

    /// Takes what the servo says, after so many commands; gives the segments that are to be no
    /// obstacle, where that counts.
    pub fn follow(&mut self, status: &NeedleStatus, command: u64) -> Option<SegmentSet> {
        let room = MAX_KEPT - self.report.events.len();
        let new = status.events.since(self.known).take(room);
        self.report.events.extend(new);
        self.known = status.events.count();
        if command < self.from_command {
            return None;
        }
        self.report.place = status.place;
        self.report.forces = status.forces;
        self.report.punctured = status.punctured.ids().collect();
        Some(status.punctured)
    }

    /// What the picture shows of it.
    #[must_use]
    pub fn now(&self) -> NeedleDisplay {
        NeedleDisplay {
            place: self.report.place,
            forces: self.report.forces,
            events: self.known,
            direction: self.direction,
        }
    }

    /// What it has done.
    #[must_use]
    pub fn report(&self) -> &NeedleReport {
        &self.report
    }
}
