//! A needle: tissue that gives, is punctured, cuts and rubs, instead of a hard surface.
//!
//! Before the tip is in, what it presses on yields: the coupling is in balance with the tissue's
//! own spring. At the puncture force the needle goes in, and is held on the line of that push, or
//! of the direction that was set (`approach.rs`): along it by tip and shaft (`shaft.rs`), across it by a
//! spring that grows with the length in tissue. Segments that no needle punctures stay hard, and so
//! does every other one until its turn comes. So the force on the hand is always that of the coupling to a tool, and only the
//! tool's place follows from all this: on the hard contact, on the tissue, or on the line.
//!
//! The hard proxy is led to where the tool is and keeps all its promises. Punctured segments are
//! left out of what is solid by whoever owns the voxels, some ticks later; until then the proxy
//! waits at their surface, and the tool does not wait for it.
//!
//! The tool goes over from one to another by no more than the hand's own way and a fiftieth
//! of a voxel in a tick; a fall of the force is never held up. Whatever is not finite gives no
//! force. Closed: no allocation, lock, log or panic; bounded work.
//!
//! Frame: scene [mm]; N, N/mm, s. Sources: Okamura, Simone, O'Leary, "Force modeling for needle
//! insertion into soft tissue", IEEE Trans. Biomed. Eng. 51 (2004): stiffness before the
//! puncture, cutting and friction after it; Simone, Okamura, "Modeling of needle insertion
//! forces for robot-assisted percutaneous therapy", ICRA 2002: the stiffness' second power.

use glam::DVec3;
use palpate_volume::segment_set::SegmentSet;
use palpate_volume::tissue::Tissue;
use serde::{Deserialize, Serialize};

use crate::force::{Coupling, Friction};
use crate::soft_contact::{STEP, SoftInput, gone_over, pushed_over, put};
use crate::tick::TickOutput;

pub mod approach;
pub mod events;
pub mod insertion;
pub mod press;
pub mod shaft;
pub mod stretches;
pub mod tissues;
pub mod track;

use approach::Approach;
use events::{EventKind, Events, NeedleEvent};
use insertion::Insertion;
use press::Press;
use tissues::{Layered, NeedleScan, TissueMap, Tissues, World};
use track::{Line, Track};

/// Farther than this no hand is [mm].
const FARTHEST: f64 = 1e6;
/// A tick lasts so long at most [s].
const LONGEST_TICK: f64 = 0.01;

/// What a tick tells the needle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeedleInput {
    /// Device point [mm].
    pub device: DVec3,
    /// Its velocity [mm/s].
    pub velocity: DVec3,
    /// The spring and damper between device and needle.
    pub coupling: Coupling,
    /// Smallest spacing of the scan [mm].
    pub spacing: f64,
    /// Time of the tick [s].
    pub time: f64,
    /// Time since the tick before [s].
    pub dt: f64,
}

impl NeedleInput {
    /// Whether there is a device, and a spring to hold it.
    fn is_known(&self) -> bool {
        let is_place = self.device.abs().cmple(DVec3::splat(FARTHEST)).all();
        is_place && self.coupling.stiffness > 0.0
    }

    fn as_soft(&self) -> SoftInput {
        SoftInput {
            device: self.device,
            velocity: self.velocity,
            gives_way: true,
            coupling: self.coupling,
            friction: Friction::NONE,
            reach: 0.0,
            spacing: self.spacing,
            time: self.time,
        }
    }
}

/// What holds the needle, by what holds it [N].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NeedleForces {
    /// Tissue that the tip presses in.
    pub stiffness: f64,
    /// Tissue that the tip cuts.
    pub cutting: f64,
    /// Tissue along the shaft; against the way in where positive.
    pub friction: f64,
    /// What no needle punctures.
    pub wall: f64,
    /// Tissue beside the shaft.
    pub lateral: f64,
}

/// A needle in the hand, or none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Needle {
    on: bool,
    tissues: Tissues,
    /// Tissues for the next insertion.
    wanted: Tissues,
    /// The direction that the next insertion goes in along, of length 1; none for that of the push.
    #[serde(default)]
    direction: Option<DVec3>,
    insertion: Option<Insertion>,
    forces: NeedleForces,
    /// Device, where it had a place, and spring of the tick before.
    last: Option<(Option<DVec3>, DVec3)>,
    /// The tool of this tick, where it is in.
    tool: Option<DVec3>,
    events: Events,
    /// Time of the tick before [s].
    time: f64,
}

impl Needle {
    /// Takes the needle in the hand, for these tissues, or out of it. One that is in stays in
    /// until it is withdrawn, in the tissues that it went in.
    pub fn hold(&mut self, on: bool, tissues: &Tissues) {
        self.on = on;
        self.wanted = *tissues;
        if self.insertion.is_none() {
            self.tissues = *tissues;
        }
    }

    /// Sets the direction in which it goes in from now on, inward; along the push where there is
    /// none. A needle that is in stays on its line.
    pub fn aim(&mut self, direction: Option<DVec3>) {
        self.direction = direction.and_then(approach::unit);
    }

    /// Whether touch is that of a needle.
    #[must_use]
    pub fn is_felt(&self) -> bool {
        self.on || self.insertion.is_some()
    }

    /// The needle that is in, if one is.
    #[must_use]
    pub fn insertion(&self) -> Option<&Insertion> {
        self.insertion.as_ref()
    }

    /// Tissues that the needle can puncture.
    #[must_use]
    pub fn tissues(&self) -> &Tissues {
        &self.tissues
    }

    /// Forces that hold the needle.
    #[must_use]
    pub fn forces(&self) -> NeedleForces {
        self.forces
    }

    /// Events of the needle.
    #[must_use]
    pub fn events(&self) -> &Events {
        &self.events
    }

    /// Segments that are to be no obstacle: those that it has punctured, until the tip is out.
    #[must_use]
    pub fn punctured(&self) -> SegmentSet {
        let inside = self.insertion.as_ref();
        let inside = inside.filter(|insertion| !insertion.is_out());
        inside.map_or(SegmentSet::EMPTY, |insertion| insertion.punctured)
    }

    /// Forgets where it is in: the probe jumps.
    pub fn forget(&mut self) {
        if self
            .insertion
            .as_ref()
            .is_some_and(|insertion| !insertion.is_out())
        {
            self.events.note(NeedleEvent::withdrawn(self.time));
        }
        self.end();
        self.last = None;
    }

    /// Time since the tick before [s], as far as one counts.
    pub fn pass(&mut self, time: f64) -> f64 {
        let dt = (time - self.time).clamp(0.0, LONGEST_TICK);
        self.time = time;
        dt
    }

    /// Where the proxy is to be led instead of to the device [mm]; none where the needle is not
    /// in.
    pub fn lead(
        &mut self,
        input: &NeedleInput,
        scan: NeedleScan<'_, impl TissueMap>,
    ) -> Option<DVec3> {
        self.tool = None;
        if !input.is_known() {
            return None;
        }
        let insertion = self.insertion.as_mut()?;
        let was_out = insertion.is_out();
        let world = World {
            scan,
            tissues: &self.tissues,
        };
        let (tool, forces) = insertion.advance(input, &world, &mut self.events);
        self.forces = forces;
        if insertion.is_out() {
            if !was_out {
                self.events.note(NeedleEvent::withdrawn(input.time));
            }
            if !scan.map.is_open() {
                self.end();
                return None;
            }
        }
        self.tool = Some(tool);
        self.tool
    }

    /// Puts the needle's force in the place of the hard contact's, and tells how it presses tissue in that
    /// it is not in yet. `holder` is the segment that holds the proxy back, if one does.
    pub fn follow(
        &mut self,
        input: &NeedleInput,
        holder: Option<u8>,
        scan: NeedleScan<'_, impl TissueMap>,
        output: &mut TickOutput,
    ) -> Option<Press> {
        if !self.is_felt() && self.last.is_none() {
            return None;
        }
        if !input.is_known() {
            self.forces = NeedleForces::default();
            // it comes back from nothing
            self.last = self.is_felt().then_some((None, DVec3::ZERO));
            return None;
        }
        let (coupling, wanted, press) = match self.tool {
            Some(tool) => (input.coupling, self.held(input, tool, holder, output), None),
            None => self.pressed(input, holder, scan, output),
        };
        let (device, last) = self.last.unwrap_or((None, output.spring));
        // a hand that was nowhere has made no way
        let way = device.map_or(0.0, |device| (input.device - device).length());
        let most = way + STEP * input.spacing;
        let spring = match self.tool {
            Some(_) => gone_over(last, wanted, most),
            // once it is out, what is left of its force pulls into nothing
            None => pushed_over(last, wanted, most, output.proxy_in_scene - input.device),
        };
        let is_hard = !self.is_felt() && spring == output.spring;
        self.last = (!is_hard).then_some((Some(input.device), spring));
        if !is_hard {
            put(&input.as_soft(), coupling, spring, output);
            // the tool stays where it is between two ticks
            output.sticks = true;
        }
        press
    }

    /// The spring of a needle that is in [mm]: to the tool, and back with it where the proxy is
    /// held by what is hard.
    fn held(
        &self,
        input: &NeedleInput,
        tool: DVec3,
        holder: Option<u8>,
        output: &TickOutput,
    ) -> DVec3 {
        let gives_way = |segment: u8| {
            let insertion = self.insertion.as_ref();
            insertion.is_some_and(|insertion| insertion.gives_way(segment, &self.tissues))
        };
        let hard = match holder {
            Some(segment) if !gives_way(segment) => output.proxy_in_scene - tool,
            _ => DVec3::ZERO,
        };
        tool + hard - input.device
    }

    /// The spring of a needle that is not in [mm]: that of the tissue which it presses in, else
    /// the hard one; it goes in where that is too much for the tissue.
    fn pressed(
        &mut self,
        input: &NeedleInput,
        holder: Option<u8>,
        scan: NeedleScan<'_, impl TissueMap>,
        output: &TickOutput,
    ) -> (Coupling, DVec3, Option<Press>) {
        self.forces = NeedleForces::default();
        let coupling = if output.coupling.stiffness > 0.0 {
            output.coupling
        } else {
            input.coupling
        };
        let k = coupling.stiffness;
        let hard = output.spring;
        let depth = hard.length();
        let pressed = holder.filter(|_| self.on && depth > 0.0);
        let Some(place) = pressed.and_then(|segment| self.tissues.place_of(segment)) else {
            self.forces.wall = k * depth;
            return (coupling, hard, None);
        };
        let push = Line {
            entry: input.device + hard,
            direction: hard / -depth,
        };
        // with what is hard right behind it, no deeper than there
        let mut ahead = Track::default();
        let world = World {
            scan,
            tissues: &self.tissues,
        };
        ahead.look(&push, depth, &world);
        // what overlaps with what is touched is pressed with it
        let alone = Layered::of(place);
        let layer = ahead.first().filter(|layer| layer.has(place));
        let layer = layer.unwrap_or(alone);
        let Some((segment, tissue)) = self.tissues.top(layer) else {
            return (coupling, hard, None);
        };
        let deflection = deflection(&tissue, depth, k);
        let end = ahead
            .wall()
            .map_or(deflection, |(wall, _)| wall.min(deflection));
        let force = k * (depth - end);
        self.forces.stiffness = force;
        let approach = Approach {
            push,
            set: self.direction,
        };
        let share = approach.share();
        if force * share >= tissue.puncture
            && let Some((line, layer)) = approach.way_in((place, layer), input.spacing, &world)
        {
            self.events.note(NeedleEvent {
                kind: EventKind::Punctured,
                segment,
                time: input.time,
                depth: 0.0,
                force: force * share,
            });
            let punctured = self.tissues.segments_of(layer).collect();
            self.insertion = Some(Insertion::new(line, end * share, punctured));
        }
        let press = Press { push, depth: end };
        (coupling, push.direction * (end - depth), Some(press))
    }

    fn end(&mut self) {
        self.insertion = None;
        self.tool = None;
        self.forces = NeedleForces::default();
        self.tissues = self.wanted;
    }
}

/// How far a coupling that is pressed by a depth [mm] presses a tissue in: k (p − x) = l x + q x².
fn deflection(tissue: &Tissue, depth: f64, k: f64) -> f64 {
    let linear = tissue.linear + k;
    let root = (linear * linear + 4.0 * tissue.quadratic * k * depth).sqrt();
    2.0 * k * depth / (linear + root)
}
