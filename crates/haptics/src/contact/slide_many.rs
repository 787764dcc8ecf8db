//! One slide of the proxy among several bodies: to a node that brings it nearer.
//!
//! First the voxels of each body that was met, as in `slide.rs`: the window of that body's own
//! lattice, so that the stairs of one body are climbed as if it were alone. Then, between the
//! stairs of two bodies, by feeling along their faces (`corner_search.rs`). A way is taken only if each
//! of its legs was walked free in every body, and if, after a descent from its end, the device
//! is nearer than before by more than rounding.
//!
//! Frame: the world's grid, lengths in mm.

use crate::contact::bodies::{Bodies, Visits};
use crate::contact::corner_search::search_corner;
use crate::contact::descent::{Descent, descend};
use crate::contact::node_lattice::{NODES, NodeLattice, Way, clear};
use crate::contact::slide_window::{LayerDistances, SlideWindow};
use crate::contact::voxel_distance::nearest_point;
use glam::{DVec3, IVec3};
use palpate_volume::occupancy::Occupancy;

/// By how much a slide or a descent must lower the distance to the device, in smallest
/// spacings: what is less is rounding, and the proxy stays.
pub(crate) const LEAST_GAIN: f64 = 1e-5;

/// Ways tried in one lattice.
const TRIES: u32 = 4;
/// Least gain of a corner search [voxels]: a smaller one would make the probe crawl.
const CREEP_GAIN: f64 = 0.02;

/// A slide to be found.
#[derive(Debug)]
pub(crate) struct Slide<'a, 'b, O> {
    pub bodies: &'a Bodies<'b, O>,
    pub from: DVec3,
    pub device: DVec3,
    /// The bodies that were met there, as bits.
    pub met: u32,
    /// Most voxels of the first leg of a descent.
    pub most_visits: u32,
}

impl<O: Occupancy> Slide<'_, '_, O> {
    /// A place that is strictly nearer to the device.
    pub(crate) fn find(&self, visits: &mut Visits) -> Option<Descent> {
        let is_met = |body: &u8| self.met >> body & 1 == 1;
        let mut met = self.bodies.numbers().filter(is_met);
        let found = met.find_map(|body| self.along_voxels(body, visits));
        if found.is_some() || self.met.count_ones() < 2 {
            return found;
        }
        let limit = self.limit(CREEP_GAIN);
        let place = search_corner(self.bodies, self.from, self.device, self.met, limit, visits)?;
        Some(descend(
            self.bodies,
            place,
            self.device,
            self.most_visits,
            visits,
        ))
    }

    /// Distance that has to be undercut, squared [mm²].
    fn limit(&self, gain: f64) -> f64 {
        let gain = gain * self.bodies.smallest_spacing();
        let here = self.bodies.squared_distance(self.from, self.device).sqrt();
        (here - gain).max(0.0).powi(2)
    }

    /// A slide in the window of a body's own voxels, by the distance to their boxes.
    fn along_voxels(&self, body: u8, visits: &mut Visits) -> Option<Descent> {
        let [from, device] = [self.from, self.device].map(|point| self.bodies.to_body(body, point));
        let voxel = from.floor().as_ivec3();
        let window = SlideWindow::new(voxel, device);
        let start = voxel - window.min;
        if !visits.take(NODES) {
            return None;
        }
        let open = window.outside(&self.bodies.block(body, window.min));
        let distances = LayerDistances::new(window.min, device, self.bodies.spacing(body));
        let axes = self.bodies.world_from_body(body).matrix3;
        let lattice = NodeLattice {
            origin: self.from,
            start,
            steps: [axes.x_axis, axes.y_axis, axes.z_axis],
            open,
            blocked: [[0; 8]; 3],
        };
        self.best_of(lattice, &distances, Some(body), visits)
    }

    /// Takes the ways to the nearest nodes that are near enough, until one leads nearer.
    fn best_of(
        &self,
        mut lattice: NodeLattice,
        distances: &LayerDistances,
        voxels_of: Option<u8>,
        visits: &mut Visits,
    ) -> Option<Descent> {
        let limit = self.limit(LEAST_GAIN);
        let mut nearer = distances.nearer(&lattice.open, limit);
        clear(&mut nearer, lattice.start);
        if nearer == [0; 8] {
            return None;
        }

        // what the other bodies leave open of that
        let reached = lattice.ways().reached;
        if common(&nearer, &reached) == [0; 8] {
            return None;
        }
        for body in self.bodies.numbers() {
            if voxels_of != Some(body) && !lattice.close_solid(self.bodies, body, &reached, visits)
            {
                return None;
            }
        }

        for _ in 0..TRIES {
            let ways = lattice.ways();
            let candidates = common(&common(&nearer, &lattice.open), &ways.reached);
            let node = distances.nearest(&candidates)?;
            let way = ways.to(&lattice, node)?;
            match self.take(&lattice, &way, voxels_of, visits) {
                Taken::Nearer(descent) => return Some(descent),
                Taken::NotNearer => clear(&mut nearer, node),
                Taken::Blocked { from, to } => lattice.block(from, to),
            }
        }
        None
    }

    /// Walks a way, and from its end toward the device.
    fn take(
        &self,
        lattice: &NodeLattice,
        way: &Way,
        voxels_of: Option<u8>,
        visits: &mut Visits,
    ) -> Taken {
        // straight to its end, or else from node to node
        let Some(&last) = way.nodes().last() else {
            return Taken::NotNearer;
        };
        let mut at = lattice.point(last);
        if !self.bodies.is_free(lattice.origin, at, visits) {
            at = lattice.origin;
            let mut before = lattice.start;
            for &node in way.nodes() {
                let next = lattice.point(node);
                if !self.bodies.is_free(at, next, visits) {
                    return Taken::Blocked {
                        from: before,
                        to: node,
                    };
                }
                (at, before) = (next, node);
            }
        }

        // the point of its voxel that is nearest to the device, then on from there
        if let Some(body) = voxels_of {
            let [here, device] = [at, self.device].map(|point| self.bodies.to_body(body, point));
            let nearest = nearest_point(here.floor().as_ivec3(), device);
            let goal = self.bodies.world_from_body(body).transform_point3(nearest);
            if self.bodies.is_free(at, goal, visits) {
                at = goal;
            }
        }
        let descent = descend(self.bodies, at, self.device, self.most_visits, visits);
        let distance = self.bodies.squared_distance(descent.point, self.device);
        if descent.arrived || distance < self.limit(LEAST_GAIN) {
            Taken::Nearer(descent)
        } else {
            Taken::NotNearer
        }
    }
}

/// What came of a way.
enum Taken {
    Nearer(Descent),
    NotNearer,
    /// Something stands between these nodes.
    Blocked {
        from: IVec3,
        to: IVec3,
    },
}

fn common(a: &[u64; 8], b: &[u64; 8]) -> [u64; 8] {
    std::array::from_fn(|z| a[z] & b[z])
}
