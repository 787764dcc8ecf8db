/**
 * Slices as a pile of voxels: which one is seen, how many there are, where it lies, and how to go from one to the next.
 *
 * Numbers count from 1 along the grid's axis, as the scan's file has its voxels. Points are in the scene [mm].
 */
import { formatFixed } from "../base/format";
import { transformPoint } from "../geometry/affine";
import { addScaled, dot, type Vec3 } from "../geometry/vector";
import type { ScanFrame } from "../scan/scan_volume";
import { sliceStep, type SliceAxes } from "./slice_plane";

/** Slices whose normal lies along an axis of the grid. */
interface Stack {
  /** Axis of the grid: 0, 1 or 2. */
  readonly axis: number;
  /** 1 where numbers grow toward the person. */
  readonly sign: 1 | -1;
  readonly count: number;
}

/** A slice by its number. */
export interface SliceNumber {
  readonly number: number;
  readonly count: number;
}

/** Cosine from which on a normal lies along an axis. */
const along = 1 - 1e-6;

/** The pile that a slice is one of; null where it lies obliquely to the voxels. */
function stackOf({ toward }: SliceAxes, { axes, dimensions }: ScanFrame): Stack | null {
  const axis = axes.findIndex((each) => Math.abs(dot(each, toward)) > along);
  const normal = axes[axis];
  return normal === undefined
    ? null
    : { axis, sign: dot(normal, toward) > 0 ? 1 : -1, count: Math.max(1, Math.round(dimensions[axis] ?? 1)) };
}

function indexOf(point: Vec3, { axis, count }: Stack, frame: ScanFrame): number {
  const place = transformPoint(frame.gridFromScene, point)[axis] ?? 0;
  return Math.min(count - 1, Math.max(0, Math.floor(place)));
}

/** Which slice goes through a point; null where slices are not numbered. */
export function sliceNumber(point: Vec3, axes: SliceAxes, frame: ScanFrame): SliceNumber | null {
  const stack = stackOf(axes, frame);
  return stack && { number: indexOf(point, stack, frame) + 1, count: stack.count };
}

/** How many slices lie behind the one through a point, away from the person, of all but one. */
export function slicesBehind(point: Vec3, axes: SliceAxes, frame: ScanFrame): SliceNumber | null {
  const stack = stackOf(axes, frame);
  if (stack === null) {
    return null;
  }
  const index = indexOf(point, stack, frame);
  return { number: stack.sign > 0 ? index : stack.count - 1 - index, count: stack.count - 1 };
}

/**
 * The point that lies so many slices toward the person: in the middle of a voxel's thickness, so that what is seen are
 * the values of the scan; within the scan.
 */
export function stepSlices(point: Vec3, axes: SliceAxes, frame: ScanFrame, slices: number): Vec3 {
  const stack = stackOf(axes, frame);
  if (stack === null) {
    return addScaled(point, axes.toward, slices * sliceStep(axes, frame));
  }
  const index = indexOf(point, stack, frame) + stack.sign * slices;
  const grid = [...transformPoint(frame.gridFromScene, point)] as [number, number, number];
  grid[stack.axis] = Math.min(stack.count - 1, Math.max(0, index)) + 0.5;
  return transformPoint(frame.sceneFromGrid, grid);
}

/**
 * Where a plane lies along its normal, by the direction of the body that is nearest to it: "S 806.0 mm"; along the
 * scan's axes where those directions are not known: "z 806.0 mm".
 */
export function slicePosition(centre: Vec3, { toward }: SliceAxes, known: boolean): string {
  const sizes = toward.map(Math.abs);
  const axis = sizes.indexOf(Math.max(...sizes));
  const place = dot(centre, toward) * Math.sign(toward[axis] ?? 1);
  if (!known) {
    return `${"xyz"[axis] ?? ""} ${formatFixed(place, 1, "mm")}`;
  }
  // of the letters, those of growing coordinates are L, P and S
  const letter = (place < 0 ? "RAI" : "LPS")[axis] ?? "";
  return `${letter} ${formatFixed(Math.abs(place), 1, "mm")}`;
}
