//! The thesis' empty-space border voxels around a voxel: empty, with a solid neighbour.
//!
//! Neighbours are the 26 that share a face, an edge or a corner. The voxel itself is no
//! candidate: the models would choose it for ever. Worked out on the bits of one window of
//! 8×8×8 voxels, as the slides of `exact` are. Frame: grid.
//! Source: R. Vlasov, thesis (2016), 4.3.

use glam::IVec3;
use palpate_volume::occupancy::Occupancy;

/// Voxels that one search reads.
pub(crate) const BORDER_VISITS: u32 = 8 * 8 * 8;

/// The voxel in the middle stands here in its window, along each axis.
const MIDDLE: i32 = 2;
/// Its bit in the word of its plane, and those of the 3×3 voxels around it.
const OWN: u64 = 1 << (MIDDLE * 8 + MIDDLE);
const AROUND: u64 = 0b1110 << 8 | 0b1110 << 16 | 0b1110 << 24;

/// The empty-space border voxels among the 26 neighbours of `voxel`.
pub(crate) fn border_voxels<O: Occupancy + ?Sized>(
    occupancy: &O,
    voxel: IVec3,
) -> impl Iterator<Item = IVec3> + use<O> {
    let min = voxel - MIDDLE;
    let solid = occupancy.block(min).0;
    (1..=3_usize).flat_map(move |z| {
        // solid, or beside a solid voxel; rows run over only at x = 0 and 7, beyond AROUND
        let planes = solid[z - 1] | solid[z] | solid[z + 1];
        let rows = planes | planes << 1 | planes >> 1;
        let near = rows | rows << 8 | rows >> 8;
        let own = if z as i32 == MIDDLE { OWN } else { 0 };
        set_bits(near & !solid[z] & AROUND & !own)
            .map(move |bit| min + IVec3::new(bit % 8, bit / 8, z as i32))
    })
}

/// The numbers of the bits that are set, lowest first.
fn set_bits(mut word: u64) -> impl Iterator<Item = i32> {
    std::iter::from_fn(move || {
        let bit = (word != 0).then(|| word.trailing_zeros() as i32);
        word &= word.wrapping_sub(1);
        bit
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Floor;
    impl Occupancy for Floor {
        fn is_solid(&self, voxel: IVec3) -> bool {
            voxel.z < 0
        }
    }

    #[test]
    fn above_a_floor_they_are_the_eight_around_and_none_higher_up() {
        let found: Vec<IVec3> = border_voxels(&Floor, IVec3::new(-3, 5, 0)).collect();
        assert_eq!(found.len(), 8);
        for voxel in found {
            let step = (voxel - IVec3::new(-3, 5, 0)).abs();
            assert!(step.z == 0 && step.max_element() == 1);
        }
        assert_eq!(border_voxels(&Floor, IVec3::new(0, 0, 1)).count(), 9);
        assert_eq!(border_voxels(&Floor, IVec3::new(0, 0, 2)).count(), 0);
        assert_eq!(border_voxels(&Floor, IVec3::new(0, 0, -3)).count(), 0);
    }
}
