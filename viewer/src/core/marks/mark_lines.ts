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
  return kind === "angle" || isArea(kind) ? second : { x: (first.x + second.x) / 2, y: (first.y + second.y) / 2, before: 0 };
}
