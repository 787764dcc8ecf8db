/** What is asked of the engine where segments shall look otherwise. */
import { deepEqual } from "../base/deep_equal";
import type { Segment, SegmentProperties, ShownAs } from "../protocol";

/** What a person changes of how a segment looks and is touched. */
export type SegmentLook = Omit<SegmentProperties, "type" | "id">;

/** Parts of segments' looks by the segments' ids. */
export type LookParts = Readonly<Record<number, Partial<SegmentLook>>>;

/** What of a segment's look is changed, as a step of undo says it. */
const names: Readonly<Record<keyof SegmentLook, string>> = {
  name: "name",
  colour: "colour",
  visible: "visibility",
  touchable: "touch",
  locked: "lock",
  shown_as: "display mode",
  opacity: "opacity",
  smoothing: "smoothing",
  surface_from: "surface",
  wireframe: "wireframe",
  ambient: "ambient light",
  specular: "specular light",
};

export function nameOfPart(part: Partial<SegmentLook>): string {
  return keysOf(part).map((key) => names[key]).join(", ");
}

/** A segment's properties with some of them changed. */
export function changedProperties(segment: Segment, part: Partial<SegmentLook>): SegmentProperties {
  const { id, name, colour, visible, touchable, locked, ...rest } = { ...segment, ...part };
  const { shown_as, opacity, smoothing, surface_from, wireframe, ambient, specular } = rest;
  return {
    type: "segment_properties",
    ...{ id, name, colour, visible, touchable, locked },
    ...{ shown_as, opacity, smoothing, surface_from, wireframe, ambient, specular },
  };
}

/** Whether all of them are drawn in the same way, and which; null where they are not. */
export function commonWay(segments: readonly Segment[]): ShownAs | null {
  const [first, ...rest] = segments;
  const isCommon = first !== undefined && rest.every((segment) => segment.shown_as === first.shown_as);
  return isCommon ? first.shown_as : null;
}

/** What changes where all of them get a part of a look. */
export function changedForAll(segments: readonly Segment[], part: Partial<SegmentLook>): LookParts {
  const differs = (segment: Segment): boolean => keysOf(part).some((key) => !deepEqual(segment[key], part[key]));
  return Object.fromEntries(segments.filter(differs).map(({ id }) => [id, part]));
}

/** What changes where one alone is to be seen; all again where it is alone already. */
export function shownAlone(segments: readonly Segment[], id: number): LookParts {
  const alone = segments.every((segment) => segment.visible === (segment.id === id));
  const others = segments.filter((segment) => segment.visible !== (alone || segment.id === id));
  return Object.fromEntries(others.map((segment) => [segment.id, { visible: !segment.visible }]));
}

/** The same parts as they are now; without segments that are gone. */
export function presentParts(segments: readonly Segment[], parts: LookParts): LookParts {
  return mapped(segments, parts, (segment, part) => picked(segment, keysOf(part)));
}

/** Of these parts those in whose place still stands what was `left` there. */
export function partsInPlace(segments: readonly Segment[], parts: LookParts, left: LookParts): LookParts {
  return mapped(segments, left, (segment, part) =>
    picked(parts[segment.id] ?? {}, keysOf(part).filter((key) => deepEqual(segment[key], part[key]))),
  );
}

/** Those whose names hold all words that are looked for, in whatever order. */
export function named(segments: readonly Segment[], wanted: string): readonly Segment[] {
  const words = wanted.toLowerCase().split(/\s+/u).filter((word) => word !== "");
  const holds = ({ name }: Segment): boolean => words.every((word) => name.toLowerCase().includes(word));
  return words.length === 0 ? segments : segments.filter(holds);
}

function mapped(
  segments: readonly Segment[],
  parts: LookParts,
  change: (segment: Segment, part: Partial<SegmentLook>) => Partial<SegmentLook>,
): LookParts {
  const changed = segments.flatMap((segment) => {
    const part = change(segment, parts[segment.id] ?? {});
    return keysOf(part).length === 0 ? [] : [[segment.id, part] as const];
  });
  return Object.fromEntries(changed);
}

function picked(look: Partial<SegmentLook>, keys: readonly (keyof SegmentLook)[]): Partial<SegmentLook> {
  return Object.fromEntries(keys.map((key) => [key, look[key]]));
}

function keysOf(part: Partial<SegmentLook>): (keyof SegmentLook)[] {
  return Object.keys(part) as (keyof SegmentLook)[];
}
