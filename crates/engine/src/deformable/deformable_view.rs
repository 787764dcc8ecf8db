//! The nodes or particles of the model at work, each with its strain: for whoever wants to see
//! the model itself. Only where that is asked for, and only the newest.
//!
//! Frame: scene, LPS mm. Source: thesis 5.26 shows its particles so.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

use glam::{DVec3, IVec3};
use palpate_deform::model::ModelParts;

/// Parts that are shown at most; of more, every so many-th.
const MOST_PARTS: usize = 20_000;
/// Neighbours are nearer at rest than this [distance of neighbours].
const REACH: f64 = 1.2;
/// Strain at the ends of the scale.
const FULL_STRAIN: f64 = 0.5;
/// Steps of a box along each axis.
const STEPS: f64 = 65535.0;

/// Parts of a model as the page draws them.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownParts {
    /// Lower corner of the box around them [mm].
    pub origin: DVec3,
    /// Its edges [mm].
    pub size: DVec3,
    /// Between neighbours at rest [mm].
    pub apart: f64,
    /// Three little-endian u16 a part: place = origin + number / 65535 · size.
    pub places: Vec<u8>,
    /// An i8 a part: its strain is number / 127 · 0.5, less than zero where it is pressed.
    pub strains: Vec<u8>,
}

impl ShownParts {
    /// What is shown of parts; none where there are none.
    #[must_use]
    pub fn of(parts: &ModelParts) -> Option<Self> {
        let every = parts.places.len().div_ceil(MOST_PARTS).max(1);
        let now = || parts.places.iter().step_by(every).map(|[_, now]| *now);
        let low = now().reduce(DVec3::min)?;
        let size = now().fold(low, DVec3::max) - low;
        let strains = strains(parts);
        let share = |place: DVec3| (place - low) / size.max(DVec3::splat(f64::MIN_POSITIVE));
        let numbers = now().flat_map(|place| (share(place) * STEPS).round().to_array());
        let strain = |strain: &f64| {
            let number = (strain / FULL_STRAIN).clamp(-1.0, 1.0) * 127.0;
            number.round() as i8 as u8
        };
        Some(Self {
            origin: low,
            size,
            apart: parts.apart,
            places: numbers
                .flat_map(|number| (number as u16).to_le_bytes())
                .collect(),
            strains: strains.iter().step_by(every).map(strain).collect(),
        })
    }
}

/// How far each part is from its neighbours, against rest: the change that is largest.
fn strains(parts: &ModelParts) -> Vec<f64> {
    let edge = REACH * parts.apart;
    let cell = |place: DVec3| (place / edge).floor().as_ivec3();
    let mut cells: HashMap<IVec3, Vec<usize>> = HashMap::new();
    for (index, [rest, _]) in parts.places.iter().enumerate() {
        cells.entry(cell(*rest)).or_default().push(index);
    }
    let around = |place: DVec3| {
        let middle = cell(place);
        let cells = &cells;
        let offset = |i: i32| IVec3::new(i % 3, i / 3 % 3, i / 9) - 1;
        (0..27)
            .filter_map(move |i| cells.get(&(middle + offset(i))))
            .flatten()
    };
    let strain = |[rest, now]: &[DVec3; 2]| {
        let mut largest = 0.0_f64;
        for &other in around(*rest) {
            let [other_rest, other_now] = parts.places[other];
            let length = rest.distance(other_rest);
            if length > 0.0 && length < edge {
                let change = now.distance(other_now) / length - 1.0;
                largest = if change.abs() > largest.abs() {
                    change
                } else {
                    largest
                };
            }
        }
        largest
    };
    parts.places.iter().map(strain).collect()
}

/// Where the newest parts wait for whoever shows them.
#[derive(Debug, Default)]
pub struct DeformableView {
    wanted: AtomicBool,
    newest: Mutex<Option<ShownParts>>,
}

impl DeformableView {
    /// Has parts shown from the next answer on, or no more.
    pub fn want(&self, wanted: bool) {
        self.wanted.store(wanted, Relaxed);
        if !wanted {
            self.put(None);
        }
    }

    /// Whether anybody looks.
    #[must_use]
    pub fn is_wanted(&self) -> bool {
        self.wanted.load(Relaxed)
    }

    /// Puts parts in the place of those that wait.
    pub fn put(&self, parts: Option<ShownParts>) {
        *self.newest.lock().unwrap_or_else(PoisonError::into_inner) = parts;
    }

    /// The parts that came since the call before.
    pub fn take(&self) -> Option<ShownParts> {
        self.newest
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of parts 2 mm apart, of which the last stands `moved` mm beside its place.
    fn row(count: usize, moved: f64) -> ModelParts {
        let rest = |i: usize| DVec3::X * (2.0 * i as f64);
        let now = |i: usize| rest(i) + DVec3::X * if i + 1 == count { moved } else { 0.0 };
        ModelParts {
            places: (0..count).map(|i| [rest(i), now(i)]).collect(),
            apart: 2.0,
        }
    }

    #[test]
    fn strain_is_the_largest_change_of_distance_to_a_neighbour() {
        assert_eq!(strains(&row(4, -0.5)), [0.0, 0.0, -0.25, -0.25]);
        assert_eq!(strains(&row(4, 0.5)), [0.0, 0.0, 0.25, 0.25]);
        let shown = ShownParts::of(&row(4, -0.5)).unwrap();
        // a quarter of half the scale
        assert_eq!(shown.strains, [0, 0, -64_i8 as u8, -64_i8 as u8]);
        let last = u16::from_le_bytes([shown.places[18], shown.places[19]]);
        assert_eq!((shown.size.x, last), (5.5, 65535));
    }

    #[test]
    fn of_too_many_parts_every_so_many_th_is_shown() {
        let shown = ShownParts::of(&row(50_000, 0.0)).unwrap();
        assert_eq!(shown.strains.len(), 50_000_usize.div_ceil(3));
        assert_eq!(shown.places.len(), 6 * shown.strains.len());
        assert!(ShownParts::of(&ModelParts::default()).is_none());
    }

    #[test]
    fn only_the_newest_waits_and_none_once_nobody_looks() {
        let view = DeformableView::default();
        view.want(true);
        view.put(ShownParts::of(&row(3, 0.0)));
        view.put(ShownParts::of(&row(4, 0.0)));
        assert_eq!(view.take().map(|shown| shown.strains.len()), Some(4));
        assert!(view.take().is_none());
        view.put(ShownParts::of(&row(4, 0.0)));
        view.want(false);
        assert!(view.take().is_none() && !view.is_wanted());
    }
}
