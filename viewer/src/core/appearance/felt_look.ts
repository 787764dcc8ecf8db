/**
 * What is seen is what is felt: how the scan itself is drawn beside the segments that can be touched.
 *
 * As soon as a threshold that can be touched reaches into bone, other bright tissue is only hinted at: grey, and seen
 * through. It may also be left out, with all else that cannot be touched.
 */
import type { Scan, Segment } from "../protocol";
import type { InsideModes } from "../segments/shown_segments";
import type { Appearance } from "./appearance";
import { drawsSolids } from "./optics";
import { sample, type ControlPoint, type TransferFunction } from "./transfer_function";

/** What is chosen of what cannot be touched. */
export interface UnfeltChoice {
  /** Whether only what can be touched is shown. */
  readonly hidden: boolean;
}

type Anchored = Pick<Scan, "bone" | "modality" | "range" | "soft_tissue">;

/** What a hint of bright tissue keeps of its extinction. */
const hintShare = 0.06;

/** How far its colour is grey. */
const greyShare = 0.85;

/** Width of the step where hints begin, as a share of the span from soft tissue to bone. */
const stepShare = 0.02;

/** Segments as they are shown: without those that cannot be touched where these are not wanted. */
export function withoutUnfelt(segments: readonly Segment[], choice: UnfeltChoice): readonly Segment[] {
  return choice.hidden
    ? segments.map((segment) => (segment.felt ? segment : { ...segment, visible: false }))
    : segments;
}

/** How voxels of segments look inside the volume: where nothing of the scan is shown beside them, as bodies. */
export function insideBeside(modes: InsideModes, choice: UnfeltChoice): InsideModes {
  return choice.hidden ? {} : modes;
}

/** The look of the scan beside the segments that can be touched. */
export function lookBeside<Look extends Omit<Appearance, "ranges">>(
  look: Look,
  scan: Anchored,
  shown: { readonly segments: readonly Segment[]; readonly modes: InsideModes; readonly choice: UnfeltChoice },
): Look {
  const { optics, transferFunction } = look;
  const { choice, modes, segments } = shown;
  if (!drawsSolids(optics.blend)) {
    return look;
  }
  if (choice.hidden) {
    return {
      ...look,
      transferFunction: { points: transferFunction.points.map((point) => ({ ...point, extinction: 0 })) },
      // above all values
      optics: { ...optics, isoValue: scan.range[1] + 1 + Math.abs(scan.range[1]) },
    };
  }
  return feelsBone(segments, scan)
    ? { ...look, transferFunction: hinted(transferFunction, scan, drawnByFunction(segments, modes)) }
    : look;
}

/**
 * Whether a threshold that can be touched reaches into what is bone in a CT; of other kinds of scans nobody knows what
 * that is. Scans of unknown kind are taken for CT, as where bone is offered as their first segment.
 */
export function feelsBone(segments: readonly Segment[], { bone, modality }: Anchored): boolean {
  const isCt = modality === "CT" || modality === "";
  return isCt && segments.some((segment) => segment.felt && (thresholdOf(segment)?.[1] ?? -Infinity) >= bone);
}

/** The threshold that a segment comes from, whatever steps and edits did since; null where none made it. */
function thresholdOf({ made_by, range, steps }: Segment): readonly [number, number] | null {
  return range ?? made_by ?? steps?.range ?? null;
}

/** Ranges of what can be touched and is drawn by the transfer function: tissue in a colour, or as the scan. */
function drawnByFunction(segments: readonly Segment[], modes: InsideModes): (readonly [number, number])[] {
  return segments.flatMap((segment) => {
    const limits = thresholdOf(segment);
    return segment.felt && limits !== null && (modes[segment.id] ?? "solid") !== "solid" ? [limits] : [];
  });
}

/** A function that only hints at values of bone, except in some ranges. */
function hinted(
  { points }: TransferFunction,
  { bone, soft_tissue }: Anchored,
  except: readonly (readonly [number, number])[],
): TransferFunction {
  const step = Math.max(stepShare * Math.abs(bone - soft_tissue), 1e-6);
  const isHinted = (value: number): boolean =>
    value >= bone && !except.some(([low, high]) => low <= value && value <= high);
  const edges = [bone, ...except.flatMap(([low, high]) => [low, high + step])];
  // both sides of each edge, as far apart as a step
  const values = [...points.map(({ value }) => value), ...edges.flatMap((edge) => [edge - step, edge])];
  const sorted = [...new Set(values)].sort((one, other) => one - other);
  return {
    points: sorted.map((value) => {
      const point = { ...sample(points, value), value };
      return isHinted(value) ? hintOf(point) : point;
    }),
  };
}

function hintOf({ value, colour, extinction }: ControlPoint): ControlPoint {
  const [red, green, blue] = colour;
  const grey = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
  const greyed = (channel: number): number => channel + (grey - channel) * greyShare;
  return { value, colour: [greyed(red), greyed(green), greyed(blue)], extinction: hintShare * extinction };
}
