//! The hand of a person who presses with the mouse: brings the probe onto the surface under the
//! pointer, pushes there with the force that is asked for, slides along, and lifts off.
//!
//! All that is moved is the hand's target, by which a spring pulls the device; the probe follows by
//! the servo's legal moves alone. A hand that is p / k ahead of the device pulls it with p, and a
//! device at rest pushes against the surface with what the hand pulls: so the force is p on bone
//! and on soft tissue alike, however deep the device comes by it.
//!
//! Frame: scene; mm, N, s.

use arrayvec::ArrayVec;
use glam::DVec3;

use crate::servo::ServoStatus;
use crate::simulation::hand_end::Press;

/// How far before the surface the hand waits until the probe is there [mm].
const STAND_OFF: f64 = 5.0;
/// Speed of the hand on its way through the free [mm/s].
const TRAVEL_SPEED: f64 = 400.0;
/// Fastest approach to a surface [mm/s].
const APPROACH_SPEED: f64 = 60.0;
/// The approach takes so much of what is left in a second [1/s].
const APPROACH_RATE: f64 = 8.0;
/// Speed at which it meets the surface, for each newton that is asked for [mm/s/N]: a mass of
/// 0.1 kg that a wall of 1 N/mm stops at v [mm/s] pushes it with 0.01 v, its hand with as much.
const LANDING_SPEED: f64 = 20.0;
/// A device follows a hand at constant speed so much later [s]: damping over stiffness.
const LAG: f64 = 0.05;
/// Time in which the force grows to what is asked for, at least [s].
const RAMP: f64 = 0.15;
/// Speed at which it deepens where the surface gives way [mm/s]: slow enough for a model of tissue
/// to follow.
const DEEPENING_SPEED: f64 = 12.0;
/// A surface whose force falls while the probe goes deeper by so much gives no more [mm]; a force
/// this much below the largest has not fallen.
const GIVES_WAY: (f64, f64) = (2.0, 0.9);
/// How much farther than the pointer is the hand is ahead sideways, and at most by how much [mm].
const SIDEWAYS: (f64, f64) = (1.5, 8.0);
/// Deepest that the hand goes behind the surface as it is at rest [mm].
const DEEPEST: f64 = 40.0;
/// A probe this far beside the pointer [mm] for so long [s] has strayed.
const STRAYED: (f64, f64) = (5.0, 0.2);
/// A pointer that is faster is still on its way [mm/s].
const POINTER_RESTS: f64 = 20.0;
/// A surface that falls away by more from one ray to the next is another one [mm].
const JUMP: f64 = 3.0;
/// Rays between two places of the pointer, or of a way.
const BETWEEN: u32 = 6;
/// A way that is longer at the first press is not gone: the probe is placed there [mm].
const FAR: f64 = 100.0;
/// How near the device is to be where the hand waits for it [mm].
const ARRIVED: f64 = 1.5;
/// How long it waits for it [s].
const PATIENCE: f64 = 0.8;
/// From where rays beside the pointer's begin: before all that is drawn [mm].
const BEFORE_ALL: f64 = 2000.0;

/// What is solid, as a finger asks for it.
pub trait Rays {
    /// The first point of what can be touched on a way; none where the way is free.
    fn first(&self, from: DVec3, to: DVec3) -> Option<DVec3>;
}

/// What a step of the hand is given.
#[derive(Clone, Copy, Debug)]
pub struct HandStep {
    /// What is pressed now; none where the hand is lifted.
    pub press: Option<Press>,
    /// Scene mm that the hand is ahead for each newton.
    pub ahead_per_newton: f64,
    /// Commands sent to the servo so far.
    pub commands: u64,
    /// Whether a needle is in tissue, which goes along its way alone.
    pub has_needle: bool,
    /// Time since the last step [s].
    pub dt: f64,
}

/// What the hand does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HandMove {
    /// It stays as it is.
    Stay,
    /// It pulls there.
    PullTo(DVec3),
    /// Probe, device and hand are brought there, without force.
    Place(DVec3),
}

/// Where the pointer is.
#[derive(Clone, Copy, Debug)]
struct Goal {
    /// The surface under it, or, where there is none, as deep as it was last.
    point: DVec3,
    /// Along the ray.
    direction: DVec3,
    is_solid: bool,
}

#[derive(Clone, Debug, Default)]
enum Phase {
    /// Nothing is pressed.
    #[default]
    Idle,
    /// Until the servo has placed the probe: by that command.
    Placing(u64),
    /// On the way to a place before the goal, of which it takes one point after the other.
    Travel {
        route: ArrayVec<DVec3, 4>,
        goal: DVec3,
        waited: f64,
    },
    /// Before the goal, which is nothing to press on, or cannot be reached.
    Wait(DVec3),
    /// On the surface, or the last mm before it.
    Press,
    /// Off the surface, for so long [s].
    Lift(f64),
}

/// The largest force of a contact [N], and the depth up to which it was felt [mm].
#[derive(Clone, Copy, Debug)]
struct Peak {
    force: f64,
    depth: f64,
}

/// The hand, from press to lift.
#[derive(Debug, Default)]
pub struct LedHand {
    phase: Phase,
    /// Where the hand is on its way.
    target: DVec3,
    /// How far the hand is ahead of the device into the surface [mm].
    ahead: f64,
    /// Where the pointer was in the last step.
    last: Option<Goal>,
    strayed: f64,
    /// Of this contact; none without one.
    peak: Option<Peak>,
}

impl LedHand {
    /// Somebody else leads the hand.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// One step of the hand.
    pub fn step(&mut self, step: &HandStep, servo: &ServoStatus, rays: &impl Rays) -> HandMove {
        let Some(press) = step.press else {
            return self.lift(step, servo, rays);
        };
        let Some(goal) = self.goal(&press, rays) else {
            return HandMove::Stay;
        };
        let last = self.last.replace(goal).unwrap_or(goal);
        match &mut self.phase {
            Phase::Idle | Phase::Lift(_) => self.begin(&goal, step, servo, rays),
            Phase::Placing(command) => {
                if servo.command >= *command {
                    self.set_out(&goal, servo, rays);
                }
                HandMove::Stay
            }
            Phase::Travel { .. } => self.travel(&goal, step, servo, rays),
            Phase::Wait(reached) => {
                if goal.point.distance(*reached) > JUMP {
                    self.set_out(&goal, servo, rays);
                }
                HandMove::Stay
            }
            Phase::Press => {
                let leaves = !goal.is_solid
                    || jumps(&last, &goal, rays)
                    || self.has_strayed(&last, &goal, step, servo);
                if leaves && !step.has_needle {
                    self.set_out(&goal, servo, rays);
                    return HandMove::PullTo(self.target);
                }
                self.press(&goal, &press, step, servo)
            }
        }
    }

    /// The first surface on the ray; beside all of them a point as deep as the last one.
    fn goal(&self, press: &Press, rays: &impl Rays) -> Option<Goal> {
        let Press {
            origin, direction, ..
        } = *press;
        let surface = rays.first(origin, origin + direction * BEFORE_ALL * 2.0);
        let beside = || {
            let depth = (self.last?.point - origin).dot(direction);
            Some(origin + direction * depth)
        };
        Some(Goal {
            point: surface.or_else(beside)?,
            direction,
            is_solid: surface.is_some(),
        })
    }

    /// The first press: by a way where there is one and it is short, else placed before the surface.
    fn begin(
        &mut self,
        goal: &Goal,
        step: &HandStep,
        servo: &ServoStatus,
        rays: &impl Rays,
    ) -> HandMove {
        let before = goal.before(STAND_OFF + servo.radius);
        let is_near = servo.proxy.distance(before) <= FAR;
        if step.has_needle || is_near && rays.first(servo.proxy, before).is_none() {
            self.set_out(goal, servo, rays);
            return HandMove::PullTo(self.target);
        }
        self.place(goal, step, servo)
    }

    fn place(&mut self, goal: &Goal, step: &HandStep, servo: &ServoStatus) -> HandMove {
        self.phase = Phase::Placing(step.commands + 1);
        HandMove::Place(goal.before(STAND_OFF + servo.radius))
    }

    /// Leaves the surface, if it is on one, and begins the way to the goal.
    fn set_out(&mut self, goal: &Goal, servo: &ServoStatus, rays: &impl Rays) {
        self.target = servo.proxy;
        self.ahead = 0.0;
        self.strayed = 0.0;
        self.peak = None;
        self.phase = Phase::Travel {
            route: route(servo.proxy, goal, servo.radius, rays),
            goal: goal.point,
            waited: 0.0,
        };
    }

    /// A step of the way; at its end the probe is pressed, or waits.
    fn travel(
        &mut self,
        now: &Goal,
        step: &HandStep,
        servo: &ServoStatus,
        rays: &impl Rays,
    ) -> HandMove {
        let Phase::Travel {
            route,
            goal,
            waited,
        } = &mut self.phase
        else {
            return HandMove::Stay;
        };
        if now.point.distance(*goal) > JUMP {
            let moved = now.point - *goal;
            *goal = now.point;
            // what stands between may be something else now
            let end = now.before(STAND_OFF + servo.radius);
            let slides = moved.length() < 3.0 * JUMP && rays.first(self.target, end).is_none();
            match route.last_mut() {
                Some(last) if slides => *last = end,
                _ => *route = self::route(servo.proxy, now, servo.radius, rays),
            }
        }
        let Some(next) = route.first().copied() else {
            self.phase = Phase::Press;
            return HandMove::Stay;
        };
        let way = next - self.target;
        self.target += way.clamp_length_max(TRAVEL_SPEED * step.dt);
        *waited += step.dt;
        if way.length() > TRAVEL_SPEED * step.dt {
            *waited = 0.0;
        }
        let is_there = self.target == next && servo.device.distance(next) <= ARRIVED;
        if is_there || route.len() > 1 && servo.device.distance(next) <= STAND_OFF {
            route.remove(0);
            *waited = 0.0;
            if route.is_empty() {
                self.phase = if now.is_solid {
                    Phase::Press
                } else {
                    Phase::Wait(now.point)
                };
            }
        } else if *waited > PATIENCE {
            return self.give_up(now, step, servo);
        }
        HandMove::PullTo(self.target)
    }

    /// There is no way by which the probe comes there: it is placed, once.
    fn give_up(&mut self, goal: &Goal, step: &HandStep, servo: &ServoStatus) -> HandMove {
        if step.has_needle || servo.contact || !goal.is_solid {
            self.phase = Phase::Wait(goal.point);
            return HandMove::PullTo(servo.proxy);
        }
        self.place(goal, step, servo)
    }

    /// The hand ahead of the device: into the surface by as much as pulls with the force that is
    /// asked for, sideways toward the pointer.
    fn press(
        &mut self,
        goal: &Goal,
        press: &Press,
        step: &HandStep,
        servo: &ServoStatus,
    ) -> HandMove {
        let inward = inward(goal, servo);
        let off = goal.point - servo.device;
        self.ahead = if servo.contact {
            let full = press.pressure * step.ahead_per_newton;
            let held = servo.sent_force * step.ahead_per_newton;
            let room = self.room(-off.dot(goal.direction), servo.sent_force);
            (self.ahead + full * step.dt / RAMP)
                .min(held + (DEEPENING_SPEED * LAG).min(room))
                .min(full)
        } else {
            self.peak = None;
            let landing = (LANDING_SPEED * press.pressure).min(APPROACH_SPEED);
            // what is left, less what the surface that is felt may stand before its voxels
            let left = off.dot(inward) - servo.radius - 1.0;
            (left * APPROACH_RATE).clamp(landing, APPROACH_SPEED) * LAG
        };
        let sideways = if step.has_needle {
            DVec3::ZERO
        } else {
            let (gain, most) = SIDEWAYS;
            (off.reject_from_normalized(inward) * gain).clamp_length_max(most)
        };
        HandMove::PullTo(servo.device + sideways + inward * self.ahead)
    }

    /// How much deeper than a depth the device may go [mm]: as long as the force grows by it.
    fn room(&mut self, depth: f64, force: f64) -> f64 {
        let (reach, share) = GIVES_WAY;
        let peak = self.peak.get_or_insert(Peak { force, depth });
        if force >= share * peak.force {
            peak.force = peak.force.max(force);
            peak.depth = peak.depth.max(depth);
        }
        (peak.depth + reach).min(DEEPEST) - depth
    }

    /// Whether the probe does not come to where the pointer rests.
    fn has_strayed(
        &mut self,
        last: &Goal,
        goal: &Goal,
        step: &HandStep,
        servo: &ServoStatus,
    ) -> bool {
        let (far, long) = STRAYED;
        let off = goal.point - servo.proxy;
        let beside = off.reject_from_normalized(inward(goal, servo)).length();
        let is_behind = !servo.contact && off.dot(goal.direction) < -far;
        let rests = goal.point.distance(last.point) < POINTER_RESTS * step.dt;
        let strays = is_behind || beside > 4.0 * far || beside > far && rests;
        self.strayed = if strays { self.strayed + step.dt } else { 0.0 };
        self.strayed > long
    }

    /// Takes the hand off the surface, to where it pulls nothing; where the probe cannot follow it
    /// lets go.
    fn lift(&mut self, step: &HandStep, servo: &ServoStatus, rays: &impl Rays) -> HandMove {
        match (&mut self.phase, self.last) {
            (Phase::Lift(waited), _) => {
                *waited += step.dt;
                let lets_go = servo.contact && *waited > PATIENCE;
                if lets_go || !servo.contact {
                    self.forget();
                }
                if lets_go {
                    return HandMove::PullTo(servo.proxy);
                }
                HandMove::Stay
            }
            // where it is placed nothing pulls
            (Phase::Idle | Phase::Placing(_), _) | (_, None) => {
                self.forget();
                HandMove::Stay
            }
            (_, Some(last)) => {
                self.phase = Phase::Lift(0.0);
                if step.has_needle {
                    return HandMove::PullTo(servo.proxy);
                }
                let outward = -inward(&last, servo);
                let depth = (last.point - servo.proxy).dot(outward).max(0.0);
                let off = servo.proxy + outward * (depth + STAND_OFF);
                HandMove::PullTo(halfway_to_what_is_met(servo.proxy, off, rays))
            }
        }
    }
}

impl Goal {
    /// A point before the surface, toward the viewer.
    fn before(&self, distance: f64) -> DVec3 {
        self.point - self.direction * distance
    }
}

/// Into the surface that is touched; before it is, along the ray.
fn inward(goal: &Goal, servo: &ServoStatus) -> DVec3 {
    let normal = servo.normal.try_normalize();
    let touched = normal.filter(|_| servo.contact).map(|normal| -normal);
    touched.unwrap_or(goal.direction)
}

/// Whether the surface under the pointer is not the one that it was on: between the two places
/// there is an edge.
fn jumps(last: &Goal, goal: &Goal, rays: &impl Rays) -> bool {
    if last.point.distance(goal.point) < JUMP {
        return false;
    }
    let depth_at = |share: f64| {
        let point = last.point.lerp(goal.point, share);
        let along = goal.direction * BEFORE_ALL;
        rays.first(point - along, point + along)
            .map(|met| met.dot(goal.direction))
    };
    let sideways = (goal.point - last.point).reject_from_normalized(goal.direction);
    let slope = JUMP + 2.0 * sideways.length() / f64::from(BETWEEN);
    let mut before = last.point.dot(goal.direction);
    for number in 1..=BETWEEN {
        match depth_at(f64::from(number) / f64::from(BETWEEN)) {
            Some(depth) if (depth - before).abs() <= slope => before = depth,
            _ => return true,
        }
    }
    false
}

/// Points on the way to before a goal: off the surface, straight where nothing is in between, else
/// toward the viewer, over what is, and down again.
fn route(from: DVec3, goal: &Goal, radius: f64, rays: &impl Rays) -> ArrayVec<DVec3, 4> {
    let room = STAND_OFF + radius;
    let end = goal.before(room);
    let off = halfway_to_what_is_met(from, from - goal.direction * room, rays);
    let mut route = ArrayVec::new();
    route.push(off);
    if rays.first(off, end).is_some() {
        let top = top_between(from, goal, rays) - room;
        let over = |point: DVec3| {
            let rise = (point.dot(goal.direction) - top).max(0.0);
            point - goal.direction * rise
        };
        route.push(over(off));
        route.push(over(end));
    }
    route.push(end);
    route
}

/// How far along the view's direction the nearest is that stands between a point and a goal.
fn top_between(from: DVec3, goal: &Goal, rays: &impl Rays) -> f64 {
    let along = goal.direction * BEFORE_ALL;
    let depths = (0..=2 * BETWEEN).map(|number| {
        let point = from.lerp(goal.point, f64::from(number) / f64::from(2 * BETWEEN));
        let met = rays.first(point - along, point);
        met.unwrap_or(point).dot(goal.direction)
    });
    depths.fold(f64::INFINITY, f64::min)
}

/// The end of a way, or the middle of what of it is free.
fn halfway_to_what_is_met(from: DVec3, to: DVec3, rays: &impl Rays) -> DVec3 {
    match rays.first(from, to) {
        Some(met) => from.midpoint(met),
        None => to,
    }
}
