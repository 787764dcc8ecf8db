//! A needle that is in: on its line, through the layers that it has punctured.
//!
//! Frame: scene [mm]; depths along the line; N, s.

use glam::DVec3;
use palpate_volume::edit::SegmentId;
use palpate_volume::segment_set::SegmentSet;
use palpate_volume::tissue::Tissue;
use serde::{Deserialize, Serialize};

use super::events::{EventKind, Events, NeedleEvent};
use super::shaft::{Resistance, Shaft};
use super::tissues::{Layered, Met, TissueMap, Tissues, World};
use super::track::{Line, Track};
use super::{NeedleForces, NeedleInput};

/// Layers that a tip can come into in one tick.
const MAX_CROSSED: u32 = 4;
/// The tip stays before a wall by so much [mm].
const BEFORE_WALL: f64 = 1e-7;
/// What is left of a relaxation is none below this [mm].
const RELAXED: f64 = 1e-4;

/// Where a needle is, and what it went through.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Insertion {
    /// The line that it is held on.
    pub line: Line,
    /// What lies on it.
    track: Track,
    /// Tip and shaft.
    pub shaft: Shaft,
    /// Depth to which tissue is cut [mm].
    pub cut: f64,
    /// The layer in which the cut ends.
    place: u16,
    /// Segments that were punctured.
    pub punctured: SegmentSet,
    /// Whether the tip rests against what no needle punctures.
    stopped: bool,
}

impl Insertion {
    /// A needle that goes in along a line, with its tip as deep as it has pressed the surface
    /// in of what it punctures just now.
    #[must_use]
    pub fn new(line: Line, tip: f64, punctured: SegmentSet) -> Self {
        Self {
            line,
            shaft: Shaft {
                tip,
                anchor: 0.0,
                bristle: tip,
            },
            punctured,
            ..Self::default()
        }
    }

    /// Whether all of what is at the end of the cut is punctured.
    fn is_punctured(&self, tissues: &Tissues) -> bool {
        let mut segments = tissues.segments_of(self.layer());
        segments.all(|segment| self.punctured.contains(segment))
    }

    /// What is at the end of the cut.
    fn layer(&self) -> Layered {
        match self.track.met(self.place) {
            Met::Tissue(layer) => layer,
            Met::Nothing | Met::Wall(_) => Layered::default(),
        }
    }

    /// The segment at the end of the cut; none where nothing is there.
    #[must_use]
    pub fn segment(&self, tissues: &Tissues) -> Option<u8> {
        self.tissue(tissues).map(|(segment, _)| segment)
    }

    fn tissue(&self, tissues: &Tissues) -> Option<(u8, Tissue)> {
        tissues.top(self.layer())
    }

    /// One tick: where the tool is now [mm], and what pushes it.
    pub fn advance(
        &mut self,
        input: &NeedleInput,
        world: &World<'_, impl TissueMap>,
        events: &mut Events,
    ) -> (DVec3, NeedleForces) {
        let k = input.coupling.stiffness;
        let device = self.line.depth_of(input.device);
        let tissues = world.tissues;
        self.track
            .look(&self.line, device.max(self.shaft.tip), world);
        let at = (self.shaft.tip, input.time);
        if self.track.look_again(&self.line, at, world) {
            self.place = self.track.place_at(self.cut);
        }

        let meets = self.meets(tissues);
        self.shaft.press(device, k, &meets);
        // by what is left where a wall holds the tip
        let tip_force = self.shaft.tip_force(self.shaft.tip, &meets);
        let friction = self.shaft.friction(self.shaft.tip, &meets);
        let wall = (k * (device - self.shaft.tip) - tip_force - friction).max(0.0);
        let is_ahead = !self.is_punctured(tissues);
        let aside = self.line.aside_of(input.device);
        let lateral = self.reach_of(tissues, |tissue| tissue.lateral);
        let give = k / (k + lateral);

        self.relax(input.dt, tissues);
        let note = |kind, segment, depth| {
            events.note(NeedleEvent {
                kind,
                segment,
                time: input.time,
                depth,
                force: tip_force + wall,
            });
        };
        self.go_on(tip_force + wall, tissues, note);
        let tool = self.line.at(self.shaft.tip) + aside * give;
        let at_wall = wall > 0.0 && self.shaft.tip >= meets.end;
        let forces = NeedleForces {
            stiffness: if is_ahead { tip_force } else { 0.0 },
            cutting: if is_ahead { 0.0 } else { tip_force },
            friction,
            wall: if at_wall { wall } else { 0.0 },
            lateral: lateral * give * aside.length(),
        };
        (tool, forces)
    }

    fn meets(&self, tissues: &Tissues) -> Resistance {
        let tissue = self.tissue(tissues);
        let threshold = tissue.map_or(0.0, |(_, tissue)| {
            if self.is_punctured(tissues) {
                tissue.cutting
            } else {
                tissue.puncture
            }
        });
        let end = match self.track.wall() {
            Some((wall, _)) => wall - BEFORE_WALL,
            // no farther than it is known what is there
            None => self.track.seen(),
        };
        Resistance {
            tissue: tissue.map(|(_, tissue)| tissue),
            threshold,
            friction: self.reach_of(tissues, |tissue| tissue.friction),
            end,
        }
    }

    /// Sum over the shaft in tissue of a figure per length.
    fn reach_of(&self, tissues: &Tissues, figure: impl Fn(&Tissue) -> f64) -> f64 {
        let reach = self.shaft.tip.min(self.cut);
        self.track.along(reach, tissues, figure)
    }

    /// A tip at rest loses some of its cutting force.
    fn relax(&mut self, dt: f64, tissues: &Tissues) {
        let Some((_, tissue)) = self.tissue(tissues) else {
            return;
        };
        if !self.is_punctured(tissues) {
            return;
        }
        let rest = tissue.deflection((1.0 - tissue.relaxation) * tissue.cutting);
        let left = self.shaft.tip - self.shaft.anchor - rest;
        if left > RELAXED {
            self.shaft.anchor += left * (dt / tissue.relaxation_secs).min(1.0);
        }
    }

    /// The tip goes into what gives way under its force [N]: on in the layer, through its end,
    /// into the next one.
    fn go_on(&mut self, force: f64, tissues: &Tissues, mut note: impl FnMut(EventKind, u8, f64)) {
        for _ in 0..MAX_CROSSED {
            let tip = self.shaft.tip;
            let end = self.track.end(self.place);
            let tissue = self.tissue(tissues);
            let most = match tissue {
                Some((segment, tissue)) => {
                    if !self.is_punctured(tissues) {
                        if force < tissue.puncture {
                            break;
                        }
                        let gone_into = tissues.segments_of(self.layer());
                        self.punctured = gone_into.fold(self.punctured, SegmentSet::with);
                        note(EventKind::Punctured, segment, self.cut);
                    }
                    tissue.deflection(tissue.cutting)
                }
                None => 0.0,
            };
            self.shaft.anchor = self.shaft.anchor.max(tip - most);
            let reach = self.shaft.anchor.min(end.unwrap_or(f64::INFINITY));
            self.cut = self.cut.max(reach.min(self.track.seen()));
            if end.is_none_or(|end| self.cut < end) {
                break;
            }
            self.cross(tissue, tissues, &mut note);
        }
        self.note_wall(force, note);
    }

    /// Into the next layer, with the same force at the tip as far as that bears it.
    fn cross(
        &mut self,
        from: Option<(u8, Tissue)>,
        tissues: &Tissues,
        note: &mut impl FnMut(EventKind, u8, f64),
    ) {
        let tip = self.shaft.tip;
        let force = from.map_or(0.0, |(_, tissue)| tissue.force(tip - self.shaft.anchor));
        self.place += 1;
        let next = self.tissue(tissues);
        self.shaft.anchor = match next {
            // behind the tip already: the tip is not in contact there
            _ if tip < self.shaft.anchor => self.shaft.anchor,
            Some((_, tissue)) => tip - tissue.deflection(force),
            None => tip,
        };
        // the smooth surface, where it went in, may stand before the first voxel
        let begins = from.is_none() && self.place == 1;
        if self.is_punctured(tissues) && !begins {
            let segment = next.map_or(0, |(segment, _)| segment);
            note(EventKind::Crossed, segment, self.cut);
        }
    }

    fn note_wall(&mut self, force: f64, mut note: impl FnMut(EventKind, u8, f64)) {
        let Some((wall, segment)) = self.track.wall() else {
            self.stopped = false;
            return;
        };
        let is_there = self.shaft.tip >= wall - BEFORE_WALL && force > 0.0;
        if is_there && !self.stopped {
            note(EventKind::Stopped, segment, wall);
        }
        // until it has been drawn back
        self.stopped = is_there || self.stopped && self.shaft.tip > wall - 1.0;
    }

    /// Whether a segment gives way to the needle where it is: it is punctured, or the tip presses
    /// it in.
    #[must_use]
    pub fn gives_way(&self, segment: u8, tissues: &Tissues) -> bool {
        let place = tissues.place_of(segment);
        self.punctured.contains(SegmentId(segment))
            || place.is_some_and(|place| self.track.meets(place, self.shaft.tip))
    }

    /// Whether the tip is out.
    #[must_use]
    pub fn is_out(&self) -> bool {
        self.shaft.tip <= 0.0
    }
}
