//! Brings a lattice to rest under its tools: FIRE, from where the nodes are.
//!
//! Masses are made up: each node weighs what it feels as stiffness, so that soft and hard
//! matter swing equally fast and the time step is the same number for all matter; there is no
//! physical time in it.
//! Source: Bitzek et al., "Structural relaxation made simple", Phys. Rev. Lett. 97 (2006);
//! Guénolé et al., Comput. Mater. Sci. 175 (2020), for the half step back.

use super::layout::CHUNK;
use super::node_contacts::NodeContacts;
use super::nodes::Lattice;
use super::tool_contact::{
    ContactNode, LatticeTool, ToolForce, ToolReach, largest_contact_stiffness,
};
use super::vectors::{Field, Lanes, lanes, lanes_mut, widest, zero_field};

/// How to relax.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelaxSettings {
    /// Unbalanced force left, as a share of the tools' force, at which nodes are at rest.
    pub tolerance: f64,
    /// Iterations at most.
    pub iterations: u32,
    /// Force that counts where the tools feel less [N]; for tests without a tool.
    pub reference: f64,
}

/// How it went.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RelaxReport {
    /// Evaluations of all forces.
    pub iterations: u32,
    /// Unbalanced force left, as a share of the tools' force.
    pub residual: f64,
}

/// Longest time step in units of the masses; 2/√2 would be the limit of stability.
const LONGEST_STEP: f64 = 1.2;
/// Time step at the start.
const FIRST_STEP: f64 = 0.6;
/// Iterations downhill before the step grows.
const DELAY: u32 = 5;
/// Growth and fall of the step, share of the force in the direction, and its fading.
const GROWTH: f64 = 1.1;
const FALL: f64 = 0.5;
const MIXING: f64 = 0.1;
const FADING: f64 = 0.98;
/// A node moves so far at most in one iteration [spacings], whatever pushes it.
const FARTHEST: f64 = 0.2;
/// Iterations between looks at the clock and at which nodes the tools may reach.
const LOOK_EVERY: u32 = 16;
/// Iterations between steps of the coarse level.
const CORRECT_EVERY: u32 = 16;

/// Scratch of the relaxation, kept from call to call.
#[derive(Clone, Debug, Default)]
pub struct Relaxer {
    momentum: Field,
    /// One over the mass along each axis; 0 where held.
    mobility: Field,
    reaches: Vec<ToolReach>,
    contacts: NodeContacts,
    felt: Vec<ToolForce>,
    /// Nodes that tools push now.
    touched: Vec<ContactNode>,
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
        self.prepare(lattice, tools);
        let mut pace = Pace::new();
        let mut report = RelaxReport::default();
        loop {
            self.evaluate(lattice, tools);
            report.iterations += 1;
            let sums = self.sums(lattice);
            report.residual = self.residual(sums.force, settings.reference);
            let over = report.residual <= settings.tolerance
                || report.iterations >= settings.iterations
                || (report.iterations % LOOK_EVERY == 0 && is_late());
            // numbers that are none never get better
            if over || !sums.force.is_finite() {
                return report;
            }
            if report.iterations % LOOK_EVERY == 0 {
                self.look_for_nodes(lattice, tools);
            }
            if report.iterations % CORRECT_EVERY == 0 && lattice.coarse.is_some() {
                lattice.correct_coarsely(&self.touched);
                self.evaluate(lattice, tools);
            }
            let stride = pace.next(&sums, lattice.spacing);
            advance(
                &self.mobility,
                &lattice.force,
                &stride,
                &mut self.momentum,
                &mut lattice.moved,
            );
        }
    }

    /// Works out all forces, those of tools and contacts too.
    pub fn evaluate(&mut self, lattice: &mut Lattice, tools: &[LatticeTool]) {
        lattice.evaluate();
        self.contacts.push(lattice);
        self.felt.clear();
        self.touched.clear();
        for (reach, tool) in self.reaches.iter().zip(tools) {
            self.felt.push(reach.push(lattice, tool, &mut self.touched));
        }
    }

    fn prepare(&mut self, lattice: &Lattice, tools: &[LatticeTool]) {
        let length = lattice.layout.len();
        self.momentum = zero_field(length);
        self.reaches.resize_with(tools.len(), ToolReach::default);
        self.contacts.find(lattice);
        self.look_for_nodes(lattice, tools);
    }

    /// Finds the nodes that tools may reach, and with them all masses.
    fn look_for_nodes(&mut self, lattice: &Lattice, tools: &[LatticeTool]) {
        let mut mass = lattice.mass.clone();
        for (reach, tool) in self.reaches.iter_mut().zip(tools) {
            reach.find(lattice, tool);
            for node in reach.nodes() {
                mass[node] += largest_contact_stiffness(lattice, node);
            }
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

    fn sums(&self, lattice: &Lattice) -> Sums {
        let mut sums = Sums::default();
        add_up(&self.mobility, &lattice.force, &self.momentum, &mut sums);
        sums
    }

    /// Unbalanced force as a share of what the tools feel.
    fn residual(&self, unbalanced: f64, reference: f64) -> f64 {
        let felt: f64 = self.felt.iter().map(|felt| felt.force.length()).sum();
        if unbalanced == 0.0 {
            0.0
        } else {
            unbalanced.sqrt() / felt.max(reference).max(f64::MIN_POSITIVE)
        }
    }
}

/// What an iteration needs to know of all nodes.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    /// Force along the momentum, each by mobility.
    power: f64,
    /// Momentum squared, by mobility.
    momentum: f64,
    /// Force squared, by mobility.
    weighted_force: f64,
    /// Force squared, of nodes that move [N²].
    force: f64,
}

/// How one iteration goes on.
#[derive(Clone, Copy, Debug)]
struct Stride {
    /// Steps back before anything else.
    back: f64,
    /// Share of the old momentum.
    keep: f64,
    /// Momentum for each unit of force.
    gain: f64,
    /// Time step.
    step: f64,
    /// Farthest move along an axis [mm].
    farthest: f64,
}

/// The state of FIRE.
struct Pace {
    step: f64,
    mixing: f64,
    downhill: u32,
}

impl Pace {
    fn new() -> Self {
        Self {
            step: FIRST_STEP,
            mixing: MIXING,
            downhill: 0,
        }
    }

    fn next(&mut self, sums: &Sums, spacing: f64) -> Stride {
        let farthest = FARTHEST * spacing;
        if sums.power < 0.0 {
            // uphill: half a step back, and start again from rest
            let back = 0.5 * self.step;
            self.step = (self.step * FALL).max(0.02);
            self.mixing = MIXING;
            self.downhill = 0;
            return Stride {
                back,
                keep: 0.0,
                gain: self.step,
                step: self.step,
                farthest,
            };
        }
        self.downhill += 1;
        if self.downhill > DELAY {
            self.step = (self.step * GROWTH).min(LONGEST_STEP);
            self.mixing *= FADING;
        }
        let share = if sums.weighted_force > 0.0 {
            (sums.momentum / sums.weighted_force).sqrt()
        } else {
            0.0
        };
        Stride {
            back: 0.0,
            keep: 1.0 - self.mixing,
            gain: self.step + self.mixing * share,
            step: self.step,
            farthest,
        }
    }
}

widest! {
    /// Adds up what [`Pace`] needs, in an order that is always the same.
    fn add_up(mobility: &Field, force: &Field, momentum: &Field, sums: &mut Sums) = add_up_body
}

#[inline(always)]
fn add_up_body(mobility: &Field, force: &Field, momentum: &Field, sums: &mut Sums) {
    let mut lanewise: [Lanes; 4] = [[0.0; CHUNK]; 4];
    for axis in 0..3 {
        for start in (0..mobility[axis].len()).step_by(CHUNK) {
            let [w, f, p] = [
                lanes(&mobility[axis], start),
                lanes(&force[axis], start),
                lanes(&momentum[axis], start),
            ];
            for n in 0..CHUNK {
                lanewise[0][n] += w[n] * f[n] * p[n];
                lanewise[1][n] += w[n] * p[n] * p[n];
                lanewise[2][n] += w[n] * f[n] * f[n];
                lanewise[3][n] += if w[n] > 0.0 { f[n] * f[n] } else { 0.0 };
            }
        }
    }
    let [power, momentum, weighted_force, force] = lanewise.map(|lanes| lanes.iter().sum());
    *sums = Sums {
        power,
        momentum,
        weighted_force,
        force,
    };
}

widest! {
    /// Moves all nodes by one stride.
    fn advance(
        mobility: &Field,
        force: &Field,
        stride: &Stride,
        momentum: &mut Field,
        moved: &mut Field,
    ) = advance_body
}

#[inline(always)]
fn advance_body(
    mobility: &Field,
    force: &Field,
    stride: &Stride,
    momentum: &mut Field,
    moved: &mut Field,
) {
    let Stride {
        back,
        keep,
        gain,
        step,
        farthest,
    } = *stride;
    for axis in 0..3 {
        for start in (0..mobility[axis].len()).step_by(CHUNK) {
            let [w, f] = [lanes(&mobility[axis], start), lanes(&force[axis], start)];
            let p = lanes_mut(&mut momentum[axis], start);
            let u = lanes_mut(&mut moved[axis], start);
            for n in 0..CHUNK {
                let way_back = back * w[n] * p[n];
                p[n] = keep * p[n] + gain * f[n];
                u[n] += (step * w[n] * p[n]).clamp(-farthest, farthest) - way_back;
            }
        }
    }
}
