//! What does not come back: bonds that break, rest lengths that yield, forces that fade.
//!
//! All of it happens between relaxations, on nodes at rest.
//! - A bond breaks where a crack through it would set the fracture energy free. Its nodes can meet
//!   again; its cells lose their volume term where it runs through them, and not only along them. The
//!   energy that was in both is counted as work.
//! - A bond yields where its elastic strain exceeds the yield strain: its rest length follows.
//!   In a box that moves that is only where a tool presses, and not near the border: what pulls
//!   there without a tool is that what yielded beyond the border is missing.
//! - Prony: of the force of a bond put under strain at once, a share fades with time. With the
//!   instant stiffness k / (1 - share), a creep c that follows the elongation with the time
//!   constant, and the rest length moved by share · c, the bond is as stiff as asked in the end.
//!
//! Source: thesis errata, sections 6 and 7 (strength and stiffness need parameters of their own).

use glam::{DVec3, IVec3};

use super::bond_forces::{bond_length, rest_length};
use super::layout::{FAMILIES, FAMILY_COUNT, Layout};
use super::nodes::{Lattice, NodeMaterial};
use super::shift::shift;
use super::volume_forces::cell_energies;
use crate::material::pair_stiffness;

/// Rest lengths of bonds that yielded, at least and at most, as shares of that at first: 18 bonds that
/// follow each on its own do not keep the volume, and tissue that is ploughed would swell.
const YIELDED: [f64; 2] = [0.6, 1.15];
/// Way of a rest length from which on nodes are relaxed again [spacings].
const FOLLOWED: f64 = 2e-3;

/// A force that fades with time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prony {
    /// Share of the instant force that fades, 0 up to but without 1.
    pub share: f64,
    /// Time constant [s].
    pub time: f64,
}

/// Inelastic behaviour of the lattice; by default it only breaks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InelasticSettings {
    /// Strain from which on rest lengths follow; none for elastic return.
    pub yield_strain: Option<f64>,
    /// Viscoelastic part.
    pub prony: Option<Prony>,
}

/// The memory of bonds beyond their stiffness. Shape of each array [nodes].
#[derive(Clone, Debug)]
pub struct Inelastic {
    settings: InelasticSettings,
    /// Rest length without creep [mm].
    pub(super) base: [Vec<f64>; FAMILY_COUNT],
    /// Elongation that the fading part has followed [mm].
    creep: [Vec<f64>; FAMILY_COUNT],
    pub(super) broken: [Vec<bool>; FAMILY_COUNT],
}

/// What broke in one look at all bonds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Breaking {
    /// Bonds.
    pub count: u32,
    /// The energy that was in them and in the cells that they held together [N·mm].
    pub work: f64,
    /// The middle of them [mm]; zero where none broke.
    pub place: DVec3,
    /// Largest change of a bond's rest length by yielding [mm].
    pub yielded: f64,
}

impl Breaking {
    /// Whether nodes are not at rest any more.
    #[must_use]
    pub fn is_felt(&self, spacing: f64) -> bool {
        self.count > 0 || self.yielded > FOLLOWED * spacing
    }
}

impl Inelastic {
    /// For a lattice whose bonds are as they were made. A share that fades makes them stiffer at
    /// first.
    ///
    /// # Panics
    /// Where the share is not within 0..1 or a time or strain is not above 0.
    #[must_use]
    pub fn new(lattice: &mut Lattice, settings: InelasticSettings) -> Self {
        if let Some(prony) = settings.prony {
            assert!(
                (0.0..1.0).contains(&prony.share) && prony.time > 0.0,
                "{prony:?}"
            );
            lattice.instant = 1.0 / (1.0 - prony.share);
            for stiffness in lattice.bonds.stiffness.iter_mut().flatten() {
                *stiffness *= lattice.instant;
            }
            lattice.settle_structure();
        }
        assert!(
            settings.yield_strain.is_none_or(|strain| strain > 0.0),
            "{settings:?}"
        );
        Self {
            settings,
            base: lattice.bonds.rest.clone(),
            creep: lattice
                .bonds
                .rest
                .each_ref()
                .map(|rest| vec![0.0; rest.len()]),
            broken: lattice
                .bonds
                .rest
                .each_ref()
                .map(|rest| vec![false; rest.len()]),
        }
    }

    /// Whether any bond rests at another length than at first.
    pub(super) fn has_yielded(&self, lattice: &Lattice) -> bool {
        self.settings.yield_strain.is_some()
            && (0..FAMILY_COUNT).any(|family| {
                let at_first = rest_length(family, lattice.spacing);
                self.base[family].iter().any(|base| *base != at_first)
            })
    }

    /// Breaks what is too long, if it may, and lets the rest yield at nodes that may; the lattice is
    /// at rest, and must be relaxed again where that is felt.
    pub fn break_and_yield(
        &mut self,
        lattice: &mut Lattice,
        may_break: bool,
        may_yield: impl Fn(usize) -> bool,
    ) -> Breaking {
        let mut breaking = Breaking::default();
        let mut torn = Vec::new();
        // far from rest, tissue that cannot yield has nothing to be looked for
        if !may_break && self.settings.yield_strain.is_none() {
            return breaking;
        }
        let strained = may_break.then(|| Strained::of(lattice));
        for family in 0..FAMILY_COUNT {
            for index in 0..lattice.bonds.stiffness[family].len() {
                if lattice.bonds.stiffness[family][index] > 0.0 {
                    let bond = [family, index];
                    if strained
                        .as_ref()
                        .is_some_and(|strained| strained.tears(lattice, bond))
                    {
                        torn.push(bond);
                    } else if may_yield(index) {
                        let way = self.follow(lattice, bond);
                        breaking.yielded = breaking.yielded.max(way);
                    }
                }
            }
        }
        self.tear(lattice, &torn, &mut breaking);
        breaking
    }

    /// Takes bonds away.
    fn tear(&mut self, lattice: &mut Lattice, torn: &[[usize; 2]], all: &mut Breaking) {
        if torn.is_empty() {
            return;
        }
        let before = lattice.energy();
        for &[family, index] in torn {
            let far = index + lattice.layout.offset(family);
            all.place += 0.5 * (lattice.place(index) + lattice.place(far)) / torn.len() as f64;
            self.broken[family][index] = true;
            lattice.bonds.stiffness[family][index] = 0.0;
            open_cells(lattice, [family, index]);
        }
        lattice.settle_structure();
        all.count = torn.len() as u32;
        all.work = before - lattice.energy();
    }

    /// Has the rest length of a bond that yields follow; gives its way [mm].
    fn follow(&mut self, lattice: &mut Lattice, [family, index]: [usize; 2]) -> f64 {
        let Some(strain) = self.settings.yield_strain else {
            return 0.0;
        };
        let length = bond_length(
            &lattice.layout,
            lattice.spacing,
            &lattice.moved,
            family,
            index,
        );
        let at_first = rest_length(family, lattice.spacing);
        let base = &mut self.base[family][index];
        let most = strain * at_first;
        let [shortest, longest] = YIELDED.map(|share| share * at_first);
        let followed = base
            .clamp(length - most, length + most)
            .clamp(shortest, longest);
        let way = followed - *base;
        lattice.bonds.rest[family][index] += way;
        *base = followed;
        way.abs()
    }

    /// How it works.
    pub(super) fn settings(&self) -> InelasticSettings {
        self.settings
    }

    /// Has the bonds of a node rest as long, and have faded as much, as those of a node in another box.
    pub(super) fn fade_as(
        &mut self,
        lattice: &mut Lattice,
        to: usize,
        (other, theirs, from): (&Self, &Lattice, usize),
    ) {
        for family in 0..FAMILY_COUNT {
            self.creep[family][to] = other.creep[family][from];
            lattice.bonds.rest[family][to] = theirs.bonds.rest[family][from];
        }
    }

    /// Goes with a lattice that has gone `offset` nodes on.
    pub(super) fn go(&mut self, lattice: &Lattice, offset: IVec3) {
        let layout = lattice.layout();
        for family in 0..FAMILY_COUNT {
            let at_first = rest_length(family, lattice.spacing);
            shift(layout, &mut self.base[family], offset, at_first);
            shift(layout, &mut self.creep[family], offset, 0.0);
            shift(layout, &mut self.broken[family], offset, false);
        }
    }

    /// Breaks what broke before in a lattice whose bonds were made anew.
    pub(super) fn break_again(&self, lattice: &mut Lattice) {
        for family in 0..FAMILY_COUNT {
            for index in 0..self.broken[family].len() {
                if self.broken[family][index] {
                    lattice.bonds.stiffness[family][index] = 0.0;
                    open_cells(lattice, [family, index]);
                }
            }
        }
        lattice.settle_structure();
    }

    /// Lets the fading part of the force fade for a time [s]; a time that is none passes over.
    pub fn fade(&mut self, lattice: &mut Lattice, dt: f64) {
        let Some(prony) = self.settings.prony else {
            return;
        };
        if !(dt > 0.0 && dt.is_finite()) {
            return;
        }
        let followed = 1.0 - (-dt / prony.time).exp();
        for family in 0..FAMILY_COUNT {
            for index in 0..lattice.bonds.stiffness[family].len() {
                if lattice.bonds.stiffness[family][index] > 0.0 {
                    let length = bond_length(
                        &lattice.layout,
                        lattice.spacing,
                        &lattice.moved,
                        family,
                        index,
                    );
                    let base = self.base[family][index];
                    let creep = &mut self.creep[family][index];
                    *creep += (length - base - *creep) * followed;
                    lattice.bonds.rest[family][index] = base + prony.share * *creep;
                }
            }
        }
    }
}

/// What tissue holds of energy as it stands, beside what is in its bonds as springs.
struct Strained {
    /// The exponent of each node that stiffens.
    exponents: Option<Vec<f64>>,
    /// Energy of each cell's pressure, below 0 where it is pressed together [N·mm].
    cells: Vec<f64>,
    /// Most of a cell, for the area of its face [N·mm/mm²].
    most_pressure: f64,
}

impl Strained {
    fn of(lattice: &Lattice) -> Self {
        let exponents = lattice.stiffening.as_ref().map(|s| s.exponents(lattice));
        let Lattice {
            layout,
            spacing,
            cells,
            moved,
            ..
        } = lattice;
        let cells = cell_energies(layout, *spacing, cells, moved);
        let most_pressure = cells.iter().copied().fold(0.0, f64::max) / spacing.powi(2);
        Self {
            exponents,
            cells,
            most_pressure,
        }
    }

    /// Whether a bond is so long that it breaks, so that a crack along a plane of nodes takes the fracture
    /// energy G of the softer side whatever the spacing h: of each h² one bond of length h and four of
    /// √2 h break at a strain ε, which hold (1 + 4 · 2) k (ε h)² / 2, so that G = 4.5 k ε² with the
    /// stiffness k of the bonds. Where tissue stiffens with strain, that is as many times more as such a
    /// plane sets more energy free than its springs hold, by the exponents of its nodes. The pressure of
    /// one cell comes on top, where it holds its nodes together. What is rigid does not tear.
    ///
    /// Source: Silling & Askari, Comput. Struct. 83 (2005), eq. 30, for bonds of a lattice.
    fn tears(&self, lattice: &Lattice, bond: [usize; 2]) -> bool {
        let Lattice {
            layout,
            spacing,
            moved,
            matter,
            node_stiffness,
            ..
        } = lattice;
        let [family, index] = bond;
        let strain = bond_length(layout, *spacing, moved, family, index)
            / rest_length(family, *spacing)
            - 1.0;
        if strain <= 0.0 {
            return false;
        }
        let ends = [index, index + layout.offset(family)];
        let [stiffness, other] = ends.map(|end| node_stiffness[end]);
        let of_springs = 4.5 * pair_stiffness(stiffness, other) * strain * strain;
        let stiffened = self.exponents.as_ref().zip(lattice.stiffening.as_ref());
        let of_bonds = stiffened.map_or(of_springs, |(exponents, stiffening)| {
            of_springs * stiffening.set_free(exponents, bond, layout.offset(family), strain)
        });
        let tears = |taken: f64| {
            ends.into_iter().any(|end| match &matter[end] {
                NodeMaterial::Deformable(solid) => taken > solid.fracture_energy,
                NodeMaterial::Empty | NodeMaterial::Rigid(_) => false,
            })
        };
        // most bonds are far from it, and need no look at their cells
        tears(of_bonds + self.most_pressure) && tears(of_bonds + self.pressure(lattice, bond))
    }

    /// Energy of the pressure that pulls at a bond, for the area of a cell's face [N·mm/mm²].
    fn pressure(&self, lattice: &Lattice, bond: [usize; 2]) -> f64 {
        let around = cells_of(&lattice.layout, bond);
        let (sum, count) = around
            .filter(|cell| lattice.cells.modulus[*cell] > 0.0)
            .fold((0.0, 0), |(sum, count), cell| {
                (sum + self.cells[cell], count + 1)
            });
        f64::max(sum, 0.0) / f64::from(count.max(1)) / lattice.spacing.powi(2)
    }
}

/// Takes the volume term from the cells that a bond runs through. What runs along them holds a ninth
/// of a crack's energy: without it, cells hold their nodes still.
fn open_cells(lattice: &mut Lattice, bond: [usize; 2]) {
    let is_diagonal = FAMILIES[bond[0]].iter().filter(|step| **step != 0).count() > 1;
    if is_diagonal {
        for cell in cells_of(&lattice.layout, bond) {
            lattice.cells.modulus[cell] = 0.0;
        }
    }
}

/// The cells that a bond runs through or along.
fn cells_of(layout: &Layout, [family, index]: [usize; 2]) -> impl Iterator<Item = usize> + use<'_> {
    let step = IVec3::from_array(FAMILIES[family]);
    let first = layout.node_at(index).map(|node| node.as_ivec3());
    // a cell holds the bond where it lies within one step of its lowest node
    first.into_iter().flat_map(move |first| {
        let (low, high) = (first.min(first + step), first.max(first + step));
        (0..8).filter_map(move |corner| {
            let cell = high - IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
            let holds = cell.cmple(low).all() && (high - cell).max_element() <= 1;
            layout.index_of(cell).filter(|_| holds)
        })
    })
}
