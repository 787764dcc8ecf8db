/** What is asked of the engine where a segment shall look otherwise. */
import type { Segment, SegmentProperties, ShownAs } from "./protocol";

/** A segment's properties with some of them changed. */
export function changedProperties(segment: Segment, part: Partial<Segment>): SegmentProperties {
  const { id, name, colour, visible, touchable, ...rest } = { ...segment, ...part };
  const { shown_as, opacity, smoothing, surface_from, wireframe } = rest;
  return { type: "segment_properties", id, name, colour, visible, touchable, shown_as, opacity, smoothing, surface_from, wireframe };
}

/** Whether all of them are drawn in the same way, and which; null where they are not. */
export function commonWay(segments: readonly Segment[]): ShownAs | null {
  const [first, ...rest] = segments;
  const same = first !== undefined && rest.every((segment) => segment.shown_as === first.shown_as);
  return same ? first.shown_as : null;
}

/** What changes where all of them get a property. */
export function changedForAll(segments: readonly Segment[], part: Partial<Segment>): SegmentProperties[] {
  const differs = (segment: Segment): boolean =>
    Object.entries(part).some(([key, value]) => segment[key as keyof Segment] !== value);
  return segments.filter(differs).map((segment) => changedProperties(segment, part));
}

/** What changes where one alone is to be seen; all again where it is alone already. */
export function shownAlone(segments: readonly Segment[], id: number): SegmentProperties[] {
  const alone = segments.every((segment) => segment.visible === (segment.id === id));
  return segments
    .filter((segment) => segment.visible !== (alone || segment.id === id))
    .map((segment) => changedProperties(segment, { visible: !segment.visible }));
}

/** Those whose names hold all words that are looked for, in whatever order. */
export function named(segments: readonly Segment[], wanted: string): readonly Segment[] {
  const words = wanted.toLowerCase().split(/\s+/u).filter((word) => word !== "");
  const holds = ({ name }: Segment): boolean => words.every((word) => name.toLowerCase().includes(word));
  return words.length === 0 ? segments : segments.filter(holds);
}
