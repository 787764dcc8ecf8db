//! Noise of a scan: a value per voxel that depends on seed and voxel only, so that any
//! number of threads makes the same volume.
//!
//! Source: Steele, Lea & Flood, "Fast splittable pseudorandom number generators", OOPSLA
//! (2014): the mixing function of SplitMix64, used as a counter-based generator.

/// About normally distributed, mean 0, standard deviation 1, within ±3.46.
pub(super) fn noise(seed: u64, voxel: u64) -> f32 {
    // the sum of four uniform numbers 0..65535: mean 4 · 32767.5, variance 4 · 65536² / 12
    let bits = mix(seed.wrapping_mul(GOLDEN).wrapping_add(voxel));
    let sum = (bits & 0xffff) + (bits >> 16 & 0xffff) + (bits >> 32 & 0xffff) + (bits >> 48);
    (sum as f32 - 131_070.0) / 37_837.0
}

const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

fn mix(counter: u64) -> u64 {
    let mut bits = counter.wrapping_add(1).wrapping_mul(GOLDEN);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    const COUNT: u64 = 200_000;

    fn mean(values: impl Iterator<Item = f32>) -> f64 {
        values.map(f64::from).sum::<f64>() / COUNT as f64
    }

    /// Five standard errors: 5 / √200 000 = 0.011 for each mean, twice that for squares.
    #[test]
    fn it_has_mean_0_deviation_1_and_a_bound() {
        let values = || (0..COUNT).map(|voxel| noise(3, voxel));
        assert!(mean(values()).abs() < 0.011);
        assert!((mean(values().map(|value| value * value)) - 1.0).abs() < 0.022);
        assert!(values().all(|value| value.abs() < 3.47));
    }

    #[test]
    fn neighbours_and_seeds_have_nothing_in_common() {
        for step in [1, 2, 256, 65_536] {
            let product = mean((0..COUNT).map(|i| noise(3, i) * noise(3, i + step)));
            assert!(product.abs() < 0.011, "{step}: {product}");
        }
        for (one, other) in [(0, 1), (1, 2), (1, u64::MAX)] {
            let product = mean((0..COUNT).map(|i| noise(one, i) * noise(other, i)));
            assert!(product.abs() < 0.011, "seeds {one}, {other}: {product}");
        }
    }
}
