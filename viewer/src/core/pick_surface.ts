/**
 * What a ray of the picture shows first: the point where it becomes more opaque than clear,
 * or enters a visible segment. The same march as the shader's, for one ray, on the CPU.
 */
import { transformPoint, transformVector } from "./affine";
import type { Ray } from "./camera";
import { biasedAt, gradientMagnitude } from "./field";
import { edgeFactor, type Look } from "./look";
import { smallestSpacing, type ScanVolume } from "./scan_volume";
import { rangeHolding } from "./shown_segments";
import { physical } from "./stored_values";
import { sample } from "./transfer_function";
import { addScaled, type Vec3 } from "./vector";

export interface Picked {
  /** In the scene [mm]. */
  readonly point: Vec3;
  /** Value of the scan there, in its unit. */
  readonly value: number;
  /** Visible segment whose surface this is; null for the scan itself. */
  readonly segment: number | null;
}

/** The surface's own opacity: more opaque than clear. */
const surfaceOpacity = 0.5;

/** First visible point along a ray, or null where the ray sees through everything. */
export function pickSurface(volume: ScanVolume, look: Look, ray: Ray): Picked | null {
  const { frame } = volume;
  const origin = transformPoint(frame.gridFromScene, ray.origin);
  const direction = transformVector(frame.gridFromScene, ray.direction);
  const span = throughBox(origin, direction, frame.dimensions);
  if (span === null) {
    return null;
  }

  const step = 0.5 * smallestSpacing(frame) * volume.step;
  let clarity = 1;
  for (let t = span[0] + step / 2; t < span[1]; t += step) {
    const grid = addScaled(origin, direction, t);
    const biased = biasedAt(volume, grid);
    const range = rangeHolding(look.ranges, biased);
    if (range?.visible === false) {
      continue;
    }
    clarity *= range === undefined ? Math.exp(-step * extinctionAt(volume, look, grid, biased)) : 0;
    if (clarity <= 1 - surfaceOpacity) {
      return {
        point: addScaled(ray.origin, ray.direction, t),
        value: physical(biased, frame.rescale),
        segment: range?.id ?? null,
      };
    }
  }
  return null;
}

function extinctionAt(volume: ScanVolume, look: Look, grid: Vec3, biased: number): number {
  const value = physical(biased, volume.frame.rescale);
  const { extinction } = sample(look.transferFunction.points, value);
  return extinction > 0 ? extinction * edgeFactor(gradientMagnitude(volume, grid), look.edgeGradient) : 0;
}

/** Where a ray is inside the box from 0 to `size`; null where it passes by. */
export function throughBox(origin: Vec3, direction: Vec3, size: Vec3): readonly [number, number] | null {
  let enter = 0;
  let leave = Infinity;
  for (const axis of [0, 1, 2] as const) {
    if (direction[axis] === 0) {
      if (origin[axis] < 0 || origin[axis] > size[axis]) {
        return null;
      }
      continue;
    }
    const a = -origin[axis] / direction[axis];
    const b = (size[axis] - origin[axis]) / direction[axis];
    enter = Math.max(enter, Math.min(a, b));
    leave = Math.min(leave, Math.max(a, b));
  }
  return enter < leave ? [enter, leave] : null;
}
