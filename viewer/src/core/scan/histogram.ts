/**
 * The histogram of a scan as a drawing: heights by the logarithm of the counts, since a
 * scan's air outnumbers everything else.
 */
import type { Histogram } from "../protocol";

/** SVG path of the histogram's outline, closed along the bottom, over [low, high] of values. */
export function histogramPath(
  { low, high, counts }: Histogram,
  shown: readonly [number, number],
  size: { readonly width: number; readonly height: number },
): string {
  const binWidth = (high - low) / Math.max(1, counts.length);
  const inside = counts.flatMap((count, i) => {
    const value = low + (i + 0.5) * binWidth;
    return value >= shown[0] && value <= shown[1] ? [{ value, tall: Math.log1p(count) }] : [];
  });
  const tallest = Math.max(...inside.map(({ tall }) => tall), 1e-9);
  const points = inside.map(({ value, tall }) => {
    const x = ((value - shown[0]) / (shown[1] - shown[0])) * size.width;
    const y = size.height * (1 - tall / tallest);
    return `${x.toFixed(1)},${y.toFixed(1)}`;
  });
  const bottom = size.height.toFixed(1);
  return points.length === 0 ? "" : `M0,${bottom}L${points.join("L")}L${size.width.toFixed(1)},${bottom}Z`;
}

/** Share of the scan's values from `from` to `to`, straight inside the bins. */
export function shareWithin({ low, high, counts }: Histogram, from: number, to: number): number {
  const binWidth = (high - low) / Math.max(1, counts.length);
  let total = 0;
  let within = 0;
  counts.forEach((count, i) => {
    const start = low + i * binWidth;
    const overlap = Math.min(to, start + binWidth) - Math.max(from, start);
    total += count;
    within += count * Math.min(1, Math.max(0, overlap / binWidth));
  });
  return total > 0 ? within / total : 0;
}

/** Value that all but a share of the scan's values stay below, to a bin. */
export function valueAbove({ low, high, counts }: Histogram, share: number): number {
  const total = counts.reduce((sum, count) => sum + count, 0);
  let above = 0;
  let bin = counts.length;
  while (bin > 0 && above + (counts[bin - 1] ?? 0) <= share * total) {
    bin -= 1;
    above += counts[bin] ?? 0;
  }
  return low + ((high - low) * bin) / Math.max(1, counts.length);
}
