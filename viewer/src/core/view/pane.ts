/**
 * A pane of the picture, for what lies over it. Places are CSS pixels from the pane's upper left corner.
 */
import type { Vec3 } from "../geometry/vector";
import type { MarkPlace } from "../marks/mark_lines";
import type { SliceName } from "../slices/slice_plane";
import type { Rect } from "./picture_layout";

/** A part of the picture: the 3-D view or a slice. */
export type PaneName = "view" | SliceName;

export interface Pane {
  readonly name: PaneName;
  readonly rect: Rect;
  /** Where points of the scene stand in the pane; null for those outside of it. */
  readonly placesOf: (points: readonly Vec3[]) => readonly (MarkPlace | null)[];
  /** Where a point of the scene goes that is dragged to a place. */
  readonly dragTo: (point: Vec3, x: number, y: number) => Vec3;
}
