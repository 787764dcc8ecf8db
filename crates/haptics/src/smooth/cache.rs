//! The fields around the proxy, kept while they stay what they are.
//!
//! A field belongs to a window of one body and to an epoch: a number that its owner changes
//! with every voxel of any body, and with the bodies themselves. What comes out is the same,
//! to the bit, with an empty cache.

use super::ahead::Ahead;
use super::aim::{Aim, Aims};
use super::blur::{BlurField, make_around};
use super::cell_fractions::CellFractions;
use super::field::Field;
use crate::ball::MAX_BODIES;
use crate::contact::Proxy;
use crate::scene::{MAX_OBJECTS, TouchScene};
use glam::{DMat3, DVec3, Mat3A, Vec3A};
use palpate_volume::occupancy::Occupancy;

/// Bodies that one contact point respects: a corner of three faces.
pub(crate) const MAX_FIELDS: usize = 3;
/// Fields of the world that are kept, between whose windows the proxy may go to and fro.
const OF_WORLD: usize = 4;
/// Fields that are kept: those of the world, and one of each object.
const ENTRIES: usize = OF_WORLD + MAX_OBJECTS;

/// Fields around the proxy.
#[derive(Clone, Debug)]
pub struct SmoothCache {
    fields: Box<[BlurField; ENTRIES]>,
    /// What each field was made from; none where it is not to be used.
    sources: [Option<Source>; ENTRIES],
    /// What is known of the cells of each body: the world's, then those of objects.
    fractions: Box<[CellFractions; MAX_BODIES]>,
    /// Where balls touch.
    aims: Aims,
    /// The field of the world that was used last.
    world: usize,
    /// The one that was made last.
    filled: usize,
    /// What a ball will need of the world next.
    ahead: Ahead,
}

/// What fields are made from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Source {
    /// A number that changes with every voxel of any body, with what is known of their fractions,
    /// and with the bodies themselves.
    pub epoch: u64,
    /// Whether voxels at the surface count by their fractions, where bodies know them.
    pub fractions: bool,
}

impl Default for SmoothCache {
    fn default() -> Self {
        Self {
            fields: Box::new(std::array::from_fn(|_| BlurField::empty())),
            sources: [None; ENTRIES],
            fractions: Box::new([CellFractions::EMPTY; MAX_BODIES]),
            aims: Aims::NONE,
            world: 0,
            filled: 0,
            ahead: Ahead::NONE,
        }
    }
}

/// A field of a body, and where it stands. A search has its origin in the proxy, mm along the
/// axes of the world's grid.
#[derive(Debug)]
pub struct PlacedField<'a, F> {
    /// The field.
    pub(crate) field: &'a F,
    /// 0 for the world, else the place of the object in its scene plus one.
    pub(crate) body: u8,
    /// The proxy among the field's nodes.
    pub(crate) proxy: Vec3A,
    /// From a ball's middle to where it touches the body, about [mm]; zero for a point.
    pub(crate) contact: Vec3A,
    /// Edges of the body's voxels [mm].
    pub(crate) voxel: Vec3A,
    /// Takes ways of the search to ways along the nodes.
    pub(crate) nodes_from_search: Mat3A,
    /// Takes gradients the other way.
    pub(crate) gradient_from_nodes: Mat3A,
    /// The shortest way from a node to the next [mm].
    pub(crate) cell: f32,
    /// Variance of the wide kernel along the axes of the nodes [mm²], as it stands to squared
    /// ways along the nodes.
    pub(crate) wide_variance: Vec3A,
}

impl<'a, F: Field> PlacedField<'a, F> {
    fn new(field: &'a F, near: &Near) -> Self {
        let cell = field.cell();
        let per_cell = cell.recip();
        let (axes, spacing) = (near.axes, near.spacing.as_vec3a());
        let nodes_from_search = Mat3A::from_cols(
            axes.x_axis * per_cell,
            axes.y_axis * per_cell,
            axes.z_axis * per_cell,
        );
        let cell_mm = cell * spacing;
        let root = field.kernel().wide * cell_mm * cell_mm;
        Self {
            field,
            body: near.body,
            proxy: field.nodes_at(near.proxy),
            // axes are those of a rotation, but for the size of voxels
            contact: axes.transpose() * (near.aim.contact.as_vec3a() * spacing),
            voxel: spacing,
            nodes_from_search,
            gradient_from_nodes: nodes_from_search.transpose(),
            cell: cell_mm.min_element(),
            wide_variance: root * root,
        }
    }
}

impl<F> Clone for PlacedField<'_, F> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<F> Copy for PlacedField<'_, F> {}

/// The fields that a contact point is found on.
#[derive(Clone, Copy, Debug)]
pub struct NearFields<'a, F> {
    fields: [Option<PlacedField<'a, F>>; MAX_FIELDS],
}

impl<'a, F> NearFields<'a, F> {
    /// The first three of some fields.
    fn new(fields: impl IntoIterator<Item = PlacedField<'a, F>>) -> Self {
        let mut fields = fields.into_iter();
        Self {
            fields: std::array::from_fn(|_| fields.next()),
        }
    }

    /// No fields.
    #[must_use]
    pub fn none() -> Self {
        Self {
            fields: [const { None }; MAX_FIELDS],
        }
    }

    /// The one that there is; none where there are several.
    pub(crate) fn only(&self) -> Option<&PlacedField<'a, F>> {
        match &self.fields {
            [Some(only), None, None] => Some(only),
            _ => None,
        }
    }

    /// A place for each, vacant or not.
    pub(crate) fn all(&self) -> [Option<&PlacedField<'a, F>>; MAX_FIELDS] {
        self.fields.each_ref().map(Option::as_ref)
    }

    /// One after the other.
    pub fn iter(&self) -> impl Iterator<Item = &PlacedField<'a, F>> {
        self.fields.iter().flatten()
    }
}

/// A body's field near the probe.
#[derive(Clone, Copy, Debug)]
struct Near {
    place: usize,
    body: u8,
    /// Voxels of its grid [mm].
    spacing: DVec3,
    /// Takes ways in mm along the axes of the world's grid to ways in that of the body.
    axes: Mat3A,
    /// The proxy in the grid of the body.
    proxy: DVec3,
    aim: Aim,
}

impl SmoothCache {
    /// Has every field made anew.
    pub fn forget(&mut self) {
        self.sources = [None; ENTRIES];
        self.aims.forget();
        self.fractions.iter_mut().for_each(CellFractions::forget);
    }

    /// The fields of the bodies that are solid near the probe, whose device is a point of the
    /// world's grid; where those are more than three, the three that reach it most.
    pub fn near<O: Occupancy>(
        &mut self,
        scene: &TouchScene<'_, O>,
        source: Source,
        proxy: &Proxy,
        device: DVec3,
    ) -> NearFields<'_, BlurField> {
        let spacing = scene.grid.spacing();
        let point = proxy.point();
        let aim = self
            .aims
            .aim(0, source, scene.occupancy, spacing, [point, device]);
        self.refresh_world(scene, source, &aim);
        let world = Near {
            place: self.world,
            body: 0,
            spacing,
            axes: Mat3A::from_diagonal(spacing.recip().as_vec3()),
            proxy: point,
            aim,
        };
        if scene.objects.is_empty() {
            let field = &self.fields[self.world];
            let placed = || PlacedField::new(field, &world);
            return NearFields {
                fields: [field.any_solid().then(placed), None, None],
            };
        }

        let mut near = [None; MAX_FIELDS];
        self.insert(&mut near, world);
        for (number, object) in scene.objects.iter().enumerate().take(MAX_OBJECTS) {
            let (low, high) = object.box_in_world();
            let at = point * spacing;
            let apart = (low - at).max(at - high).max(DVec3::ZERO);
            if apart.length() > WINDOW_REACH * object.spacing().max_element() {
                continue;
            }
            let world_from_mm = DMat3::from_diagonal(spacing.recip());
            let object_from_mm = object.pose().object_from_world().matrix3 * world_from_mm;
            let places = [point, device].map(|point| object.pose().to_object(point));
            let (occupancy, spacing) = (object.occupancy(), object.spacing());
            let new = Near {
                place: OF_WORLD + number,
                body: number as u8 + 1,
                spacing,
                axes: Mat3A::from(object_from_mm.as_mat3()),
                proxy: places[0],
                aim: self
                    .aims
                    .aim(number + 1, source, occupancy, spacing, places),
            };
            self.refresh(new.place, source, occupancy, &new.aim, spacing);
            self.insert(&mut near, new);
        }

        let fields = &self.fields;
        NearFields::new(
            near.into_iter()
                .flatten()
                .map(|near| PlacedField::new(&fields[near.place], &near)),
        )
    }

    /// Makes one of the fields of the world the one around an aim: the oldest of them where
    /// none is it.
    fn refresh_world<O: Occupancy>(
        &mut self,
        scene: &TouchScene<'_, O>,
        source: Source,
        aim: &Aim,
    ) {
        let spacing = scene.grid.spacing();
        let is_world = |&place: &usize| {
            self.sources[place] == Some(source) && self.fields[place].is_around(aim, spacing)
        };
        // mostly the last one still
        let kept = (0..OF_WORLD).map(|next| (self.world + next) % OF_WORLD);
        match kept.into_iter().find(is_world) {
            Some(place) => {
                self.world = place;
                if aim.contact != DVec3::ZERO {
                    self.ahead.work(scene.occupancy);
                }
            }
            None => {
                self.filled = (self.filled + 1) % OF_WORLD;
                self.world = self.filled;
                self.fill(self.world, source, scene.occupancy, aim, spacing);
                self.ahead.follow(self.fields[self.world].voxels());
            }
        }
    }

    /// Puts a field among those that reach the probe most, if it does.
    fn insert(&self, near: &mut [Option<Near>; MAX_FIELDS], mut new: Near) {
        if !self.fields[new.place].any_solid() {
            return;
        }
        if let Some(free) = near.iter_mut().find(|near| near.is_none()) {
            *free = Some(new);
            return;
        }
        for near in near.iter_mut().flatten() {
            if self.value(near) < self.value(&new) {
                std::mem::swap(near, &mut new);
            }
        }
    }

    /// The level of a field at the probe.
    fn value(&self, near: &Near) -> f32 {
        let field = &self.fields[near.place];
        field.wide_value(field.nodes_at(near.proxy + near.aim.contact / near.spacing))
    }

    /// Makes the field at a place the one around an aim at a body.
    fn refresh<O: Occupancy>(
        &mut self,
        place: usize,
        source: Source,
        occupancy: &O,
        aim: &Aim,
        spacing: DVec3,
    ) {
        let field = &self.fields[place];
        if self.sources[place] != Some(source) || !field.is_around(aim, spacing) {
            self.fill(place, source, occupancy, aim, spacing);
        }
    }

    fn fill<O: Occupancy>(
        &mut self,
        place: usize,
        source: Source,
        occupancy: &O,
        aim: &Aim,
        spacing: DVec3,
    ) {
        self.sources[place] = Some(source);
        let body = (place + 1).saturating_sub(OF_WORLD);
        let known = (source.fractions && occupancy.knows_fractions())
            .then(|| (source, &mut self.fractions[body]));
        make_around(&mut self.fields[place], occupancy, aim, spacing, known);
    }
}

/// Voxels of the coarsest axis within which a body can be in the window of the proxy: half a
/// window of cells of two voxels, along its diagonal.
const WINDOW_REACH: f64 = 16.0;
