/**
 * What a ray of the picture shows first: the point where it becomes more opaque than clear,
 * enters a visible segment or an iso-surface, or goes through a surface; in a MIP where it has its
 * largest value. The same march as the shader's, for one
 * ray, on the CPU.
 */
import { transformPoint, transformVector } from "../geometry/affine";
import type { Ray } from "../geometry/camera";
import { keptSpan, type Plane } from "../view/clip";
import { biasedAt, gradientMagnitude } from "../scan/field";
import { edgeFactor, type Appearance } from "../appearance/appearance";
import { greyOf } from "../appearance/optics";
import { smallestSpacing, type ScanVolume } from "../scan/scan_volume";
import type { Crossing } from "./pick_patches";
import { rangeHolding } from "../segments/shown_segments";
import { physical } from "../scan/stored_values";
import { sample } from "../appearance/transfer_function";
import { addScaled, type Vec3 } from "../geometry/vector";

export interface Picked {
  /** In the scene [mm]. */
  readonly point: Vec3;
  /** Value of the scan there, in its unit. */
  readonly value: number;
  /** Visible segment whose surface this is; null for the scan itself. */
  readonly segment: number | null;
}

/** What else is drawn beside values and their ranges. */
export interface AlsoDrawn {
  /** Surfaces in the way of the ray, near to far. */
  readonly crossings: readonly Crossing[];
  /** Segment of a point of the grid that is no threshold, and whether its voxels are drawn; null for none. */
  readonly labelAt: (grid: Vec3) => { readonly id: number; readonly visible: boolean } | null;
  /** Planes that cut something away. */
  readonly clip: readonly Plane[];
  /** Whether nothing of the scan is drawn at a length along the ray [mm]. */
  readonly isLeftOut?: (t: number) => boolean;
}

export const nothingElse: AlsoDrawn = { crossings: [], labelAt: () => null, clip: [] };

/** The surface's own opacity: more opaque than clear. */
const surfaceOpacity = 0.5;

/** First visible point along a ray, or null where the ray sees through everything. */
export function pickSurface(
  volume: ScanVolume,
  appearance: Appearance,
  ray: Ray,
  also: AlsoDrawn = nothingElse,
): Picked | null {
  const { frame } = volume;
  const origin = transformPoint(frame.gridFromScene, ray.origin);
  const direction = transformVector(frame.gridFromScene, ray.direction);
  const picked = (t: number, segment: number | null): Picked => ({
    point: addScaled(ray.origin, ray.direction, t),
    value: physical(biasedAt(volume, addScaled(origin, direction, t)), frame.rescale),
    segment,
  });

  const step = 0.5 * smallestSpacing(frame) * volume.step;
  const kept = keptSpan(also.clip, ray);
  const inScan = throughBox(origin, direction, frame.dimensions) ?? [0, 0];
  const [enter, leave] = [Math.max(inScan[0], kept[0]), Math.min(inScan[1], kept[1])];
  const crossings = also.crossings.filter(({ t }) => kept[0] <= t && t <= kept[1]);
  const { optics } = appearance;
  if (optics.blend === "mip") {
    const t = largestOnRay(volume, appearance, also, { origin, direction, enter, leave, step });
    return t === null ? null : picked(t, null);
  }

  let clarity = 1;
  let passed = 0;
  /** The surface before `end` behind which nothing can be seen any more. */
  const surfaceBefore = (end: number): Picked | null => {
    for (let next = crossings[passed]; next !== undefined && next.t <= end; next = crossings[passed]) {
      passed += 1;
      clarity *= 1 - next.opacity;
      if (clarity <= 1 - surfaceOpacity) {
        return picked(next.t, next.id);
      }
    }
    return null;
  };

  for (let t = enter + step / 2; t < leave; t += step) {
    const surface = surfaceBefore(t);
    if (surface !== null) {
      return surface;
    }
    if (also.isLeftOut?.(t) === true) {
      continue;
    }
    const grid = addScaled(origin, direction, t);
    const biased = biasedAt(volume, grid);
    const segment = segmentAt(appearance, also, grid, biased);
    if (segment?.visible === false) {
      continue;
    }
    if (optics.blend === "iso" && segment === null) {
      clarity = physical(biased, frame.rescale) >= optics.isoValue ? 0 : clarity;
    } else {
      clarity *= segment === null ? Math.exp(-step * extinctionAt(volume, appearance, grid, biased)) : 0;
    }
    if (clarity <= 1 - surfaceOpacity) {
      return picked(t, segment?.id ?? null);
    }
  }
  return surfaceBefore(Infinity);
}

/** Where a ray of a MIP has its value, in the grid; null where nothing of it is seen. */
function largestOnRay(
  volume: ScanVolume,
  appearance: Appearance,
  also: AlsoDrawn,
  ray: {
    readonly origin: Vec3;
    readonly direction: Vec3;
    readonly enter: number;
    readonly leave: number;
    readonly step: number;
  },
): number | null {
  let most = 0;
  let place: number | null = null;
  for (let t = ray.enter + ray.step / 2; t < ray.leave; t += ray.step) {
    if (also.isLeftOut?.(t) === true) {
      continue;
    }
    const grid = addScaled(ray.origin, ray.direction, t);
    const biased = biasedAt(volume, grid);
    const share = greyOf(physical(biased, volume.frame.rescale), appearance.optics.window);
    if (share > most && segmentAt(appearance, also, grid, biased)?.visible !== false) {
      [most, place] = [share, t];
    }
  }
  return place;
}

/** The segment that a point belongs to, in the order of the shader: visible ranges, labels, hidden ones. */
function segmentAt(
  appearance: Appearance,
  also: AlsoDrawn,
  grid: Vec3,
  biased: number,
): ReturnType<AlsoDrawn["labelAt"]> {
  const range = rangeHolding(appearance.ranges, biased) ?? null;
  return range?.visible === true ? range : (also.labelAt(grid) ?? range);
}

function extinctionAt(volume: ScanVolume, appearance: Appearance, grid: Vec3, biased: number): number {
  const value = physical(biased, volume.frame.rescale);
  const { extinction } = sample(appearance.transferFunction.points, value);
  return extinction > 0
    ? extinction * edgeFactor(gradientMagnitude(volume, grid), appearance.edgeGradient, appearance.lighting.edges)
    : 0;
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
