//! The body behind the border of the box: a coarse lattice through all of the segment that is pressed.
//!
//! The springs of the border stand for an endless body that goes on as it is at the border. What the
//! true body does besides is one displacement of the border under the force that it gives on
//! ([`super::border`]): the compliance of the whole segment less that of a body that goes on endlessly,
//! both on the same coarse nodes under the same load, so that what is too coarse about them cancels.
//! Both are linear, with small displacements: the whole body bends and shifts, it does not turn far.
//!
//! What holds the segment: rigid tissue that it touches ([`super::whole_sites`]), tissue that goes on
//! beyond its box and, where there is neither, a bed of fat all around it, as springs on its surface
//! (elastic foundation: Johnson, Contact Mechanics, 1985, section 4.3).
//! What it runs against: places of its surface that have come into rigid voxels are held back by a
//! stiff spring along the normal of what they met, for as long as that pushes.
//!
//! Frame: mm along the axes of the grid, from its corner. Source: thesis 5.29.

use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_volume::edit::SegmentId;

use super::border::Ground;
use super::border::outer;
use super::moving_box::MovingBox;
use super::nodes::{Lattice, NodeMaterial};
use super::relax::{RelaxSettings, Relaxer};
use super::resample::{RestVoxels, node_near, node_place};
use super::vectors::{Field, vector_at, zero_field};
use super::whole_contacts::{Contact, Facing};
use super::whole_lattice::{coarse_lattice, lay_in_fat, settle};
use super::whole_picture::WholePicture;
use crate::model::DisplacementField;

/// Nodes of the box around a segment, about, without its margin.
const NODES: f64 = 4096.0;
/// Empty nodes around it.
const MARGIN: i32 = 1;
/// Least spacing, in half widths of the fine box: its load is spread over that box.
const LEAST_SPACING: f64 = 0.5;
/// Load and reference stand where they are until the box is so far from them [spacings].
const NEAR: f64 = 0.6;
/// Radius over which a load is spread, at least [spacings].
const SPREAD: f64 = 1.25;
/// Nodes of the endless body on each side of the load.
const REFERENCE: i32 = 4;
/// Displacements are computed so many times smaller, where all is linear.
const SHRUNK: f64 = 1e-5;
/// Unbalanced force left, as a share of the load.
const TOLERANCE: f64 = 1e-3;
/// Evaluations for the reference, each direction.
const REFERENCE_WORK: u32 = 150;
/// Share of the way to a new compliance in one answer, and what is as good as there [1/stiffness].
const BLEND: f64 = 0.3;
const SAME: f64 = 1e-3;
/// Answers before a body that others have cut is built again.
const REBUILT_AFTER: u32 = 32;
/// The load along each axis, and what contacts do without any.
const CASES: usize = 4;

/// Compliance [mm/N] and displacement without a force [mm].
#[derive(Clone, Copy, Debug)]
struct Response {
    compliance: DMat3,
    free: DVec3,
}

impl Response {
    const NONE: Self = Self {
        compliance: DMat3::ZERO,
        free: DVec3::ZERO,
    };
}

/// The whole segment.
#[derive(Debug)]
pub(super) struct WholeBody {
    segment: SegmentId,
    /// First node, counted from the corner of the grid in its own spacing.
    first: IVec3,
    body: Lattice,
    /// Stiffness of its softest bonds [N/mm].
    softest: f64,
    /// Whether nothing but fat holds it.
    in_fat: bool,
    /// Springs that are no contacts.
    held_by: usize,
    facing: Vec<Facing>,
    contacts: Vec<Contact>,
    /// Node around which the load is spread.
    middle: Option<IVec3>,
    load: Vec<(u32, f64)>,
    reference: DMat3,
    /// Displacements of each case, shrunk.
    cases: [Field; CASES],
    /// Cases that are not at rest yet, the last one first.
    pending: Vec<usize>,
    relaxer: Relaxer,
    now: Response,
    picture: WholePicture,
    /// On the tissue [N].
    force: DVec3,
    answers: u32,
    /// Whether others have changed voxels since.
    pub stale: bool,
}

/// What one answer may do.
pub(super) struct Work<'a> {
    pub iterations: u32,
    pub is_late: &'a dyn Fn() -> bool,
}

impl WholeBody {
    /// The body of the segment at a place, as it was or built anew; none where nothing is there.
    pub fn of(
        known: Option<Self>,
        rest: &RestVoxels<'_>,
        near: &MovingBox,
        place: DVec3,
    ) -> Option<Self> {
        let segment = rest.segment_at(place)?;
        let serves =
            |body: &Self| body.segment == segment && !(body.stale && body.answers >= REBUILT_AFTER);
        // what it gave last goes on until the new one knows better
        let now = known.as_ref().map_or(Response::NONE, |known| known.now);
        known.filter(serves).or_else(|| {
            let new = Self::new(segment, rest, near)?;
            Some(Self { now, ..new })
        })
    }

    fn new(segment: SegmentId, rest: &RestVoxels<'_>, near: &MovingBox) -> Option<Self> {
        let grid = rest.voxels.grid();
        let bounds = rest.voxels.segment(segment)?.bounding_box()?;
        let [low, high] = [bounds.min, bounds.max].map(|end| end.as_dvec3() * grid.spacing());
        let half = near.half_width();
        let spacing = ((high - low).element_product() / NODES).cbrt();
        let spacing = spacing.max(LEAST_SPACING * half);
        let first = node_near(low, spacing) - MARGIN;
        let last = node_near(high, spacing) + MARGIN;
        let size = (last - first + 1).clamp(IVec3::splat(2), IVec3::splat(256));
        let matter = |place: DVec3| rest.matter_at(place);
        let mut body = coarse_lattice(first, size.as_uvec3(), spacing, grid, &matter);
        let in_fat = body.ground.is_empty();
        if in_fat {
            lay_in_fat(&mut body);
        }
        settle(&mut body);
        let length = body.layout().len();
        Some(Self {
            softest: body.softest_bond(),
            segment,
            first,
            in_fat,
            held_by: body.ground.len(),
            facing: Facing::all(&body, first, &matter),
            picture: WholePicture::new([low, high], near.lattice.spacing(), &matter),
            body,
            contacts: Vec::new(),
            middle: None,
            load: Vec::new(),
            reference: DMat3::ZERO,
            cases: std::array::from_fn(|_| zero_field(length)),
            pending: Vec::new(),
            relaxer: Relaxer::default(),
            now: Response::NONE,
            force: DVec3::ZERO,
            answers: 0,
            stale: false,
        })
    }

    /// Follows the box, and the force [N] on its tissue at a place; has the border give as the body does.
    pub fn follow(
        &mut self,
        rest: &RestVoxels<'_>,
        near: &mut MovingBox,
        (place, force): (DVec3, DVec3),
        work: &Work<'_>,
    ) {
        self.answers += 1;
        self.force = force;
        self.stand_around(rest, near, place);
        self.relax(work);
        if self.pending.is_empty() {
            self.meet(rest);
        }
        if self.pending.is_empty() {
            self.blend(&near.lattice);
            let nodes: Vec<_> = (0..self.body.layout().len())
                .map(|index| self.moved(index))
                .collect();
            let places = self.picture.soft_places();
            let moved: Vec<_> = places.map(|place| self.between(&nodes, place)).collect();
            self.picture.follow(&moved);
        }
        near.lattice.set_frame(self.now.compliance, self.now.free);
    }

    /// Nothing presses it.
    pub fn let_go(&mut self) {
        self.force = DVec3::ZERO;
        self.picture.let_go();
    }

    /// What is seen of it beside a box; none where that is below `least` [mm].
    pub fn seen(&self, near: &MovingBox, least: f64) -> Option<DisplacementField> {
        self.picture.field(near, least)
    }

    /// What the coarse nodes of tissue around a place have [mm], between them; zero where none is near.
    fn between(&self, nodes: &[DVec3], place: DVec3) -> DVec3 {
        let at = place / self.spacing() - self.first.as_dvec3() - 0.5;
        let (low, share) = (at.floor().as_ivec3(), at - at.floor());
        let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
        for n in 0..8 {
            let corner = IVec3::new(n & 1, n >> 1 & 1, n >> 2);
            let near = DVec3::select(corner.cmpgt(IVec3::ZERO), share, 1.0 - share);
            let index = self.body.layout().index_of(low + corner);
            if let Some(index) = index.filter(|_| self.body.has_matter(low + corner)) {
                sum += nodes[index] * near.element_product();
                weights += near.element_product();
            }
        }
        if weights > 0.0 {
            sum / weights
        } else {
            DVec3::ZERO
        }
    }

    /// Displacement of a coarse node under the force [mm].
    pub fn moved(&self, index: usize) -> DVec3 {
        let of = |case: usize| vector_at(&self.cases[case], index);
        let by_force = of(0) * self.force.x + of(1) * self.force.y + of(2) * self.force.z;
        by_force / self.unit() + of(3) / SHRUNK
    }

    /// Nodes of the body: where they rest, and how far they have moved [mm].
    pub fn nodes(&self) -> impl Iterator<Item = [DVec3; 2]> {
        let corner = node_place(self.first, self.spacing());
        let nodes = self.body.matter_nodes();
        nodes.map(move |node| [corner + self.body.rest_place(node), self.moved(node)])
    }

    /// Between nodes [mm].
    pub fn spacing(&self) -> f64 {
        self.body.spacing()
    }

    /// Load of a case [N].
    fn unit(&self) -> f64 {
        SHRUNK * self.softest * self.spacing()
    }

    /// Stiffness of a contact [N/mm]: it gives little beside the tissue.
    fn contact_stiffness(&self) -> f64 {
        20.0 * self.softest
    }

    /// Spreads the load around a place, where that has gone on.
    fn stand_around(&mut self, rest: &RestVoxels<'_>, near: &MovingBox, middle: DVec3) {
        let spacing = self.spacing();
        let is_near = |node: IVec3| node_place(node, spacing).distance(middle) < NEAR * spacing;
        // the middle of a cube is within 0.87 spacings of all of it
        let node = node_near(middle, spacing);
        if self
            .middle
            .is_some_and(|last| last == node || is_near(last))
        {
            return;
        }
        self.middle = Some(node);
        let matter = |place: DVec3| endless_matter(rest, middle, place);
        let size = UVec3::splat(2 * REFERENCE as u32 + 1);
        let corner = node - REFERENCE;
        let mut endless = coarse_lattice(corner, size, spacing, rest.voxels.grid(), &matter);
        // what fat does to the surface that is pressed is no part of the difference: the box knows of none
        if self.in_fat {
            lay_in_fat(&mut endless);
        }
        settle(&mut endless);
        let radius = near.half_width().max(SPREAD * spacing);
        let weight = |index: usize| {
            let from =
                endless.rest_place(index) + node_place(corner, spacing) - node_place(node, spacing);
            (1.0 - from.length_squared() / (radius * radius))
                .max(0.0)
                .powi(2)
        };
        let mut loads = Vec::new();
        for index in endless.matter_nodes() {
            let place = endless
                .layout()
                .node_at(index)
                .unwrap_or_default()
                .as_ivec3();
            let there = place + corner - self.first;
            let own = self.body.layout().index_of(there);
            let counts = self.body.has_matter(there) && weight(index) > 0.0;
            if let Some(own) = own.filter(|_| counts) {
                // what is little tissue carries little
                let filled = young_of(&self.body, own).min(young_of(&endless, index));
                loads.push((own as u32, index as u32, weight(index) * filled));
            }
        }
        let sum: f64 = loads.iter().map(|(_, _, weight)| weight).sum();
        self.load = loads
            .iter()
            .map(|(own, _, weight)| (*own, weight / sum))
            .collect();
        let there: Vec<_> = loads
            .iter()
            .map(|(_, index, weight)| (*index, weight / sum))
            .collect();
        self.reference = endless_compliance(&mut endless, &there);
        self.pending = (0..CASES).rev().collect();
    }

    /// Brings one case after the other to rest, as far as the work goes.
    fn relax(&mut self, work: &Work<'_>) {
        let mut left = work.iterations;
        while let Some(&case) = self.pending.last() {
            if left == 0 || (work.is_late)() {
                return;
            }
            let reference = self.begin(case);
            std::mem::swap(&mut self.body.moved, &mut self.cases[case]);
            let settings = RelaxSettings {
                tolerance: TOLERANCE,
                iterations: left,
                reference,
            };
            let report = self
                .relaxer
                .relax(&mut self.body, &[], &settings, work.is_late);
            std::mem::swap(&mut self.body.moved, &mut self.cases[case]);
            left = left.saturating_sub(report.iterations);
            if report.residual > TOLERANCE && report.residual.is_finite() {
                return;
            }
            self.pending.pop();
        }
    }

    /// Puts the load and the contacts of a case; the force by which rest is measured [N].
    fn begin(&mut self, case: usize) -> f64 {
        let (unit, stiffness) = (self.unit(), self.contact_stiffness());
        let axis = DVec3::AXES.get(case).copied();
        let load = |(node, weight): &(u32, f64)| Some((*node, axis? * (weight * unit)));
        self.body.loads = self.load.iter().filter_map(load).collect();
        self.body.ground.truncate(self.held_by);
        let gap = |contact: &Contact| {
            if axis.is_none() {
                contact.gap * SHRUNK
            } else {
                0.0
            }
        };
        let spring = |contact: &Contact| Ground {
            node: contact.node as u32,
            stiffness: outer(contact.normal, contact.normal) * stiffness,
            led: contact.normal * gap(contact),
        };
        self.body.ground.extend(self.contacts.iter().map(spring));
        let pushes = self
            .contacts
            .iter()
            .map(|contact| gap(contact).abs() * stiffness);
        pushes.fold(unit, f64::max)
    }

    /// Takes note of what has run against rigid voxels, and of what has come off them.
    fn meet(&mut self, rest: &RestVoxels<'_>) {
        let step = rest.voxels.grid().smallest_spacing();
        let matter = |place: DVec3| rest.matter_at(place);
        let before = self.contacts.len();
        let pull = 0.02 * self.force.length() / self.contact_stiffness();
        let mut contacts = std::mem::take(&mut self.contacts);
        contacts
            .retain(|contact| contact.normal.dot(self.moved(contact.node)) >= contact.gap - pull);
        let mut changes = contacts.len() != before;
        // near the load the fine nodes know what is rigid
        let is_far = |facing: &&Facing| {
            self.load
                .iter()
                .all(|(node, _)| *node as usize != facing.node)
        };
        for facing in self.facing.iter().filter(is_far) {
            if contacts.iter().any(|contact| contact.node == facing.node) {
                continue;
            }
            if let Some(contact) =
                facing.meets(self.moved(facing.node), step, self.spacing(), &matter)
            {
                contacts.push(contact);
                changes = true;
            }
        }
        self.contacts = contacts;
        if changes {
            // the stiffness of its modes is found without a load
            self.begin(0);
            self.body.loads.clear();
            settle(&mut self.body);
            self.pending = (0..CASES).rev().collect();
        }
    }

    /// Goes toward what was found: at once, the force would jump.
    fn blend(&mut self, near: &Lattice) {
        let mut found = Response::NONE;
        for &(node, weight) in &self.load {
            let of = |case: usize| vector_at(&self.cases[case], node as usize) * weight;
            found.compliance += DMat3::from_cols(of(0), of(1), of(2)) * self.unit().recip();
            found.free += of(3) / SHRUNK;
        }
        let own = (found.compliance + found.compliance.transpose()) * 0.5;
        found.compliance = own - self.reference;
        let way = Response {
            compliance: found.compliance - self.now.compliance,
            free: found.free - self.now.free,
        };
        let is_there = entries(way.compliance) * near.softest_bond() < SAME
            && way.free.abs().max_element() < SAME * near.spacing();
        let share = if is_there { 1.0 } else { BLEND };
        self.now.compliance += way.compliance * share;
        self.now.free += way.free * share;
    }
}

/// Modulus of a node, less where tissue fills little of its cube [N/mm²].
fn young_of(body: &Lattice, node: usize) -> f64 {
    body.matter(node).solid().map_or(0.0, |solid| solid.young)
}

/// What an endless body is made of: tissue as it is, with more of what is in the middle where it meets something rigid
/// or the end of the scan.
fn endless_matter(rest: &RestVoxels<'_>, middle: DVec3, place: DVec3) -> NodeMaterial {
    let grid = rest.voxels.grid();
    let half = 0.5 * grid.spacing();
    let last = grid.dimensions().as_dvec3() * grid.spacing() - half;
    match rest.matter_at(place.clamp(half, last)) {
        NodeMaterial::Rigid(_) => rest.matter_at(middle),
        soft_or_empty => soft_or_empty,
    }
}

/// Compliance of an endless body under this load [mm/N].
fn endless_compliance(endless: &mut Lattice, load: &[(u32, f64)]) -> DMat3 {
    let unit = SHRUNK * endless.softest_bond() * endless.spacing();
    let mut relaxer = Relaxer::default();
    let settings = RelaxSettings {
        tolerance: TOLERANCE,
        iterations: REFERENCE_WORK,
        reference: unit,
    };
    let columns = DVec3::AXES.map(|axis| {
        endless.put_to_rest();
        endless.loads = load
            .iter()
            .map(|(node, weight)| (*node, axis * (weight * unit)))
            .collect();
        relaxer.relax(endless, &[], &settings, &|| false);
        let moved = load
            .iter()
            .map(|(node, weight)| endless.moved(*node as usize) * *weight);
        moved.sum::<DVec3>() / unit.max(f64::MIN_POSITIVE)
    });
    let compliance = DMat3::from_cols(columns[0], columns[1], columns[2]);
    (compliance + compliance.transpose()) * 0.5
}

/// The largest entry.
fn entries(matrix: DMat3) -> f64 {
    matrix
        .to_cols_array()
        .into_iter()
        .fold(0.0, |most, entry| f64::max(most, entry.abs()))
}
