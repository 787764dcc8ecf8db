//! Brings a lattice to rest under its tools: Newton's method from where the nodes are, each step
//! found by conjugate gradients as far as it pays.
//!
//! A step that is too long for the contacts is cut in half until the forces fall, all of them or those
//! along it. Where they do with no part of it, each node goes where its own force brings it, as far as that helps.
//! Where it does not, the nodes stay where they are, and whoever asked is told how far from rest that is.
//! Source: Nocedal & Wright, Numerical Optimization (2006), section 7.1 (line search Newton-CG).

use super::coarse::CoarseFactor;
use super::conjugate::{Conjugate, Easing, unbalanced};
use super::driven::Driven;
use super::node_contacts::NodeContacts;
use super::nodes::Lattice;
use super::tool_contact::{ContactNode, LatticeTool, ToolForce, ToolReach};
use super::vectors::Field;

/// Settings of a relaxation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelaxSettings {
    /// Unbalanced force left, as a share of the tools' force, at which nodes are at rest.
    pub tolerance: f64,
    /// Evaluations of all forces at most.
    pub iterations: u32,
    /// Force that counts where the tools feel less [N]; for tests without a tool.
    pub reference: f64,
}

/// Result of a relaxation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RelaxReport {
    /// Evaluations of all forces.
    pub iterations: u32,
    /// Unbalanced force left, as a share of the tools' force.
    pub residual: f64,
}

/// How much smaller the forces become in one step of Newton, as the linear problem sees them, at
/// rest and far from it: what is not linear would spoil more (Eisenstat & Walker 1996).
const GAINS: [f64; 2] = [0.05, 0.5];
/// Iterations of one step at most.
const MOST: u32 = 60;
/// A node moves so far at most in one step [spacings].
const FARTHEST: f64 = 0.5;
/// Forces along a step of which no more than this share is left, either way, have lost energy on it:
/// then others may grow, as where tissue buckles (Crisfield, Non-linear Finite Element Analysis,
/// 1991, section 9.2).
const LESS_ALONG: f64 = 0.8;
/// Most times that a step is cut in half.
const HALVES: u32 = 4;

/// What came of a step.
struct Taken {
    evaluations: u32,
    /// Whether the forces fell, and the nodes moved.
    falls: bool,
}

/// Accuracy with which one step is to be found.
pub(super) struct Wish<'a> {
    /// Evaluations at most.
    pub most: u32,
    /// Unbalanced force that is good enough, as a share of the tools' force.
    pub residual: f64,
    /// Share of the forces that may be left.
    pub gain: f64,
    pub reference: f64,
    /// Forces that the step is to leave as they are; none where all are to go.
    pub stay: Option<&'a Field>,
}

/// Scratch of the relaxation, kept from call to call.
#[derive(Clone, Debug, Default)]
pub struct Relaxer {
    /// One over the stiffness that a node feels along each axis; 0 where held.
    mobility: Field,
    factor: CoarseFactor,
    pub(super) problem: Conjugate,
    reaches: Vec<ToolReach>,
    contacts: NodeContacts,
    /// Nodes that are led beside what tools push.
    pub(super) driven: Driven,
    felt: Vec<ToolForce>,
    /// Nodes that tools push now, and those that are led.
    touched: Vec<ContactNode>,
    /// Evaluations of all forces since this was last taken.
    pub(super) evaluations: u64,
}

impl Relaxer {
    /// What each tool feels, in the order of the tools, as of the last call.
    #[must_use]
    pub fn felt(&self) -> &[ToolForce] {
        &self.felt
    }

    /// Moves nodes until they are at rest, the iterations are over, or `is_late`.
    pub fn relax(
        &mut self,
        lattice: &mut Lattice,
        tools: &[LatticeTool],
        settings: &RelaxSettings,
        is_late: &dyn Fn() -> bool,
    ) -> RelaxReport {
        self.reaches.resize_with(tools.len(), ToolReach::default);
        self.contacts.find(lattice);
        self.look_for_nodes(lattice, tools);
        self.evaluate(lattice, tools);
        let mut iterations = 1;
        loop {
            self.weigh(lattice);
            let left = unbalanced(&self.mobility, &lattice.force);
            let residual = self.share(left, settings.reference);
            let report = RelaxReport {
                iterations,
                residual,
            };
            // numbers that are none never get better
            let over = residual <= settings.tolerance || iterations >= settings.iterations;
            if over || !left.is_finite() || is_late() {
                return report;
            }
            let wish = Wish {
                most: settings.iterations.saturating_sub(iterations + 1).min(MOST),
                residual: 0.5 * settings.tolerance,
                gain: residual.clamp(GAINS[0], GAINS[1]),
                reference: settings.reference,
                stay: None,
            };
            iterations += self.find_step(lattice, tools, &wish, is_late);
            let most = settings.iterations.saturating_sub(iterations);
            let taken = self.take_step(lattice, tools, most);
            iterations += taken.evaluations;
            if !taken.falls {
                return RelaxReport {
                    iterations,
                    residual,
                };
            }
            self.look_for_nodes(lattice, tools);
        }
    }

    /// Works out all forces, those of tools and contacts too.
    pub fn evaluate(&mut self, lattice: &mut Lattice, tools: &[LatticeTool]) {
        self.evaluations += 1;
        lattice.evaluate();
        self.contacts.push(lattice);
        self.felt.clear();
        self.touched.clear();
        for (reach, tool) in self.reaches.iter().zip(tools) {
            self.felt.push(reach.push(lattice, tool, &mut self.touched));
        }
        self.driven.pull(lattice, &mut self.touched);
    }

    /// Finds the step of Newton, and gives how often it has evaluated forces.
    pub(super) fn find_step(
        &mut self,
        lattice: &mut Lattice,
        tools: &[LatticeTool],
        wish: &Wish<'_>,
        is_late: &dyn Fn() -> bool,
    ) -> u32 {
        let factor = lattice.coarse.as_ref();
        self.factor = factor.map_or_else(Default::default, |c| c.factor(&self.touched));
        let easing = Easing::of(&self.mobility, lattice, &self.factor);
        self.problem.begin(lattice, &easing, wish.stay);
        for iteration in 1..=wish.most {
            self.problem.probe(lattice.spacing, &mut lattice.moved);
            self.evaluate(lattice, tools);
            let easing = Easing::of(&self.mobility, lattice, &self.factor);
            let Some(left) = self.problem.advance(&lattice.force, &easing) else {
                return iteration;
            };
            let near = self.share(left, wish.reference) <= wish.residual;
            let is_long = self.problem.longest_step() > FARTHEST * lattice.spacing;
            if near || is_long || self.problem.gain() <= wish.gain || is_late() {
                return iteration;
            }
        }
        wish.most
    }

    /// Takes the step that was found. Where no part of it helps, as where contacts or cells that fold deceive the
    /// linear problem, each node goes where its own force brings it alone: that always loses energy.
    fn take_step(&mut self, lattice: &mut Lattice, tools: &[LatticeTool], most: u32) -> Taken {
        let taken = self.take_part(lattice, tools, most);
        let left = most.saturating_sub(taken.evaluations);
        if taken.falls || left == 0 {
            return taken;
        }
        self.problem.respond_each(&self.mobility);
        let alone = self.take_part(lattice, tools, left);
        Taken {
            evaluations: taken.evaluations + alone.evaluations,
            ..alone
        }
    }

    /// Takes the step, or a part of it so small that the forces fall, or at least those along it, so that
    /// energy does; none where no part is so small.
    fn take_part(&mut self, lattice: &mut Lattice, tools: &[LatticeTool], most: u32) -> Taken {
        let longest = self.problem.longest_step() / lattice.spacing;
        let mut share = (FARTHEST / longest.max(f64::MIN_POSITIVE)).min(1.0);
        let before = self.problem.first_left();
        let mut tried = 0;
        loop {
            self.problem.go(share, &mut lattice.moved);
            self.evaluate(lattice, tools);
            tried += 1;
            let [first, now] = self.problem.along_step(&lattice.force);
            let falls = unbalanced(&self.mobility, &lattice.force) < before
                || now.abs() < LESS_ALONG * first;
            if falls {
                return Taken {
                    evaluations: tried,
                    falls,
                };
            }
            if tried > HALVES || tried >= most {
                self.problem.go(0.0, &mut lattice.moved);
                self.evaluate(lattice, tools);
                return Taken {
                    evaluations: tried + 1,
                    falls,
                };
            }
            share *= 0.5;
        }
    }

    /// Finds the nodes that tools may reach.
    fn look_for_nodes(&mut self, lattice: &Lattice, tools: &[LatticeTool]) {
        for (reach, tool) in self.reaches.iter_mut().zip(tools) {
            reach.find(lattice, tool);
        }
    }

    /// Computes the mobility of each node, with its contacts as they are now.
    pub(super) fn weigh(&mut self, lattice: &Lattice) {
        let mut mass = lattice.mass.clone();
        if let Some(stiffening) = &lattice.stiffening {
            let added = stiffening.added_stiffness(lattice);
            mass.iter_mut()
                .zip(added)
                .for_each(|(mass, added)| *mass += added);
        }
        for contact in &self.touched {
            mass[contact.node] += contact.stiffness;
        }
        for (node, stiffness) in self.contacts.stiffnesses() {
            mass[node] += stiffness;
        }
        for (axis, held) in lattice.held.iter().enumerate() {
            let mobility = mass.iter().zip(held);
            let mobility = mobility.map(|(m, held)| if *held || *m == 0.0 { 0.0 } else { 1.0 / m });
            self.mobility[axis].clear();
            self.mobility[axis].extend(mobility);
        }
    }

    /// Force squared as a share of what the tools feel.
    fn share(&self, unbalanced: f64, reference: f64) -> f64 {
        let felt: f64 = self.felt.iter().map(|felt| felt.force.length()).sum();
        if unbalanced == 0.0 {
            0.0
        } else {
            unbalanced.sqrt() / felt.max(reference).max(f64::MIN_POSITIVE)
        }
    }
}
