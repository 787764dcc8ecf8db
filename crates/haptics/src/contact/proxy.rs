//! The proxy: the point that touches; with `exact` it is always in a free voxel.
//!
//! Being free is what whoever makes one vouches for. The thesis' models cannot, and say so
//! in `Contact::violation`.
//!
//! Frame: grid; voxel (i, j, k) covers [i, i+1) on each axis. The proxy is kept as a voxel
//! and a point strictly inside it, so that no rounding carries the point into a
//! neighbour that may be solid.
//! Source: Zilles & Salisbury, "A constraint-based god-object method for haptic display",
//! IROS 1995.

use crate::contact::voxel_distance::nearest_point;
use glam::{DVec3, IVec3};
use palpate_volume::walk::{COORDINATE_LIMIT, voxel_of};
use serde::{Deserialize, Serialize};

/// Where the proxy is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Place")]
pub struct Proxy {
    voxel: IVec3,
    point: DVec3,
}

/// A proxy as a file tells it, before anybody has looked at it.
#[derive(Deserialize)]
struct Place {
    voxel: IVec3,
    point: DVec3,
}

impl TryFrom<Place> for Proxy {
    type Error = String;

    fn try_from(Place { voxel, point }: Place) -> Result<Self, String> {
        match Self::at(point) {
            Some(proxy) if proxy.voxel == voxel => Ok(proxy),
            _ => Err(format!(
                "proxy at {point} in voxel {voxel} given; allowed: a finite point in its voxel"
            )),
        }
    }
}

impl Proxy {
    /// The proxy at a point of the grid frame, whose voxel the caller knows to be free.
    /// None where the point is not finite or farther than traversals reach.
    pub fn at(point_in_grid: DVec3) -> Option<Self> {
        // written so that NaN is refused
        let reach = DVec3::splat(COORDINATE_LIMIT);
        let within = point_in_grid.abs().cmple(reach).all();
        within.then(|| Self {
            voxel: voxel_of(point_in_grid),
            point: point_in_grid,
        })
    }

    /// The proxy in a free voxel, as near to `target` as it can be there.
    pub fn nearest_in(voxel: IVec3, target: DVec3) -> Self {
        Self {
            voxel,
            point: nearest_point(voxel, target),
        }
    }

    /// The voxel that it is in.
    pub fn voxel(&self) -> IVec3 {
        self.voxel
    }

    /// The point, grid frame.
    pub fn point(&self) -> DVec3 {
        self.point
    }
}
