//! Straight to the device, then along the faces that are met, while it comes nearer.
//!
//! A leg that is stopped by a face goes on along it: the way to the device is cut down to the
//! directions that lead into none of the faces met (the nearest direction in the cone that
//! they leave open). So the proxy slides down one face, then along the crease of two, of
//! whichever bodies and at whatever angle, until the faces that hold it leave no way nearer.
//!
//! Frame: the world's grid, lengths in mm. Source: Zilles & Salisbury, "A constraint-based
//! god-object method for haptic display", IROS 1995, with exact walks in place of their
//! constraint surfaces.

use crate::contact::bodies::{Bodies, Leg, LegHit, Visits};
use crate::scene::Solid;
use glam::DVec3;
use palpate_volume::occupancy::Occupancy;

/// How far off a face the proxy stops, in smallest spacings: far above the rounding of the maps
/// between grids, far below anything that can be felt.
const SKIN: f64 = 1e-7;
/// Less than this is no way, in smallest spacings.
const STILL: f64 = 1e-6;
/// Most legs of one descent: a slide to a crease and along it to a corner takes seven.
const MAX_LEGS: u32 = 16;

/// Where a descent ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Descent {
    pub point: DVec3,
    /// What holds it there, last met first; none where nothing does.
    pub stopped_by: Option<Solid>,
    /// The bodies of the faces that were met, as bits.
    pub met: u32,
    /// The device's place is free, and reached.
    pub arrived: bool,
}

/// Moves a point toward the device by free legs only. The first leg goes as far as
/// `most_visits` voxels.
pub(crate) fn descend<O: Occupancy>(
    bodies: &Bodies<'_, O>,
    from: DVec3,
    device: DVec3,
    most_visits: u32,
    visits: &mut Visits,
) -> Descent {
    let spacing = bodies.scene.grid.spacing();
    let still = STILL * bodies.smallest_spacing();
    let mut descent = Descent {
        point: from,
        stopped_by: None,
        met: 0,
        arrived: false,
    };
    let mut faces = Faces::default();
    for _ in 0..MAX_LEGS {
        // where to: the device, or along the faces met
        let wanted = (device - descent.point) * spacing;
        let allowed = faces.allowed(wanted);
        if allowed.length_squared() <= still * still && !faces.is_empty() {
            if faces.are_fresh {
                break;
            }
            // some may lie behind by now
            faces = Faces::default();
            continue;
        }
        let straight = faces.is_empty();
        let goal = if straight {
            bodies.shortened(descent.point, device, most_visits)
        } else {
            descent.point + allowed / spacing
        };

        match bodies.walk(descent.point, goal, visits) {
            Leg::Free => {
                descent.point = goal;
                faces = Faces::default();
                if straight {
                    descent.arrived = goal == device;
                    descent.stopped_by = None;
                    break;
                }
            }
            Leg::Hit(hit) => {
                descent.stopped_by = Some(hit.solid);
                descent.met |= 1 << hit.solid.body;
                let way = (goal - descent.point) * spacing;
                if way.length() * hit.fraction > still
                    && let Some(point) = before(bodies, descent.point, goal, &hit, visits)
                {
                    descent.point = point;
                    faces.keep_along(allowed);
                }
                if !faces.add(hit.normal) {
                    break;
                }
            }
            Leg::Unknown => break,
        }
    }
    descent
}

/// The point a skin before a hit, where it is free as well.
pub(crate) fn before<O: Occupancy>(
    bodies: &Bodies<'_, O>,
    from: DVec3,
    goal: DVec3,
    hit: &LegHit,
    visits: &mut Visits,
) -> Option<DVec3> {
    let spacing = bodies.scene.grid.spacing();
    let skin = hit.normal * (SKIN * bodies.smallest_spacing()) / spacing;
    let met = from + (goal - from) * hit.fraction;
    // in a narrow corner the skin of one face may reach over another
    [met + skin, from.lerp(met, 0.999), from.lerp(met, 0.5)]
        .into_iter()
        .find(|&point| bodies.is_free(from, point, visits))
}

/// The faces that hold a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Faces {
    normals: [DVec3; MAX_FACES],
    count: usize,
    /// The point has not moved since the first of them was met.
    are_fresh: bool,
}

/// Three hold a point; one more may have been met before.
const MAX_FACES: usize = 4;

impl Default for Faces {
    fn default() -> Self {
        Self {
            normals: [DVec3::ZERO; MAX_FACES],
            count: 0,
            are_fresh: true,
        }
    }
}

impl Faces {
    fn is_empty(&self) -> bool {
        self.count == 0
    }

    fn normals(&self) -> &[DVec3] {
        self.normals.get(..self.count).unwrap_or(&[])
    }

    /// Adds a face; false where it is known already, or one too many.
    pub(crate) fn add(&mut self, normal: DVec3) -> bool {
        // 1e-10: the angle of a rounding error, as its square
        let known = self
            .normals()
            .iter()
            .any(|known| known.distance_squared(normal) < 1e-10);
        let Some(place) = self.normals.get_mut(self.count) else {
            return false;
        };
        *place = normal;
        self.count += 1;
        !known && normal != DVec3::ZERO
    }

    /// After a move: forgets the faces that it led away from.
    pub(crate) fn keep_along(&mut self, way: DVec3) {
        let old = *self;
        self.count = 0;
        self.are_fresh = false;
        for &normal in old.normals() {
            if normal.dot(way) <= 1e-9 * way.length()
                && let Some(place) = self.normals.get_mut(self.count)
            {
                *place = normal;
                self.count += 1;
            }
        }
        if self.count == 0 {
            self.are_fresh = true;
        }
    }

    /// The vector nearest to `wanted` that leads into none of the faces: its projection on
    /// the cone that they leave open, found among those on no face, on one, and on two.
    pub(crate) fn allowed(&self, wanted: DVec3) -> DVec3 {
        let normals = self.normals();
        let tolerance = -1e-12 * wanted.length();
        let is_allowed = |way: DVec3| normals.iter().all(|normal| normal.dot(way) >= tolerance);
        let mut best = DVec3::ZERO;
        let mut try_way = |way: DVec3| {
            if way.length_squared() > best.length_squared() && is_allowed(way) {
                best = way;
            }
        };
        try_way(wanted);
        for (place, &first) in normals.iter().enumerate() {
            try_way(wanted - first * wanted.dot(first));
            for &second in normals.iter().skip(place + 1) {
                let crease = first.cross(second).try_normalize().unwrap_or(DVec3::ZERO);
                try_way(crease * wanted.dot(crease));
            }
        }
        best
    }
}
