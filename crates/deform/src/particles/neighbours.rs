//! Lists of the particles near each particle, kept until one has moved half the margin.
//!
//! Full lists: each pair stands in both. Every list holds the
//! particle itself too, once or more so that its length is a multiple of eight; the pair loop
//! passes over it. Rebuilds are counted.
//! Source: Verlet, Phys. Rev. 159 (1967); cells as in thesis 5.22.

use std::ops::Range;

use glam::DVec3;
use palpate_volume::simd_dispatch;
use palpate_volume::simd_dispatch::SimdLevel;

use super::cells::Cells;
use super::lanes::{LANES, Lanes, Plain, Wrap, squared_length};
use super::space::Space;
use super::state::Site;

/// The neighbours of all particles.
#[derive(Clone, Debug)]
pub struct NeighbourList {
    reach: f64,
    margin: f64,
    space: Space,
    cells: Cells,
    starts: Vec<u32>,
    members: Vec<u32>,
    built_at: Vec<DVec3>,
    builds: u64,
    rows: Vec<Range<usize>>,
    simd: SimdLevel,
}

impl NeighbourList {
    /// Lists of pairs nearer than `reach`, and by `margin` more.
    pub fn new(reach: f64, margin: f64, space: Space) -> Self {
        Self {
            reach,
            margin,
            space,
            cells: Cells::default(),
            starts: Vec::new(),
            members: Vec::new(),
            built_at: Vec::new(),
            builds: 0,
            rows: Vec::new(),
            simd: SimdLevel::widest(),
        }
    }

    /// Searches with no wider an instruction set; the lists are the same.
    pub fn with_simd(mut self, simd: SimdLevel) -> Self {
        self.simd = simd;
        self
    }

    /// Number of times that the lists were built.
    pub fn builds(&self) -> u64 {
        self.builds
    }

    /// Particles it was built for.
    pub fn particle_count(&self) -> usize {
        self.built_at.len()
    }

    /// The space of the particles.
    pub fn space(&self) -> Space {
        self.space
    }

    /// Members of all lists, fillers included.
    pub fn member_count(&self) -> usize {
        self.members.len()
    }

    /// Builds the lists again where their number or any place asks for it.
    pub fn update(&mut self, sites: &[Site]) {
        let allowed = (0.5 * self.margin).powi(2);
        // not `> allowed`: a place that is no number asks for it too
        let stays =
            |(site, &then): (&Site, &DVec3)| site.position().distance_squared(then) <= allowed;
        let same = sites.len() == self.built_at.len();
        if !(same && self.builds > 0 && sites.iter().zip(&self.built_at).all(stays)) {
            self.build(sites);
        }
    }

    /// Builds the lists now.
    pub fn build(&mut self, sites: &[Site]) {
        self.builds += 1;
        self.cells.sort(sites, self.reach + self.margin, self.space);
        self.built_at.clear();
        self.built_at.extend(sites.iter().map(Site::position));
        self.starts.clear();
        self.members.clear();
        search(self);
        self.starts.push(self.members.len() as u32);
    }

    /// All others within reach and margin of one particle when the lists were built.
    pub fn neighbours(&self, particle: usize) -> impl Iterator<Item = usize> {
        let all = self
            .of(particle)
            .iter()
            .flatten()
            .map(|&member| member as usize);
        all.filter(move |&member| member != particle)
    }

    /// The neighbours of one particle, eight by eight.
    #[inline(always)]
    pub(crate) fn of(&self, particle: usize) -> &[[u32; LANES]] {
        let range = self.starts[particle] as usize..self.starts[particle + 1] as usize;
        self.members[range].as_chunks().0
    }
}

simd_dispatch! {
    /// Fills the lists.
    fn search(list: &mut NeighbourList) = [
        avx512 => search_with::<super::lanes::Wide>,
        avx2 => search_with::<super::lanes::Halves>
    ] search_with::<Plain>, at list.simd
}

// loops and no closures: code in a closure would not be compiled for the wide registers
#[inline(always)]
fn search_with<V: Lanes>(list: &mut NeighbourList) {
    let NeighbourList {
        cells,
        starts,
        members,
        built_at,
        rows,
        ..
    } = list;
    let limit = V::splat((list.reach + list.margin).powi(2));
    let wrap = Wrap::<V>::new(list.space);
    let periodic = list.space != Space::Open;
    let ([x, y, z], order) = (&cells.sorted, &cells.order);

    for (index, position) in built_at.iter().enumerate() {
        starts.push(members.len() as u32);
        let here = [
            V::splat(position.x),
            V::splat(position.y),
            V::splat(position.z),
        ];
        cells.rows_around(cells.cell_at(*position), rows);
        for row in rows.iter() {
            let mut first = row.start;
            while first < row.end {
                let there = [
                    V::load(eight(x, first)),
                    V::load(eight(y, first)),
                    V::load(eight(z, first)),
                ];
                let mut offset = [
                    there[0].sub(here[0]),
                    there[1].sub(here[1]),
                    there[2].sub(here[2]),
                ];
                if periodic {
                    offset = wrap.nearest(offset);
                }
                let squared = squared_length(offset);
                let left = (row.end - first).min(LANES);
                let near = squared.less(limit) & (0xff >> (LANES - left));
                V::push_where(near, eight(order, first), members);
                first += LANES;
            }
        }
        while !members.len().is_multiple_of(LANES) {
            members.push(index as u32);
        }
    }
}

/// Eight values from a place on.
#[inline(always)]
fn eight<T>(values: &[T], first: usize) -> &[T; LANES] {
    values[first..]
        .first_chunk()
        .expect("sorted arrays have eight values more than there are")
}
