/**
 * A transfer function as a small strip: its colours, as clear as they are where tissue is clear.
 */
import type { Curve } from "../../core/appearance/curve";

/** CSS background over the values that have points. */
export function swatchOf({ opacities, colours }: Curve): string {
  const values = opacities.map(({ value }) => value);
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const stops = colours.map(({ value, colour }) => {
    const place = (100 * (value - low)) / Math.max(high - low, 1e-9);
    const share = opacityAt(opacities, value);
    // hardly opaque tissue is seen through its depth
    const alpha = Math.round(255 * Math.min(1, 0.15 + Math.sqrt(share)));
    return `${colour}${alpha.toString(16).padStart(2, "0")} ${place.toFixed(1)}%`;
  });
  return `linear-gradient(to right, ${stops.join(", ")})`;
}

function opacityAt(points: Curve["opacities"], value: number): number {
  const next = points.findIndex((point) => point.value >= value);
  const [a, b] = [
    points[next === -1 ? points.length - 1 : Math.max(0, next - 1)],
    points[next === -1 ? points.length - 1 : next],
  ];
  if (a === undefined || b === undefined || a.value === b.value) {
    return b?.opacity ?? 0;
  }
  return a.opacity + ((b.opacity - a.opacity) * (value - a.value)) / (b.value - a.value);
}
