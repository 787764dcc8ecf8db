//! Forces of all pairs.
//!
//! Every particle sums the forces of its own neighbours, eight at a time and always in the
//! order of its list, so the result does not depend on the number of threads. A pair gives
//! both its particles the same force with opposite sign, to the last bit.

use glam::DVec3;
use palpate_volume::simd_dispatch;
use palpate_volume::simd_dispatch::SimdLevel;
use rayon::prelude::*;

use super::lanes::{Lanes, Plain, Wrap, squared_length};
use super::neighbours::NeighbourList;
use super::pair_laws::LaneLaw;
use super::space::Space;
use super::state::{Particles, Site};

/// Particles whose forces one task computes: the sums are taken per task, in order.
const TASK: usize = 256;

/// Who computes the forces. The result is the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Workers {
    /// The calling thread alone.
    #[default]
    One,
    /// All threads of the rayon pool.
    Pool,
}

/// How the forces are computed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PairOptions {
    /// D where it is the same for all pairs; none takes the harmonic mean of both particles' own.
    pub depth: Option<f64>,
    /// Whether sums are wanted too.
    pub sums: bool,
    /// Threads that compute.
    pub workers: Workers,
    /// The widest instruction set to compute in; the machine's own by default.
    pub simd: SimdLevel,
}

/// Sums over all pairs, each counted once.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PairSums {
    /// Σ Π.
    pub energy: f64,
    /// Σ f r.
    pub virial: f64,
    /// Pairs that act on one another.
    pub pairs: u64,
}

impl PairSums {
    fn plus(self, other: Self) -> Self {
        Self {
            energy: self.energy + other.energy,
            virial: self.virial + other.virial,
            pairs: self.pairs + other.pairs,
        }
    }
}

/// What all tasks read.
struct Pairs<'a, L> {
    law: &'a L,
    sites: &'a [Site],
    free: &'a [DVec3],
    list: &'a NeighbourList,
    /// D where all pairs have the same.
    depth: Option<f64>,
    /// Whether sums are wanted too.
    sums: bool,
}

/// Sets the force on each particle that is free along any axis to the sum of its pair forces;
/// on all others to zero. The sums are zero unless asked for, and complete only where all
/// particles are free.
///
/// # Panics
/// Where the lists were built for another number of particles.
pub fn pair_forces<L: LaneLaw>(
    law: &L,
    particles: &mut Particles,
    list: &NeighbourList,
    options: PairOptions,
) -> PairSums {
    let Particles {
        sites,
        forces,
        free,
        ..
    } = particles;
    assert_eq!(
        sites.len(),
        list.particle_count(),
        "lists of other particles"
    );
    let pairs = Pairs {
        law,
        sites,
        free,
        list,
        depth: options.depth,
        sums: options.sums,
    };
    let task = |(number, forces): (usize, &mut [DVec3])| {
        accumulate(&pairs, number * TASK, forces, options.simd)
    };
    match options.workers {
        Workers::One => {
            let tasks = forces.chunks_mut(TASK).enumerate();
            tasks.map(task).fold(PairSums::default(), PairSums::plus)
        }
        Workers::Pool => {
            let tasks = forces.par_chunks_mut(TASK).enumerate();
            let each: Vec<_> = tasks.map(task).collect();
            each.into_iter().fold(PairSums::default(), PairSums::plus)
        }
    }
}

simd_dispatch! {
    /// Forces of the particles from `first` on.
    fn accumulate[L: LaneLaw](
        pairs: &Pairs<'_, L>,
        first: usize,
        forces: &mut [DVec3],
        simd: SimdLevel,
    ) -> PairSums = [
        avx512 => accumulate_with::<super::lanes::Wide, L>,
        avx2 => accumulate_with::<super::lanes::Halves, L>
    ] accumulate_with::<Plain, L>, at simd
}

#[inline(always)]
fn accumulate_with<V: Lanes, L: LaneLaw>(
    pairs: &Pairs<'_, L>,
    first: usize,
    forces: &mut [DVec3],
    _: SimdLevel,
) -> PairSums {
    if pairs.sums {
        pairs.choose::<V, true>(first, forces)
    } else {
        pairs.choose::<V, false>(first, forces)
    }
}

impl<L: LaneLaw> Pairs<'_, L> {
    /// A loop without what this space and these materials do not need.
    #[inline(always)]
    fn choose<V: Lanes, const SUMS: bool>(&self, first: usize, forces: &mut [DVec3]) -> PairSums {
        let periodic = self.list.space() != Space::Open;
        match (periodic, self.depth.is_none()) {
            (false, false) => self.sum::<V, SUMS, false, false>(first, forces),
            (false, true) => self.sum::<V, SUMS, false, true>(first, forces),
            (true, false) => self.sum::<V, SUMS, true, false>(first, forces),
            (true, true) => self.sum::<V, SUMS, true, true>(first, forces),
        }
    }

    #[inline(always)]
    fn sum<V: Lanes, const SUMS: bool, const PERIODIC: bool, const MIXED: bool>(
        &self,
        first: usize,
        forces: &mut [DVec3],
    ) -> PairSums {
        let wrap = Wrap::new(self.list.space());
        let (cut, zero) = (V::splat(self.law.cut_squared()), V::splat(0.0));
        let depth = V::splat(self.depth.unwrap_or(1.0));
        let (mut energy, mut virial, mut pairs) = (zero, zero, 0);

        for (index, force) in (first..).zip(forces) {
            if self.free[index] == DVec3::ZERO {
                *force = DVec3::ZERO;
                continue;
            }
            let site = &self.sites[index];
            let here = [V::splat(site.x), V::splat(site.y), V::splat(site.z)];
            let mut total = [zero; 3];
            for eight in self.list.of(index) {
                // SAFETY: members of lists are particles of the lists, as many as there are sites
                let there = unsafe { V::gather(self.sites, eight) };
                let mut offset = [
                    here[0].sub(there[0]),
                    here[1].sub(there[1]),
                    here[2].sub(there[2]),
                ];
                if PERIODIC {
                    offset = wrap.nearest(offset);
                }
                let squared = squared_length(offset);
                let measure = self.law.measure(offset, squared);
                // a particle and itself, and two at one place, have no direction
                let acting = measure.less(cut) & zero.less(squared);
                let (mut pull, mut well) = self.law.evaluate(measure, squared);
                let scale = if MIXED {
                    V::splat(2.0).div(V::splat(site.softness).add(there[3]))
                } else {
                    depth
                };
                pull = pull.mul(scale).keep(acting);
                total[0] = pull.mul_add(offset[0], total[0]);
                total[1] = pull.mul_add(offset[1], total[1]);
                total[2] = pull.mul_add(offset[2], total[2]);
                if SUMS {
                    well = well.mul(scale).keep(acting);
                    energy = energy.add(well);
                    virial = pull.mul_add(squared, virial);
                    pairs += u64::from(acting.count_ones());
                }
            }
            *force = DVec3::new(total[0].sum(), total[1].sum(), total[2].sum());
        }
        // every pair was met from both sides
        PairSums {
            energy: 0.5 * energy.sum(),
            virial: 0.5 * virial.sum(),
            pairs: pairs / 2,
        }
    }
}
