//! A quadratic B-spline through the nodes of a window: value and gradient at any point.
//!
//! Of 27 nodes around a point each kernel takes one pass: rows of four along x side by side in
//! one register, summed over z, then over y, then along x.
//!
//! Frame: nodes of the window, numbered from 0. Memory: z, then y, then along x eight narrow
//! nodes, eight wide ones and four zeros, which are read with the last ones and have no weight.
//! Source: Unser, "Splines: a perfect fit for signal and image processing", IEEE Signal
//! Processing Magazine 16 (1999).

use super::binomial_filter::Blurred;
use super::field::Level;
use glam::{Mat4, Vec3A, Vec4};

/// Floats of one row.
const ROW: usize = 20;
/// Floats from the first of 27 nodes to the last, with one more.
const SPAN: usize = (2 * 8 + 2) * ROW + 4;

/// Which kernel a node belongs to: where those begin in a row.
#[derive(Clone, Copy, Debug)]
pub(super) enum Width {
    /// The narrow one.
    Fine = 0,
    /// The wide one.
    Wide = 8,
}

/// The nodes of a window.
#[derive(Clone, Debug)]
pub(super) struct Nodes([f32; 64 * ROW]);

impl Nodes {
    /// All zero.
    pub(super) const NONE: Self = Self([0.0; 64 * ROW]);

    /// Sets those of one kernel to blurred cells times a scale.
    #[inline(always)]
    pub(super) fn put(&mut self, cells: &Blurred, scale: f32, width: Width) {
        let (rows, _) = self.0.as_chunks_mut::<ROW>();
        for (row, cells) in rows.iter_mut().zip(cells) {
            // by way of a signed number, for which there is an instruction
            let node = |lane: usize| i32::from(cells[lane]) as f32 * scale;
            for pair in 0..4 {
                row[width as usize + 2 * pair] = node(pair);
                row[width as usize + 2 * pair + 1] = node(4 + pair);
            }
        }
    }

    /// Value and gradient of one kernel.
    #[inline]
    pub(super) fn level(&self, place: &Place, width: Width) -> Level {
        let first = place.first + width as usize;
        let Some(nodes) = self.0.get(first..).and_then(|nodes| nodes.first_chunk()) else {
            return Level::default();
        };
        let sums = place.sums(nodes);
        Level {
            value: sums.w,
            gradient: Vec3A::from_vec4(sums),
        }
    }

    /// The value alone.
    #[inline]
    pub(super) fn value(&self, place: &Place, width: Width) -> f32 {
        let first = place.first + width as usize;
        let nodes = self.0.get(first..).and_then(|nodes| nodes.first_chunk());
        nodes.map_or(0.0, |nodes| place.sum(nodes))
    }
}

/// Which nodes a point is between, and their weights.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Where the first of them stands.
    first: usize,
    /// Weights of the lower, the middle and the upper node along each axis.
    weights: [Vec3A; 3],
    /// Their change along that axis.
    slopes: [Vec3A; 3],
}

/// Adding it rounds a small number to a whole one, which its last bits then are.
const ROUNDING: f32 = (1 << 23) as f32;

impl Place {
    #[inline]
    pub(super) fn of(point: Vec3A) -> Self {
        // NaN becomes a node, too; nothing reads outside the window
        let point = point.max(Vec3A::splat(0.51)).min(Vec3A::splat(6.49));
        let rounded = point + ROUNDING;
        let middle = rounded.to_array().map(|node| (node.to_bits() & 7) as usize);
        let [x, y, z] = middle.map(|node| node.wrapping_sub(1) & 7);
        let off = point - (rounded - ROUNDING);
        let [low, high] = [0.5 - off, 0.5 + off];
        Self {
            first: (8 * z + y) * ROW + x,
            weights: [0.5 * low * low, 0.75 - off * off, 0.5 * high * high],
            slopes: [-low, -2.0 * off, high],
        }
    }

    /// The gradient, and in the last place the value.
    #[inline]
    fn sums(&self, nodes: &[f32; SPAN]) -> Vec4 {
        let [low, middle, high] = self.weights;
        let [low_slope, middle_slope, high_slope] = self.slopes;
        let four = |z: usize, y: usize| Vec4::from_slice(&nodes[(8 * z + y) * ROW..]);
        let column = |y: usize| {
            let [a, b, c] = [four(0, y), four(1, y), four(2, y)];
            [
                a * low.z + b * middle.z + c * high.z,
                a * low_slope.z + b * middle_slope.z + c * high_slope.z,
            ]
        };
        let [[a, a_by_z], [b, b_by_z], [c, c_by_z]] = [column(0), column(1), column(2)];
        let value = a * low.y + b * middle.y + c * high.y;
        let by_y = a * low_slope.y + b * middle_slope.y + c * high_slope.y;
        let by_z = a_by_z * low.y + b_by_z * middle.y + c_by_z * high.y;

        let along_x = Vec4::new(low.x, middle.x, high.x, 0.0);
        let slopes_x = Vec4::new(low_slope.x, middle_slope.x, high_slope.x, 0.0);
        let sums = Mat4::from_cols(
            value * slopes_x,
            by_y * along_x,
            by_z * along_x,
            value * along_x,
        )
        .transpose();
        sums.x_axis + sums.y_axis + sums.z_axis
    }

    /// The value alone.
    #[inline]
    fn sum(&self, nodes: &[f32; SPAN]) -> f32 {
        let [low, middle, high] = self.weights;
        let four = |z: usize, y: usize| Vec4::from_slice(&nodes[(8 * z + y) * ROW..]);
        let row = |z: usize| four(z, 0) * low.y + four(z, 1) * middle.y + four(z, 2) * high.y;
        let value = row(0) * low.z + row(1) * middle.z + row(2) * high.z;
        value.dot(Vec4::new(low.x, middle.x, high.x, 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nodes of a noise.
    fn nodes(random: &mut oorandom::Rand32) -> Nodes {
        let mut nodes = Nodes::NONE;
        for width in [Width::Fine, Width::Wide] {
            let cells = [[0; 8]; 64].map(|row| row.map(|_: i32| random.rand_u32() as u16));
            nodes.put(&cells, 1.0 / 65536.0, width);
        }
        nodes
    }

    #[test]
    fn the_gradient_is_the_change_of_the_value_and_has_no_step_between_nodes() {
        let mut random = oorandom::Rand32::new(3);
        let nodes = nodes(&mut random);
        for _ in 0..2000 {
            let point = [(); 3].map(|()| 0.6 + 5.7 * random.rand_float());
            // also where the three nodes become others
            let point = Vec3A::from_array(point.map(|x| if x < 2.0 { x.round() + 0.5 } else { x }));
            for width in [Width::Fine, Width::Wide] {
                let level = |at: Vec3A| nodes.level(&Place::of(at), width);
                let here = level(point);
                let alone = nodes.value(&Place::of(point), width);
                assert!(
                    (here.value - alone).abs() < 1e-6,
                    "{} or {alone}",
                    here.value
                );
                for axis in [Vec3A::X, Vec3A::Y, Vec3A::Z] {
                    let way = axis * 0.01;
                    let change = level(point + way).value - level(point - way).value;
                    let expected = here.gradient.dot(axis);
                    // a slope changes by less than 4 per node, single precision gives 1e-5
                    assert!(
                        (change / 0.02 - expected).abs() < 0.03,
                        "{change} at {point}"
                    );
                }
            }
        }
    }
}
