//! The fields around the proxy, kept while they stay what they are.
//!
//! A field belongs to a window of one body and to an epoch: a number that its owner changes
//! with every voxel of any body, and with the bodies themselves. What comes out is the same,
//! to the bit, with an empty cache.

use super::blur::BlurField;
use super::field::Field;
use crate::proxy::Proxy;
use crate::scene::{MAX_OBJECTS, TouchScene};
use glam::{DAffine3, DVec3};
use palpate_volume::occupancy::Occupancy;

/// Bodies that one contact point respects: a corner of three faces.
pub(crate) const MAX_FIELDS: usize = 3;
/// Fields that are kept: two of the world, between whose windows the proxy may go to and fro,
/// and one of each object.
const ENTRIES: usize = 2 + MAX_OBJECTS;

/// Fields around the proxy.
#[derive(Clone, Debug)]
pub struct SmoothCache {
    fields: Box<[BlurField; ENTRIES]>,
    epochs: [u64; ENTRIES],
    /// The field of the world that was used last.
    world: usize,
}

impl Default for SmoothCache {
    fn default() -> Self {
        Self {
            fields: Box::new(std::array::from_fn(|_| BlurField::empty())),
            epochs: [0; ENTRIES],
            world: 0,
        }
    }
}

/// A field of a body, and where it stands.
#[derive(Debug)]
pub struct PlacedField<'a, F> {
    /// The field.
    pub field: &'a F,
    /// 0 for the world, else the place of the object in its scene plus one.
    pub body: u8,
    /// Takes points in mm along the axes of the world's grid, from its corner on, to the grid
    /// of the field.
    pub field_from_world_mm: DAffine3,
    /// Size of its voxels [mm].
    pub spacing: DVec3,
    /// The shortest edge of its cells [mm].
    pub cell_length: f64,
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
    pub fn new(fields: impl IntoIterator<Item = PlacedField<'a, F>>) -> Self {
        let mut fields = fields.into_iter();
        Self {
            fields: std::array::from_fn(|_| fields.next()),
        }
    }

    /// One after the other.
    pub fn iter(&self) -> impl Iterator<Item = &PlacedField<'a, F>> {
        self.fields.iter().flatten()
    }
}

/// A body's field near the proxy.
#[derive(Clone, Copy, Debug)]
struct Near {
    place: usize,
    body: u8,
    field_from_world_mm: DAffine3,
    spacing: DVec3,
    value: f64,
}

impl SmoothCache {
    /// The fields of the bodies that are solid near the proxy: the three that reach it most.
    pub fn near<O: Occupancy>(
        &mut self,
        scene: &TouchScene<'_, O>,
        epoch: u64,
        proxy: &Proxy,
    ) -> NearFields<'_, BlurField> {
        let spacing = scene.grid.spacing();
        let point = proxy.point();
        let mut near = [None; MAX_FIELDS];

        // the world, in the older of its two fields where neither is the right one
        let is_world = |&place: &usize| {
            self.epochs[place] == epoch && self.fields[place].is_around(point, spacing)
        };
        let place = [self.world, 1 - self.world].into_iter().find(is_world);
        self.world = place.unwrap_or(1 - self.world);
        self.refresh(self.world, epoch, scene.occupancy, point, spacing);
        let world_from_mm = DAffine3::from_scale(spacing.recip());
        self.insert(
            &mut near,
            point,
            Near {
                place: self.world,
                body: 0,
                field_from_world_mm: world_from_mm,
                spacing,
                value: 0.0,
            },
        );

        for (number, object) in scene.objects.iter().enumerate().take(MAX_OBJECTS) {
            let (low, high) = object.box_in_world();
            let at = point * spacing;
            let apart = (low - at).max(at - high).max(DVec3::ZERO);
            if apart.length() > WINDOW_REACH * object.spacing().max_element() {
                continue;
            }
            let at = object.pose().to_object(point);
            let place = 2 + number;
            self.refresh(place, epoch, object.occupancy(), at, object.spacing());
            self.insert(
                &mut near,
                at,
                Near {
                    place,
                    body: number as u8 + 1,
                    field_from_world_mm: *object.pose().object_from_world() * world_from_mm,
                    spacing: object.spacing(),
                    value: 0.0,
                },
            );
        }

        let fields = &self.fields;
        NearFields::new(near.into_iter().flatten().map(|near| PlacedField {
            field: &fields[near.place],
            body: near.body,
            field_from_world_mm: near.field_from_world_mm,
            spacing: near.spacing,
            cell_length: (fields[near.place].kernel().cell * near.spacing).min_element(),
        }))
    }

    /// Makes the field at a place the one around a point of a body's grid.
    fn refresh<O: Occupancy>(
        &mut self,
        place: usize,
        epoch: u64,
        occupancy: &O,
        point: DVec3,
        spacing: DVec3,
    ) {
        let field = &mut self.fields[place];
        if self.epochs[place] != epoch || !field.is_around(point, spacing) {
            field.around(occupancy, point, spacing);
            self.epochs[place] = epoch;
        }
    }

    /// Puts a field among those that reach the proxy, at a point of its grid, most.
    fn insert(&self, near: &mut [Option<Near>; MAX_FIELDS], point: DVec3, mut new: Near) {
        let field = &self.fields[new.place];
        if !field.any_solid() {
            return;
        }
        new.value = field.sample(point).wide.value;
        for old in near {
            match old {
                Some(old) if old.value >= new.value => {}
                Some(old) => std::mem::swap(old, &mut new),
                None => {
                    *old = Some(new);
                    return;
                }
            }
        }
    }
}

/// Voxels of the coarsest axis within which a body can be in the window of the proxy: half a
/// window of cells of two voxels, along its diagonal.
const WINDOW_REACH: f64 = 16.0;
