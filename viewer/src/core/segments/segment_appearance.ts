/** The appearance of segments: what a person changes of it, and what is asked of the engine then. */
import { deepEqual } from "../base/deep_equal";
import type { FromPage, Segment, SegmentProperties, ShownAs, ShownSegments } from "../protocol";

/** How a segment looks and is touched, as far as a person changes it. */
export type SegmentAppearance = Omit<SegmentProperties, "type" | "id">;

/** Parts of segments' appearance by the segments' ids. */
export type AppearanceParts = Readonly<Record<number, Partial<SegmentAppearance>>>;

/** The parts of a segment's appearance, as steps of undo name them. @texts */
const names: Readonly<Record<keyof SegmentAppearance, string>> = {
  name: "name",
  colour: "colour",
  visible: "visibility",
  touched_while_hidden: "touch while hidden",
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

export function nameOfPart(part: Partial<SegmentAppearance>): string {
  return keysOf(part).map((key) => names[key]).join(", ");
}

/** A segment's properties with some of them changed. */
export function changedProperties(segment: Segment, part: Partial<SegmentAppearance>): SegmentProperties {
  return { type: "segment_properties", id: segment.id, ...appearanceOf({ ...segment, ...part }) };
}

/** What many are changed in at once: whether they are seen, and how they are drawn. */
const changedTogether: ReadonlySet<string> = new Set<keyof SegmentAppearance>(["visible", "shown_as"]);

/** What asks the engine for these parts: one message for many segments where that can be. */
export function askedFor(segments: readonly Segment[], parts: AppearanceParts): readonly FromPage[] {
  const changed = segments.flatMap((segment) => {
    const part = parts[segment.id];
    return part === undefined ? [] : [{ segment, part }];
  });
  const isTogether =
    changed.length > 1 && changed.every(({ part }) => keysOf(part).every((k) => changedTogether.has(k)));
  return isTogether
    ? [{ type: "show_segments", changes: alike(changed.map(({ segment: { id }, part }) => ({ id, part }))) }]
    : changed.map(({ segment, part }) => changedProperties(segment, part));
}

/** Those that change in the same way, together. */
function alike(
  changed: readonly { readonly id: number; readonly part: Partial<SegmentAppearance> }[],
): readonly ShownSegments[] {
  const groups = new Map<string, ShownSegments>();
  for (const { id, part: { visible = null, shown_as = null } } of changed) {
    const key = `${String(visible)} ${String(shown_as)}`;
    groups.set(key, { visible, shown_as, ids: [...(groups.get(key)?.ids ?? []), id] });
  }
  return [...groups.values()];
}

/** Whether all of them are drawn in the same way, and which; null where they are not. */
export function commonWay(segments: readonly Segment[]): ShownAs | null {
  const [first, ...rest] = segments;
  const isCommon = first !== undefined && rest.every((segment) => segment.shown_as === first.shown_as);
  return isCommon ? first.shown_as : null;
}

/** What changes where all of them get a part of an appearance. */
export function changedForAll(segments: readonly Segment[], part: Partial<SegmentAppearance>): AppearanceParts {
  const differs = (segment: Segment): boolean => keysOf(part).some((key) => !deepEqual(segment[key], part[key]));
  return Object.fromEntries(segments.filter(differs).map(({ id }) => [id, part]));
}

/** What changes where one alone is to be seen; all again where it is alone already. */
export function shownAlone(segments: readonly Segment[], id: number): AppearanceParts {
  const alone = segments.every((segment) => segment.visible === (segment.id === id));
  const others = segments.filter((segment) => segment.visible !== (alone || segment.id === id));
  return Object.fromEntries(others.map((segment) => [segment.id, { visible: !segment.visible }]));
}

/** The same parts as they are now; without segments that are gone. */
export function presentParts(segments: readonly Segment[], parts: AppearanceParts): AppearanceParts {
  return mapped(segments, parts, (segment, part) => picked(segment, keysOf(part)));
}

/** Of these parts those in whose place still stands what was `left` there. */
export function partsInPlace(
  segments: readonly Segment[],
  parts: AppearanceParts,
  left: AppearanceParts,
): AppearanceParts {
  return mapped(segments, left, (segment, part) =>
    picked(
      parts[segment.id] ?? {},
      keysOf(part).filter((key) => deepEqual(segment[key], part[key])),
    ),
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
  parts: AppearanceParts,
  change: (segment: Segment, part: Partial<SegmentAppearance>) => Partial<SegmentAppearance>,
): AppearanceParts {
  const changed = segments.flatMap((segment) => {
    const part = change(segment, parts[segment.id] ?? {});
    return keysOf(part).length === 0 ? [] : [[segment.id, part] as const];
  });
  return Object.fromEntries(changed);
}

function appearanceOf(segment: Segment): SegmentAppearance {
  return picked(segment, keysOf(names)) as SegmentAppearance;
}

function picked(
  appearance: Partial<SegmentAppearance>,
  keys: readonly (keyof SegmentAppearance)[],
): Partial<SegmentAppearance> {
  return Object.fromEntries(keys.map((key) => [key, appearance[key]]));
}

function keysOf(part: Partial<Record<keyof SegmentAppearance, unknown>>): (keyof SegmentAppearance)[] {
  return Object.keys(part) as (keyof SegmentAppearance)[];
}
