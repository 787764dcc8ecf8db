/**
 * The brush in slices: how large it may be, and what it paints. Lengths [mm].
 */
import type { Scan, Segment } from "../protocol";
import type { Vec3 } from "../geometry/vector";

/** How a slice is painted: by a stroke of a brush, or by an outline whose inside is painted. */
export type PaintWay = "brush" | "wire" | "level";

/** What is remembered of a brush. */
export interface BrushHabits {
  readonly erases: boolean;
  readonly way: PaintWay;
  readonly radius: number;
  /** A ball instead of a disc in the slice. */
  readonly ball: boolean;
  /** Only voxels whose values are from `low` to `high` are changed. */
  readonly within: boolean;
  readonly low: number;
  readonly high: number;
}

/** Larger ones are hard to see past. */
const largest = 30;
/** By how much a step of the wheel or a key changes the radius. */
const ratio = 1.15;

/** Radii that are offered: from one that covers a voxel wherever it is put. */
export function brushRange(spacing: Vec3): { readonly min: number; readonly max: number } {
  return { min: Math.min(largest, Math.ceil(5 * Math.max(...spacing)) / 10), max: largest };
}

/** A radius within what is offered, to a tenth. */
export function fittingBrush(radius: number, spacing: Vec3): number {
  const { min, max } = brushRange(spacing);
  return Math.min(max, Math.max(min, Math.round(10 * radius) / 10));
}

/** The radius some steps larger, or smaller where they are below 0; another one in any case if there is one. */
export function resizedBrush(radius: number, steps: number, spacing: Vec3): number {
  const wanted = radius * ratio ** steps;
  const least = radius + 0.1 * Math.sign(steps);
  return fittingBrush(steps > 0 ? Math.max(wanted, least) : Math.min(wanted, least), spacing);
}

/** The values that a brush begins with: from soft tissue to bone. */
export function firstValues({
  soft_tissue,
  bone,
}: Pick<Scan, "soft_tissue" | "bone">): Pick<BrushHabits, "low" | "high"> {
  return { low: Math.round(soft_tissue), high: Math.round(bone) };
}

/** Whether slices of a segment can be painted. */
export function canBePainted(segment: Pick<Segment, "grid" | "pose" | "locked">): boolean {
  return !segment.locked && standsOnScan(segment);
}

/** Whether a segment stands on the scan's voxels. */
export function standsOnScan({ grid, pose }: Pick<Segment, "grid" | "pose">): boolean {
  return grid === null && (pose === null || pose.every((c, i) => c === (i % 5 === 0 ? 1 : 0)));
}

/** The name of a new segment: the first "Painted n" that is free. */
export function paintedName(names: readonly string[]): string {
  for (let number = 1; ; number += 1) {
    const name = `Painted ${String(number)}`;
    if (!names.includes(name)) return name;
  }
}
