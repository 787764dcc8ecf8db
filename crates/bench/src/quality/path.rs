//! Ways of the device: curves walked in steps of one length. Frame: scene [mm].

use glam::DVec3;

/// Pieces that a curve is cut into before it is walked.
const PIECES: usize = 20_000;

/// Points along a curve over 0..=1 from its start on, `step` apart as the crow flies but for
/// the curve's bend; at most `most` of them, fewer where the curve ends.
pub fn walk(curve: impl Fn(f64) -> DVec3, step: f64, most: usize) -> Vec<DVec3> {
    let mut from = curve(0.0);
    let mut points = vec![from];
    let mut since_last = 0.0;
    for piece in 1..=PIECES {
        let to = curve(piece as f64 / PIECES as f64);
        let length = from.distance(to);
        let mut next = step - since_last;
        while next <= length && points.len() < most {
            points.push(from.lerp(to, next / length));
            next += step;
        }
        since_last = length - (next - step);
        from = to;
    }
    points
}

/// A curve through some points, straight between them, at even speed.
pub fn through(points: Vec<DVec3>) -> impl Fn(f64) -> DVec3 {
    let lengths: Vec<f64> = points.windows(2).map(|p| p[0].distance(p[1])).collect();
    let total: f64 = lengths.iter().sum();
    move |share: f64| {
        let mut left = share * total;
        for (piece, &length) in points.windows(2).zip(&lengths) {
            if left <= length {
                return piece[0].lerp(piece[1], left / length);
            }
            left -= length;
        }
        points[points.len() - 1]
    }
}
