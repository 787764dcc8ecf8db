/**
 * Tools that change voxels with the probe: what a person can choose, and what follows from it.
 * Lengths [mm], volumes [mm³], times [s], power [mW].
 */
import { formatFixed } from "../base/format";
import type { Segment, ToolKind, ToolState } from "../protocol";
import type { Vec3 } from "../geometry/vector";

export type ToolName = Exclude<ToolKind, "none">;

export interface ToolChoice {
  readonly kind: ToolKind;
  readonly name: string;
  readonly key: string;
  /** What it does, in a few words. */
  readonly does: string;
}

export const toolChoices: readonly ToolChoice[] = [
  { kind: "none", name: "Feel", key: "h", does: "the probe changes nothing" },
  { kind: "eraser", name: "Eraser", key: "e", does: "takes voxels out of a segment" },
  { kind: "adder", name: "Adder", key: "a", does: "adds voxels to a segment" },
  { kind: "painter", name: "Paint", key: "w", does: "gives what you touch to a segment" },
  { kind: "drill", name: "Drill", key: "d", does: "removes tissue by the work of your hand" },
  { kind: "needle", name: "Needle", key: "i", does: "goes into tissue where you push" },
];

/** Colours of the tools' balls, sRGB. */
export const toolColours: Readonly<Record<ToolName, string>> = {
  eraser: "#ff7d74",
  adder: "#a9e06c",
  painter: "#ffc95c",
  drill: "#c9a2ff",
  needle: "#d8dee6",
};

/** What a tool works on: what is touched, all that can be touched, or one segment. */
export type Works = "touched" | "touchable" | number;

/** Radius of a tool at most, and of a burr [smallest voxel sides], as the engine has them. */
const mostInVoxels: Readonly<Record<ToolName, number>> = { eraser: 32, adder: 32, painter: 32, drill: 16, needle: 4 };
/** Larger ones are hard to see past. */
const largest: Readonly<Record<ToolName, number>> = { eraser: 25, adder: 25, painter: 25, drill: 10, needle: 2 };
const usual: Readonly<Record<ToolName, number>> = { eraser: 4, adder: 4, painter: 5, drill: 2, needle: 0.455 };

export interface RadiusRange {
  readonly min: number;
  readonly max: number;
}

/** Radii that are offered: from one that reaches a voxel's centre from everywhere. */
export function radiusRange(kind: ToolName, spacing: Vec3): RadiusRange {
  if (kind === "needle") {
    // as thick as needles are, whatever the voxels
    return { min: 0.1, max: largest.needle };
  }
  const max = Math.min(largest[kind], mostInVoxels[kind] * Math.min(...spacing));
  // half of a voxel's diagonal, to be seen on the slider
  const half = Math.ceil(5 * Math.hypot(...spacing)) / 10;
  return { min: Math.min(half, max), max };
}

/** The radius that a tool begins with, or the nearest to the one that was used last. */
export function fittingRadius(kind: ToolName, spacing: Vec3, wanted: number | null): number {
  const { min, max } = radiusRange(kind, spacing);
  return Math.min(max, Math.max(min, wanted ?? usual[kind]));
}

/** A painted layer is no deeper than this [smallest voxel sides], as the engine has it. */
const deepestInVoxels = 8;

/** Depths of a painted layer that are offered: from one that holds the voxels at the surface [mm]. */
export function depthRange(spacing: Vec3): RadiusRange {
  const max = deepestInVoxels * Math.min(...spacing);
  const half = Math.ceil(5 * Math.max(...spacing)) / 10;
  return { min: Math.min(half, max), max };
}

export function fittingDepth(spacing: Vec3, wanted: number): number {
  const { min, max } = depthRange(spacing);
  return Math.min(max, Math.max(min, wanted));
}

/**
 * The segments that a stroke works on; of a painter, those that it paints.
 *
 * @param touched the segment that is touched now, or was last; 0 before the first.
 */
export function segmentsOf(
  kind: ToolName,
  works: Works,
  segments: readonly Segment[],
  touched: number,
): readonly number[] {
  // the drill removes the scan's own voxels: a segment with a grid of its own has none of them
  const canWorkOn = (segment: Segment): boolean =>
    segment.felt && !segment.locked && (kind !== "drill" || segment.grid === null);
  const touchable = segments.filter(canWorkOn).map((segment) => segment.id);
  const has = (id: number): boolean => segments.some((segment) => segment.id === id);
  if (typeof works === "number" && has(works)) {
    return [works];
  }
  // voxels belong to no single segment: a burr cuts all that it meets, a painter paints it
  if (works === "touchable" || kind === "drill" || kind === "painter") {
    return touchable;
  }
  return has(touched) ? [touched] : touchable.slice(0, 1);
}

/** "840 mW", "6.0 W" */
export function formatLoad(load: number): string {
  return load < 1000 ? formatFixed(load, 0, "mW") : formatFixed(load / 1000, 1, "W");
}

/** The share of a load that a bar shows; full at what pressing firmly gives, 0..1. */
export function loadShare({ on, load }: Pick<ToolState, "on" | "load">): number {
  const firm = 6000;
  return on && Number.isFinite(load) ? Math.min(1, Math.max(0, load / firm)) : 0;
}
