//! A box of nodes in a scan: where it stands, what it is made from, how it follows edits.

use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_volume::grid::Grid;
use palpate_volume::material::LocalContact;
use palpate_volume::voxel_box::VoxelBox;

use super::border::Border;
use super::box_place::BoxPlace;
use super::damage::Damage;
use super::inelastic::{Breaking, Inelastic, InelasticSettings};
use super::layout::Layout;
use super::nodes::{Lattice, NodeMaterial};
use super::relax::{RelaxSettings, Relaxer};
use super::resample::{RestVoxels, node_place};
use super::shift::shift;
use super::tool_contact::LatticeTool;
use super::vectors::{Field, vector_at, zero_field};
use crate::displacement::{Displacement, region_of};
use crate::material::Materials;
use crate::model::{ModelParts, ToolState};

/// Half axis of a tool, at least: a thinner one would slip between nodes [spacings].
const THINNEST: f64 = 0.5;

/// Distance from the tool's place within which its contact is valid [spacings].
const VALIDITY: f64 = 0.5;

/// Share of the box's half width over which voxels and picture fade to the unmoved body.
const FADING: f64 = 0.4;

/// Strain of one bond whose force is small.
const SMALL_STRAIN: f64 = 0.01;

/// A box of nodes and where it stands.
#[derive(Debug)]
pub(super) struct MovingBox {
    pub lattice: Lattice,
    pub inelastic: Inelastic,
    /// How far each node stays from where it was at first, as was last seen from near [mm].
    pub plastic: Field,
    /// Displacement of each node at rest without tools [mm].
    unloaded: Field,
    /// How much of what comes back is shown at each node: less and less toward the border.
    share: Vec<f64>,
    /// First node of the box, counted from the corner of the grid.
    pub origin: IVec3,
    /// Which of its nodes is in the middle of its cube, where a load is expected.
    pub middle: IVec3,
    pub grid: Grid,
    materials: Materials,
}

impl MovingBox {
    /// A box at a place, at rest.
    pub fn new(
        rest: &RestVoxels<'_>,
        place: &BoxPlace,
        spacing: f64,
        inelastic: InelasticSettings,
    ) -> Self {
        let BoxPlace {
            origin,
            size,
            middle,
        } = *place;
        let matter = |node| rest.matter_of_node(spacing, origin + node);
        let load = middle.as_dvec3() * spacing;
        let border = Border::Endless { load };
        let mut lattice = Lattice::new(size, spacing, border, matter);
        Self {
            inelastic: Inelastic::new(&mut lattice, inelastic),
            plastic: zero_field(lattice.layout().len()),
            unloaded: zero_field(lattice.layout().len()),
            share: shares(lattice.layout(), middle),
            lattice,
            origin,
            middle,
            grid: *rest.voxels.grid(),
            materials: rest.materials.clone(),
        }
    }

    /// Whether the box was built from this scan and these materials.
    pub fn fits(&self, rest: &RestVoxels<'_>) -> bool {
        self.grid == *rest.voxels.grid() && self.materials == *rest.materials
    }

    /// Stands elsewhere: what both places share goes on as it is, what does not come back is as in
    /// `damage`. What is new starts at rest, or where a tool presses as far as what is near.
    pub fn go(&mut self, rest: &RestVoxels<'_>, origin: IVec3, damage: &Damage, is_pressed: bool) {
        let offset = origin - self.origin;
        let spacing = self.lattice.spacing();
        let matter = |node: IVec3| rest.matter_of_node(spacing, origin + node);
        self.origin = origin;
        self.lattice.go(offset, &matter);
        if is_pressed {
            self.begin_along(offset, self.size());
        }
        self.inelastic.go(&self.lattice, offset);
        let layout = *self.lattice.layout();
        for axis in self.plastic.iter_mut().chain(&mut self.unloaded) {
            shift(&layout, axis, offset, 0.0);
        }
        damage.recall(self, |node| layout.index_of(node + offset).is_none());
        self.rest_border();
    }

    /// A box of another size or shape, of tissue that has not yielded: what both hold goes on as it is, what
    /// broke is as in `damage`. What is new starts as in [`Self::go`].
    pub fn reshaped(
        &self,
        rest: &RestVoxels<'_>,
        place: &BoxPlace,
        damage: &Damage,
        is_pressed: bool,
    ) -> Self {
        let (spacing, offset) = (self.lattice.spacing(), place.origin - self.origin);
        let mut new = Self::new(rest, place, spacing, self.inelastic.settings());
        damage.recall(&mut new, |_| true);
        let layout = *new.lattice.layout();
        for (node, to) in layout.nodes() {
            if let Some(from) = self.lattice.layout().index_of(node.as_ivec3() + offset) {
                new.lattice.set_moved(to, self.lattice.moved(from));
                new.inelastic
                    .fade_as(&mut new.lattice, to, (&self.inelastic, &self.lattice, from));
            }
        }
        if is_pressed {
            new.begin_along(offset, self.size());
        }
        new.lattice.take_frame(&self.lattice);
        new
    }

    /// Has tissue that is new in the box start as far moved as what is near: the box had so many nodes before,
    /// and has gone `offset` nodes on.
    fn begin_along(&mut self, offset: IVec3, before: UVec3) {
        let last = before.as_ivec3() - 1;
        self.lattice
            .move_along([-offset, last - offset], self.middle);
    }

    /// Where it stands.
    pub fn place(&self) -> BoxPlace {
        BoxPlace {
            origin: self.origin,
            size: self.size(),
            middle: self.middle,
        }
    }

    /// Nodes along each axis.
    pub fn size(&self) -> UVec3 {
        self.lattice.layout().size()
    }

    /// Nodes along each edge of its cube.
    pub fn edge(&self) -> u32 {
        self.size().min_element()
    }

    /// Has a node that is new in the box stand where it stayed [mm from where it was at first].
    pub fn begin_at(&mut self, index: usize, plastic: DVec3) {
        self.lattice.set_moved(index, plastic);
        for axis in 0..3 {
            self.plastic[axis][index] = plastic[axis];
            self.unloaded[axis][index] = plastic[axis];
        }
    }

    /// Has the border hold the nodes where they stay.
    fn rest_border(&mut self) {
        if self.has_yielded() {
            self.lattice.rest_border_at(&self.plastic);
        }
    }

    /// Whether any of its tissue has yielded.
    pub fn has_yielded(&self) -> bool {
        self.inelastic.has_yielded(&self.lattice)
    }

    /// Force of a small strain of one bond of the softest tissue [N]: it counts where no tool
    /// feels more.
    pub fn small_force(&self) -> f64 {
        SMALL_STRAIN * self.lattice.softest_bond() * self.lattice.spacing()
    }

    /// Voxels that its nodes reach where it begins at a node.
    pub fn region_from(&self, origin: IVec3) -> VoxelBox {
        let spacing = self.lattice.spacing();
        let first = node_place(origin, spacing);
        region_of(first, spacing, self.lattice.layout().size(), &self.grid)
    }

    /// Has what is too long break, and rest lengths yield, where they may.
    pub fn break_and_yield(&mut self, breaks: bool, yields: bool) -> Breaking {
        let may_yield = |index: usize| yields && self.share[index] == 1.0;
        self.inelastic
            .break_and_yield(&mut self.lattice, breaks, may_yield)
    }

    /// Notes that no tool presses the nodes: they stand where they stay.
    pub fn note_unloaded(&mut self) {
        self.unloaded.clone_from(&self.lattice.moved);
        self.note_plastic();
    }

    /// Brings what is known of where the nodes would stay without tools nearer to how it is; the nodes
    /// stay where they are.
    pub fn find_unloaded(
        &mut self,
        relaxer: &mut Relaxer,
        settings: &RelaxSettings,
        is_late: &dyn Fn() -> bool,
    ) {
        std::mem::swap(&mut self.lattice.moved, &mut self.unloaded);
        relaxer.relax(&mut self.lattice, &[], settings, is_late);
        if !self.is_finite() {
            self.lattice.put_to_rest();
        }
        std::mem::swap(&mut self.lattice.moved, &mut self.unloaded);
        self.note_plastic();
    }

    /// Near the border of the box, where what yielded beyond it is missing, nodes stay where they
    /// were when the box stood around them.
    fn note_plastic(&mut self) {
        for axis in 0..3 {
            let known = self.plastic[axis].iter_mut().zip(&self.unloaded[axis]);
            for ((plastic, unloaded), share) in known.zip(&self.share) {
                if *share == 1.0 {
                    *plastic = *unloaded;
                }
            }
        }
    }

    /// Follows what others have changed of the voxels: only what hangs on those is built anew.
    pub fn follow_edits(&mut self, rest: &RestVoxels<'_>) {
        let (origin, spacing) = (self.origin, self.lattice.spacing());
        let made_of = |node: IVec3| rest.matter_of_node(spacing, origin + node);
        let nodes = self.lattice.layout().nodes();
        let changes: Vec<_> = nodes
            .map(|(node, index)| (index, made_of(node.as_ivec3())))
            .filter(|(index, matter)| matter != self.lattice.matter(*index))
            .collect();
        if !changes.is_empty() {
            self.lattice.change(&changes, &made_of);
            self.inelastic.break_again(&mut self.lattice);
            self.rest_border();
        }
    }

    /// Half an edge of its cube, from the middle to its outermost nodes [mm].
    pub fn half_width(&self) -> f64 {
        0.5 * self.lattice.spacing() * f64::from(self.edge() - 1)
    }

    /// How much of what comes back is shown at a place, mm along the axes of the grid from its corner.
    pub fn share_at(&self, place: DVec3) -> f64 {
        let node = (place - self.corner()) / self.lattice.spacing();
        share_at(self.size(), self.middle, node)
    }

    /// Where its first node rests, mm along the axes of the grid from its corner.
    pub fn corner(&self) -> DVec3 {
        node_place(self.origin, self.lattice.spacing())
    }

    /// Where the tissue rests that is nearest to a tool, mm along the axes of the grid from its corner.
    pub fn tissue_near(&self, tool: &LatticeTool) -> Option<DVec3> {
        let lattice = &self.lattice;
        let soft = lattice
            .matter_nodes()
            .filter(|node| lattice.is_mobile(*node));
        let far = |node: &usize| lattice.place(*node).distance_squared(tool.centre);
        let nearest = soft.min_by(|one, other| far(one).total_cmp(&far(other)))?;
        Some(self.corner() + lattice.rest_place(nearest))
    }

    /// The mean place at rest of all its tissue, mm along the axes of the grid from its corner.
    pub fn middle_of_tissue(&self) -> Option<DVec3> {
        let nodes = self.lattice.matter_nodes();
        let (count, sum) = nodes.fold((0.0, DVec3::ZERO), |(count, sum), node| {
            (count + 1.0, sum + self.lattice.rest_place(node))
        });
        (count > 0.0).then(|| self.corner() + sum / count)
    }

    /// A tool in the lattice's frame.
    pub fn tool(&self, tool: &ToolState) -> LatticeTool {
        let first = node_place(self.origin, self.lattice.spacing());
        LatticeTool {
            centre: grid_mm(&self.grid, tool.position) - first,
            half_axes: tool
                .shape
                .half_axes()
                .max(DVec3::splat(THINNEST * self.lattice.spacing())),
            orientation: self.grid.direction().transpose() * DMat3::from_quat(tool.orientation),
        }
    }

    /// What a tool feels [N, patient], as a linear law: `stiffness` [N/mm] along the force, none across it.
    pub fn contact(&self, tool: &ToolState, force: DVec3, stiffness: f64) -> Option<LocalContact> {
        let normal = force.try_normalize()?;
        let along = DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        Some(LocalContact {
            position: tool.position,
            force,
            stiffness: along * -stiffness,
            validity: VALIDITY * self.lattice.spacing(),
        })
    }

    /// A place of the lattice's frame in the patient [mm].
    pub fn patient_place(&self, place: DVec3) -> DVec3 {
        let in_grid = node_place(self.origin, self.lattice.spacing()) + place;
        self.grid
            .patient_from_grid()
            .transform_point3(in_grid / self.grid.spacing())
    }

    /// Nodes of the box that hold tissue.
    pub fn parts(&self) -> ModelParts {
        let lattice = &self.lattice;
        let places = lattice.matter_nodes().map(|node| {
            [lattice.rest_place(node), lattice.place(node)].map(|place| self.patient_place(place))
        });
        ModelParts {
            places: places.collect(),
            apart: lattice.spacing(),
        }
    }

    /// Whether all nodes stand somewhere.
    pub fn is_finite(&self) -> bool {
        let mut nodes = self.lattice.matter_nodes();
        nodes.all(|node| self.lattice.moved(node).is_finite())
    }

    /// How far tissue has moved: what comes back less and less toward the border of the box, where
    /// the picture of the body behind it begins; what lasts as it is.
    pub fn displacement(&self) -> Displacement {
        let field = self.field(|index| {
            let plastic = vector_at(&self.plastic, index);
            plastic + (self.lattice.moved(index) - plastic) * self.share[index]
        });
        match self.has_yielded() {
            true => field.going_on(),
            false => field,
        }
    }

    /// Plastic displacement: what remains when no tool presses any more.
    pub fn plastic_displacement(&self) -> Displacement {
        self.field(|index| vector_at(&self.plastic, index))
    }

    fn field(&self, moved: impl Fn(usize) -> DVec3) -> Displacement {
        let layout = self.lattice.layout();
        let moved = |(_, index): (UVec3, usize)| {
            let is_matter = *self.lattice.matter(index) != NodeMaterial::Empty;
            is_matter.then(|| moved(index))
        };
        let spacing = self.lattice.spacing();
        Displacement::new(
            node_place(self.origin, spacing),
            spacing,
            layout.size(),
            layout.nodes().map(moved).collect(),
        )
    }
}

/// 1 around the middle of a box, and smoothly 0 at its border; where it is longer than its cube, it ends in air.
fn shares(layout: &Layout, middle: IVec3) -> Vec<f64> {
    let mut shares = vec![0.0; layout.len()];
    for (node, index) in layout.nodes() {
        shares[index] = share_at(layout.size(), middle, node.as_dvec3());
    }
    shares
}

/// The share of a place among the nodes of a box, which has so many; 0 beyond them.
fn share_at(size: UVec3, middle: IVec3, node: DVec3) -> f64 {
    let half = size.min_element() as i32 / 2;
    let above = size.as_ivec3() - 1 - middle;
    let [low, high] = [middle, above].map(|side| side.cmpeq(IVec3::splat(half)));
    let from = node - middle.as_dvec3();
    let is_beyond = from.cmplt(-middle.as_dvec3()) | from.cmpgt(above.as_dvec3());
    if is_beyond.any() {
        return 0.0;
    }
    let below = from.cmplt(DVec3::ZERO) & low;
    let faces =
        DVec3::select(below, -from, DVec3::ZERO).max(DVec3::select(high, from, DVec3::ZERO));
    let out = faces.max_element() / f64::from(half);
    let share = ((1.0 - out) / FADING).min(1.0);
    share * share * (3.0 - 2.0 * share)
}

/// A point of the patient in mm along the axes of the grid, from its corner.
pub(super) fn grid_mm(grid: &Grid, point: DVec3) -> DVec3 {
    grid.grid_from_patient().transform_point3(point) * grid.spacing()
}
