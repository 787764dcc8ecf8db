/**
 * Segments as the picture shows them.
 *
 * A segment made by a threshold is the set of points whose interpolated value lies in its
 * range: a visible one is a solid surface in its colour, a hidden one is left out of the
 * picture. Where both claim a value, the visible one wins.
 */
import { linearFromSrgb } from "./colour";
import type { Segment } from "./protocol";
import { biasedRange, type Rescale } from "./stored_values";
import type { Vec3 } from "./vector";

export interface ShownRange {
  readonly id: number;
  /** Biased values, both ends included. */
  readonly low: number;
  readonly high: number;
  /** Linear RGB. */
  readonly colour: Vec3;
  readonly visible: boolean;
}

/** Whether a segment's voxels are coloured in the picture; where its surface stands for them they are left out. */
export function drawnFromVoxels({ visible, shown_as }: Segment): boolean {
  return visible && shown_as !== "surface";
}

/** Whether a segment's surface is drawn. */
export function drawnAsSurface({ visible, shown_as, opacity }: Segment): boolean {
  return visible && shown_as !== "volume" && opacity > 0;
}

/**
 * A segment as it can be shown now: from its voxels as long as there is no surface of it,
 * and while its range is dragged (`preview`, of the scan's values).
 */
export function showable(segment: Segment, hasSurface: boolean, preview: readonly [number, number] | null): Segment {
  if (preview !== null) {
    return { ...segment, range: preview, shown_as: "volume" };
  }
  return hasSurface ? segment : { ...segment, shown_as: "volume" };
}

/** The ranges that segments had last: an edited one is shown by its own until its labels are here. */
export class LastRanges {
  private readonly ranges = new Map<number, Segment["range"]>();

  /** Takes a segment as it is; returns it with its last range where it has none and awaits its labels. */
  stand(segment: Segment, awaitsLabels: boolean): Segment {
    if (segment.range !== null) {
      this.ranges.set(segment.id, segment.range);
    }
    const range = awaitsLabels ? (this.ranges.get(segment.id) ?? null) : segment.range;
    return segment.range === null && range !== null ? { ...segment, range } : segment;
  }
}

/** The segments that are just a threshold, in the order of the list. */
export function shownRanges(segments: readonly Segment[], rescale: Rescale): ShownRange[] {
  return segments.flatMap((segment) => {
    if (segment.range === null) {
      return [];
    }
    const [low, high] = biasedRange(segment.range[0], segment.range[1], rescale);
    return [{ id: segment.id, low, high, colour: linearFromSrgb(segment.colour), visible: drawnFromVoxels(segment) }];
  });
}

/** The segment that a value belongs to: a visible one if any, else a hidden one, else none. */
export function rangeHolding(ranges: readonly ShownRange[], biased: number): ShownRange | undefined {
  const holding = ranges.filter(({ low, high }) => low <= biased && biased <= high);
  return holding.find(({ visible }) => visible) ?? holding[0];
}
