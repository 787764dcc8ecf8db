/**
 * What stands in the scene, as a slice shows it.
 */
import type { Viewport } from "../geometry/camera";
import { placeOnSlice, type SlicePlane } from "./slice_plane";
import type { Vec3 } from "../geometry/vector";

/** Least radius of a point [pixels]. */
const leastRadius = 4;
/** Away from the plane by this, something is no longer shown [mm]. */
const shownWithin = 12;

export interface SliceCircle {
  /** Of its middle [CSS pixels]. */
  readonly x: number;
  readonly y: number;
  /** Of its cut with the plane, or of a small mark where there is none [pixels]. */
  readonly radius: number;
  /** 1 where the plane cuts it, fading with its distance to 0. */
  readonly strength: number;
}

/** A ball of the scene [mm] where a slice cuts it, or faintly where it is near. */
export function circleOnSlice(plane: SlicePlane, middle: Vec3, radius: number, viewport: Viewport): SliceCircle {
  const { x, y, before } = placeOnSlice(plane, middle, viewport);
  const away = Math.abs(before);
  const cut = Math.sqrt(Math.max(0, radius ** 2 - before ** 2));
  return { x, y, radius: Math.max(leastRadius, cut / plane.pixel), strength: strengthAway(away, radius) };
}

/** How strongly something shows that is away from the plane [mm] and reaches so far: 1 where they meet. */
export function strengthAway(away: number, reach = 0): number {
  return Math.max(0, 1 - Math.max(0, away - Math.max(reach, 0.5)) / shownWithin) ** 2;
}
