/**
 * Marks as lines on the screen: in the 3-D view as they stand in space, in a slice by how near they lie.
 * Places are CSS pixels of a pane.
 */
import { project, type Camera, type Viewport } from "../geometry/camera";
import { isArea } from "./area";
import type { MarkKind } from "./measure";
import { strengthAway } from "../slices/slice_marks";
import { placeOnSlice, type SlicePlane } from "../slices/slice_plane";
import type { Vec3 } from "../geometry/vector";

/** A mark's point on the screen; `before` tells how far before a slice's plane it stands [mm], 0 in the 3-D view. */
export interface MarkPlace {
  readonly x: number;
  readonly y: number;
  readonly before: number;
}

/** Where points stand in the 3-D view; null for one behind the eye. */
export function placesInView(
  points: readonly Vec3[],
  camera: Camera,
  viewport: Viewport,
): readonly (MarkPlace | null)[] {
  return points.map((point) => {
    const place = project(camera, point, viewport);
    return place === null ? null : { x: place[0], y: place[1], before: 0 };
  });
}

/** Where points stand in a slice, or are projected to. */
export function placesOnSlice(points: readonly Vec3[], plane: SlicePlane, viewport: Viewport): readonly MarkPlace[] {
  return points.map((point) => placeOnSlice(plane, point, viewport));
}

/** How strongly a mark's lines show, 0..1: all where one of them meets the plane, else by the nearest end. */
export function strengthOf(places: readonly MarkPlace[]): number {
  const depths = places.map(({ before }) => before);
  const meets = Math.min(...depths) <= 0 && Math.max(...depths) >= 0;
  return meets ? 1 : Math.max(0, ...depths.map((depth) => strengthAway(Math.abs(depth))));
}

/** Where a mark's label stands: beside the middle of a distance, the vertex of an angle, a point, an end of an area. */
export function labelPlace(kind: MarkKind, places: readonly MarkPlace[]): MarkPlace | null {
  const [first, second] = places;
  if (first === undefined) {
    return null;
  }
  if (second === undefined || kind === "point") {
    return first;
  }
  if (kind === "angle" || isArea(kind)) {
    return second;
  }
  return { x: (first.x + second.x) / 2, y: (first.y + second.y) / 2, before: 0 };
}

/** Of a label's lines, and about a letter [CSS pixels]. */
export const labelLine = 15;
export const letterWidth = 8;
/** What stands in the corners of a slice: its name, the read-out, what it shows, the scale. Sizes [CSS pixels]. */
const corners = [
  { left: true, top: true, width: 96, height: 30 },
  { left: false, top: true, width: 210, height: 44, narrow: { width: 120, height: 78 } },
  { left: true, top: false, width: 190, height: 60, narrow: { width: 160, height: 82 } },
  { left: false, top: false, width: 130, height: 40 },
] as const;
/** Up to this width a pane is narrow. */
const narrowPane = 420;

/**
 * Where a label of some lines goes so that it stands on nothing that tells of the slice; its first baseline.
 *
 * @param enlarged by how much letters and corners are larger than usual.
 */
export function clearOfCorners(
  place: { readonly x: number; readonly y: number },
  lines: readonly string[],
  pane: Viewport,
  enlarged = 1,
): { readonly x: number; readonly y: number } {
  const line = labelLine * enlarged;
  const width = letterWidth * enlarged * Math.max(...lines.map(({ length }) => length));
  const below = line * (lines.length - 1) + 4;
  const x = Math.max(4, Math.min(place.x, pane.width - width - 4));
  let y = Math.max(line, Math.min(place.y, pane.height - below));
  for (const corner of corners) {
    const size = pane.width <= narrowPane && "narrow" in corner ? corner.narrow : corner;
    const [wide, tall] = [size.width * enlarged, size.height * enlarged];
    const beside = corner.left ? x >= wide : x + width <= pane.width - wide;
    if (!beside && corner.top && y - line < tall) {
      y = tall + line;
    } else if (!beside && !corner.top && y + below > pane.height - tall) {
      y = pane.height - tall - below;
    }
  }
  return { x, y };
}
