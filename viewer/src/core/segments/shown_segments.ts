/**
 * Segments as the picture shows them.
 *
 * A segment made by a threshold is the set of points whose interpolated value lies in its
 * range: a visible one is a solid surface in its colour, a hidden one is left out of the
 * picture. Where both claim a value, the visible one wins.
 */
import { linearFromSrgb } from "../base/colour";
import type { Segment } from "../protocol";
import { biasedRange, type Rescale } from "../scan/stored_values";
import type { Vec3 } from "../geometry/vector";

export interface ShownRange {
  readonly id: number;
  /** Biased values, both ends included. */
  readonly low: number;
  readonly high: number;
  /** Linear RGB. */
  readonly colour: Vec3;
  readonly visible: boolean;
  /** Its id where it was edited: then the labels decide too; else 0. */
  readonly label: number;
  /** Where visible: tissue in its colour, and no solid body. */
  readonly tinted?: boolean;
  /** Opacity of the surface that is drawn where its voxels are, instead of them. */
  readonly surface?: number;
  /** Opacity of the body of its voxels that can stand for that surface; 0 where none can. */
  readonly body?: number;
  /** Factors on ambient and specular light; 1 where none are given. */
  readonly material?: readonly [number, number];
}

/** How a visible segment's voxels look inside the volume: a body, tissue in its colour, or as the scan. */
export const insideModes = ["solid", "tinted", "plain"] as const;
export type InsideMode = (typeof insideModes)[number];

/** The mode of each segment by its id; solid where none is chosen. */
export type InsideModes = Readonly<Partial<Record<number, InsideMode>>>;

/** Segments whose values can tell of them at once. In sync with `gl/shaders/segments.glsl`. */
export const mostRanges = 32;

/** Whether a segment's voxels are coloured in the picture; where its surface stands for them they are left out. */
export function drawnFromVoxels({ visible, shown_as }: Segment): boolean {
  return visible && shown_as !== "surface";
}

/** Whether slices show a segment's voxels, whatever stands for it in the 3-D view; of others they show the surface. */
export function drawnInSlices({ visible, pose, grid }: Segment): boolean {
  return visible && pose === null && grid === null;
}

/** All of segments that the picture depends on: not how many voxels they have, nor their names. */
export function drawnKey(segments: readonly Segment[]): string {
  return JSON.stringify(
    segments.map((segment) => [
      segment.id,
      segment.colour,
      segment.visible,
      segment.felt,
      segment.range,
      segment.made_by,
      segment.steps?.range,
      segment.pose,
      segment.shown_as,
      segment.opacity,
      segment.wireframe,
      segment.ambient,
      segment.specular,
    ]),
  );
}

/** Whether a segment's surface is drawn. */
export function drawnAsSurface({ visible, shown_as, opacity }: Segment): boolean {
  return visible && shown_as !== "volume" && opacity > 0;
}

/** Opacity of the surface that stands where the scan has the segment; 0 where there is none. */
export function surfaceInPlace(segment: Segment): number {
  return drawnAsSurface(segment) && segment.pose === null && segment.grid === null ? segment.opacity : 0;
}

/**
 * Opacity of the body of a segment's voxels that can stand for its surface, which is closed then, and where they are; 0
 * where none can.
 *
 * @param mode how its voxels are drawn beside the surface: as a body they let nothing through.
 */
export function bodyOpacity(segment: Segment, mode: InsideMode = "solid"): number {
  const inside = drawnFromVoxels(segment) ? mode : null;
  const opacity = segment.wireframe || inside === "plain" ? 0 : surfaceInPlace(segment);
  return opacity > 0 && inside === "solid" ? 1 : opacity;
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

/**
 * The segments that a threshold made, in the order of the list, as many as can be drawn from values.
 * An edited one that is hidden is none: its labels are not sent.
 */
export function shownByValue(segments: readonly Segment[]): Segment[] {
  return segments
    .filter(({ range, made_by, visible }) => range !== null || (made_by !== null && visible))
    .slice(0, mostRanges);
}

/** Those that only their values tell of, and for which there is no room: nothing of their voxels is seen. */
export function withoutRoom(segments: readonly Segment[]): Segment[] {
  const shown = new Set(shownByValue(segments));
  return segments.filter((segment) => segment.range !== null && !shown.has(segment));
}

/** The ranges of these segments, visible where `drawn` says so. */
export function shownRanges(
  segments: readonly Segment[],
  rescale: Rescale,
  drawn: (segment: Segment) => boolean = drawnFromVoxels,
): ShownRange[] {
  return shownByValue(segments).flatMap((segment) => {
    const range = segment.range ?? segment.made_by;
    if (range === null) {
      return [];
    }
    const [low, high] = biasedRange(range[0], range[1], rescale);
    const { id, colour, ambient, specular } = segment;
    const label = segment.range === null ? id : 0;
    const appearance = {
      colour: linearFromSrgb(colour),
      material: [ambient, specular],
      surface: surfaceInPlace(segment),
      body: bodyOpacity(segment),
    } as const;
    return [{ id, low, high, ...appearance, visible: drawn(segment), label }];
  });
}

/** Ranges as the volume shows them: without those that look as the scan does. */
export function rangesInside(ranges: readonly ShownRange[], modes: InsideModes): ShownRange[] {
  return ranges
    .filter(({ id, visible }) => !visible || modes[id] !== "plain")
    .map((range) => (range.visible && modes[range.id] === "tinted" ? tintedOf(range) : range));
}

function tintedOf(range: ShownRange): ShownRange {
  const { body = 0, surface = 0 } = range;
  return { ...range, tinted: true, body: body > 0 ? surface : 0 };
}

/** The segment that is just a threshold that a value belongs to: a visible one if any, else a hidden one, else none. */
export function rangeHolding(ranges: readonly ShownRange[], biased: number): ShownRange | undefined {
  const holding = ranges.filter(({ low, high, label }) => label === 0 && low <= biased && biased <= high);
  return holding.find(({ visible }) => visible) ?? holding[0];
}
