//! Soft tissue: what the servo makes of the answers of a deformation model, which come
//! at some 30 Hz.
//!
//! An answer is a linear law of the force on the tool. The coupling holds the device at d to a
//! tool at t, and both are in balance where k (t − d) = F₀ + K (t − t₀). So nothing feels stiffer
//! than k, and a soft contact is a spring like a hard one: only its far end differs, the tool in
//! the tissue instead of the contact point on it. Where one takes the other's place, and where a
//! new answer replaces an old one, that end goes over by no more than the hand's own way and
//! a fiftieth of a voxel in a tick; a fall of the force is never held up.
//!
//! The hard proxy knows nothing of it and keeps all that it promises. An answer that is too old
//! counts no more: then the tissue is as hard as its voxels. One that stays still counts where it was
//! found, so that a hand at rest feels the same however late the next one is.
//!
//! No answer leads the tool into what does not give way: where that stops it on its way from the
//! proxy, the spring ends there, as stiff as what stops it. So bone under soft tissue is felt
//! whatever a model says of it.
//!
//! Friction is that of touch: the law is asked where friction holds the device, not where it is.
//!
//! Frame: scene [mm]; N, N/mm, s. Source: Colgate, Stanley, Brown, "Issues in the haptic display
//! of tool use", IROS 1995 (virtual coupling); Mahvash, Hayward, "High-fidelity haptic synthesis
//! of contact with deformable bodies", IEEE CG&A 24 (2004) (local laws between slow answers).

use glam::{DMat3, DVec3};
use palpate_volume::material::LocalContact;
use serde::{Deserialize, Serialize};

use crate::force::{Coupling, Feel, Friction, FrictionState, SurfaceBlend};
use crate::tick::TickOutput;

/// Age at which an answer of the model is late, and dropped unless it stays [s].
pub const STALE_SECS: f64 = 0.1;
/// How far from where it was found an answer is held whole, and one that stays is not left; it fades to
/// nothing at twice that [its validity].
const WHOLE: f64 = 2.0;
/// How far the spring's end goes over in a tick, beside the hand's way [smallest spacings].
pub const STEP: f64 = 0.02;

/// What a tick tells of the contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftInput {
    /// Device point [mm].
    pub device: DVec3,
    /// Its velocity [mm/s].
    pub velocity: DVec3,
    /// Whether what holds the proxy, if anything does, is soft tissue.
    pub gives_way: bool,
    /// The spring and damper where no hard contact has its own.
    pub coupling: Coupling,
    /// Friction of the soft tissue.
    pub friction: Friction,
    /// How far beyond what holds the probe tissue is asked about while no answer counts [mm].
    pub reach: f64,
    /// Smallest spacing of the scan [mm].
    pub spacing: f64,
    /// Time of the tick [s].
    pub time: f64,
}

/// Where tissue that does not give way holds the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// The tool that it holds [mm].
    pub tool: DVec3,
    /// Stiffness of the spring to it [N/mm].
    pub stiffness: f64,
}

/// The newest answer and how far the force has followed it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SoftContact {
    answer: Option<Answer>,
    /// Device and spring of the tick before, where the spring was not that of a hard contact.
    last: Option<(DVec3, DVec3)>,
    /// How stiff the spring is, on its way to that of what stops the tool.
    #[serde(default)]
    stiffness: SurfaceBlend,
    /// Where the tool sticks to the tissue.
    #[serde(default)]
    friction: FrictionState,
}

/// An answer as it is kept; its law holds within `validity`, and fades to nothing at four times that.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Answer {
    tool: DVec3,
    force: DVec3,
    stiffness: DMat3,
    validity: f64,
    /// Time at which the answer came [s].
    time: f64,
    /// Whether it stays where the next one is late; none in recordings of 0.1 does.
    #[serde(default)]
    stays: bool,
}

impl SoftContact {
    /// Takes an answer at a time [s], or that nothing gives way any more. What is not finite is
    /// no answer; a law that is no spring holds along its force only.
    pub fn take(&mut self, contact: Option<&LocalContact>, time: f64) {
        self.answer = contact.and_then(|contact| Answer::of(contact, time));
    }

    /// Takes an answer that stays: however late the next one is, it counts for a device that does not
    /// leave where it is held whole. One by which nothing pushes stays no longer than others.
    pub fn take_staying(&mut self, contact: Option<&LocalContact>, time: f64) {
        self.take(contact, time);
        if let Some(answer) = &mut self.answer {
            answer.stays = true;
        }
    }

    /// Whether the force of this tick, or of the one before, is not that of a hard contact alone.
    #[must_use]
    pub fn is_felt(&self) -> bool {
        self.last.is_some()
    }

    /// Whether there is anything to follow: an answer, or a force that goes back to hard contact.
    #[must_use]
    pub fn is_awaited(&self) -> bool {
        self.answer.is_some() || self.last.is_some()
    }

    /// Puts the tissue's force in the place of the hard contact's, where tissue gives way. `stop`
    /// is asked for what stops the tool on its way to where the tissue would have it [mm].
    ///
    /// Gives the place of which the next answer is to tell [mm]: where the tool comes to once its spring has
    /// gone over, or toward the device while no answer counts; none where nothing gives way.
    pub fn follow(
        &mut self,
        input: &SoftInput,
        output: &mut TickOutput,
        stop: impl FnOnce(DVec3) -> Option<Stop>,
    ) -> Option<DVec3> {
        let mut coupling = if output.coupling.stiffness > 0.0 {
            output.coupling
        } else {
            input.coupling
        };
        // what counts no more is no answer again where the hand comes back: nothing goes to and fro
        self.answer = self
            .answer
            .filter(|answer| answer.counts(input, coupling.stiffness));
        if !(input.device.is_finite() && coupling.stiffness > 0.0) {
            self.forget_force();
            return None;
        }
        let fresh = self.answer.filter(|_| input.gives_way);
        let soft = fresh.map(|answer| self.tool(&answer, input, coupling.stiffness));
        let near = output.contact_point_in_scene;
        let toward = near + (input.device - near).clamp_length_max(input.reach);
        let wanted = input.gives_way.then(|| soft.unwrap_or(toward));
        // from where the probe is nothing stops it on no way
        let stop = wanted.filter(|tool| *tool != near).and_then(stop);
        let tool = stop.map(|stop| stop.tool).or(wanted);
        if fresh.is_none() && self.last.is_none() {
            return tool;
        }
        let hard = output.spring;
        let wanted = tool.filter(|_| fresh.is_some());
        let wanted = wanted.map_or(hard, |tool| tool - input.device);
        // where it was hard contact until now, from there
        let (device, last) = self.last.unwrap_or((input.device, hard));
        let way = (input.device - device).length();
        let out = output.proxy_in_scene - input.device;
        let spring = pushed_over(last, wanted, way + STEP * input.spacing, out);
        let is_hard = fresh.is_none() && spring == hard;
        if is_hard {
            self.forget_force();
            return tool;
        }
        self.last = Some((input.device, spring));
        let stop = stop.filter(|_| fresh.is_some());
        coupling.stiffness = self.stiffness(
            stop.map_or(coupling.stiffness, |stop| stop.stiffness),
            way,
            spring.length(),
            input.spacing,
        );
        put(input, coupling, spring, output);
        tool
    }

    /// Where an answer has the tool [mm], with friction.
    fn tool(&mut self, answer: &Answer, input: &SoftInput, k: f64) -> DVec3 {
        let state = &mut self.friction;
        let target = input.friction.target(input.device, input.spacing, state);
        let spring = answer.spring(target, k);
        let tool = target + spring;
        state.remember(
            &input.friction,
            target,
            (spring != DVec3::ZERO).then_some(tool),
        );
        // where nothing pushes friction holds nothing
        if spring == DVec3::ZERO {
            input.device
        } else {
            tool
        }
    }

    fn forget_force(&mut self) {
        self.last = None;
        self.friction.forget();
        self.stiffness = SurfaceBlend::default();
    }

    /// Goes on to a stiffness [N/mm] by the way of the hand, as from surface to surface.
    fn stiffness(&mut self, wanted: f64, way: f64, depth: f64, h: f64) -> f64 {
        let wanted = Feel {
            stiffness: wanted,
            friction: Friction::NONE,
        };
        let feel = self.stiffness.follow(Some(wanted), way, depth, h);
        feel.unwrap_or(wanted).stiffness
    }
}

impl Answer {
    fn of(contact: &LocalContact, time: f64) -> Option<Self> {
        let LocalContact {
            position,
            force,
            stiffness,
            validity,
        } = *contact;
        let finite = position.is_finite() && force.is_finite() && stiffness.is_finite();
        (finite && validity > 0.0).then(|| Self {
            tool: position,
            force,
            stiffness: spring_like(stiffness, force),
            validity,
            time,
            stays: false,
        })
    }

    /// Whether it counts: while it is fresh, and longer where it stays and the device has not left it.
    fn counts(&self, input: &SoftInput, k: f64) -> bool {
        let is_fresh = input.time - self.time <= STALE_SECS;
        let stays = self.stays && self.force != DVec3::ZERO;
        is_fresh || stays && self.moved(input.device, k).length() <= WHOLE * self.validity
    }

    /// From the tool of the answer to the one in balance with the device by a coupling of stiffness
    /// k [N/mm], as the law would have it anywhere [mm].
    fn moved(&self, device: DVec3, k: f64) -> DVec3 {
        // k I − K has no eigenvalue below k
        let balance = DMat3::from_diagonal(DVec3::splat(k)) - self.stiffness;
        let pushed = self.force - self.stiffness * self.tool + device * k;
        balance.inverse() * pushed - self.tool
    }

    /// From the device to the tool that is in balance [mm] with a coupling of stiffness k [N/mm].
    fn spring(&self, device: DVec3, k: f64) -> DVec3 {
        let normal = self.force.normalize_or_zero();
        if normal == DVec3::ZERO {
            return DVec3::ZERO;
        }
        let moved = self.moved(device, k);
        let force = self.force + self.stiffness * moved.clamp_length_max(self.validity);
        // held a little beyond what is known, and no farther
        let share = (2.0 - moved.length() / (WHOLE * self.validity)).clamp(0.0, 1.0);
        one_sided(force, normal, self.force.length()) * (share / k)
    }
}

/// The symmetric part, where it is a spring in every direction; else the spring along the force.
fn spring_like(stiffness: DMat3, force: DVec3) -> DMat3 {
    let pull = (stiffness + stiffness.transpose()) * -0.5;
    let [x, y, z] = [pull.x_axis, pull.y_axis, pull.z_axis];
    // Sylvester's criterion for semidefinite matrices: no principal minor is negative
    let minor = |a: DVec3, b: DVec3, i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    let minors = [
        x.x,
        y.y,
        z.z,
        minor(x, y, 0, 1),
        minor(x, z, 0, 2),
        minor(y, z, 1, 2),
        pull.determinant(),
    ];
    if minors.iter().all(|minor| *minor >= 0.0) {
        return pull * -1.0;
    }
    let normal = force.normalize_or_zero();
    let along = normal.dot(pull * normal).max(0.0);
    let outer = DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
    outer * -along
}

/// A force that never pulls against its normal, and whose other part fades with the pressure.
fn one_sided(force: DVec3, normal: DVec3, pressure: f64) -> DVec3 {
    let out = force.dot(normal).max(0.0);
    let along = force - normal * force.dot(normal);
    normal * out + along * (out / pressure).min(1.0)
}

/// Without what would pull the device away from the proxy, into what holds that.
fn without_pull(spring: DVec3, out: DVec3) -> DVec3 {
    let length = out.length_squared();
    let pull = spring.dot(out).min(0.0);
    if length > 0.0 {
        spring - out * (pull / length)
    } else {
        spring
    }
}

/// From one spring toward another by at most so much [mm]; what makes it shorter comes at once.
pub(crate) fn gone_over(from: DVec3, to: DVec3, most: f64) -> DVec3 {
    let from = from.clamp_length_max(to.length());
    let way = to - from;
    if way.length() <= most {
        to
    } else {
        from + way.clamp_length_max(most)
    }
}

/// The same without what would pull the device away from the proxy, by `out` from it [mm]. Neither
/// end pulls then, and so nothing between them does: the end is reached. Were only the way there
/// held back, friction that holds the probe aside could keep a hand at rest on it for ever.
pub(crate) fn pushed_over(from: DVec3, to: DVec3, most: f64, out: DVec3) -> DVec3 {
    gone_over(without_pull(from, out), without_pull(to, out), most)
}

/// Puts a spring [mm] into what a tick gives.
pub(crate) fn put(input: &SoftInput, coupling: Coupling, spring: DVec3, output: &mut TickOutput) {
    let force = coupling.force(spring, input.velocity);
    output.spring = spring;
    output.normal = spring.normalize_or_zero();
    output.coupling = coupling;
    output.sticks = false;
    output.contact_point_in_scene = if spring == DVec3::ZERO {
        output.proxy_in_scene
    } else {
        input.device + spring
    };
    output.force = if force.is_finite() {
        force
    } else {
        DVec3::ZERO
    };
    output.contact |= spring != DVec3::ZERO;
    output.depth = spring.length();
}
