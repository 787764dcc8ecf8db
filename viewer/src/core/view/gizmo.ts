/**
 * Handles by which an object is dragged in the picture: arrows along L, P, S, rings about them,
 * and a disc in the view plane. Lengths on the screen in CSS pixels, in the scene in mm.
 */
import { alongView, pixelSizeAt, project, type Camera, type Viewport } from "../geometry/camera";
import { shifted, turned } from "../geometry/object_pose";
import type { Pose } from "../protocol";
import { add, addScaled, cross, dot, scale, type Vec3 } from "../geometry/vector";

export type Handle =
  | { readonly kind: "plane" }
  | { readonly kind: "arrow"; readonly axis: Vec3 }
  /** `at` is where the ring is held [rad]. */
  | { readonly kind: "ring"; readonly axis: Vec3; readonly at: number };

/** Handles' axes and letters. */
export const gizmoAxes: readonly { readonly letter: "L" | "P" | "S"; readonly axis: Vec3 }[] = [
  { letter: "L", axis: [1, 0, 0] },
  { letter: "P", axis: [0, 1, 0] },
  { letter: "S", axis: [0, 0, 1] },
];

/** Length of the arrows and radius of the rings. */
export const arrowPixels = 92;
export const ringPixels = 62;

/** Share of an axis toward the viewer from which on it is no direction on the screen. */
const steepest = 0.94;

/** Where things are seen. */
export interface Eye {
  readonly camera: Camera;
  readonly viewport: Viewport;
}

/** A point of a ring about an axis at an angle, `pixels` from its middle. */
export function ringPoint(centre: Vec3, axis: Vec3, angle: number, pixels: number, { camera, viewport }: Eye): Vec3 {
  const [u, v] = across(axis);
  const radius = pixels * pixelSizeAt(camera, centre, viewport);
  return add(centre, add(scale(u, radius * Math.cos(angle)), scale(v, radius * Math.sin(angle))));
}

/** Angle of a ring's point that is seen nearest to a place of the picture. */
export function nearestOnRing(centre: Vec3, axis: Vec3, place: readonly [number, number], eye: Eye): number {
  const angles = Array.from({ length: 72 }, (_, step) => (step * Math.PI) / 36);
  const far = (angle: number): number => {
    const seen = project(eye.camera, ringPoint(centre, axis, angle, ringPixels, eye), eye.viewport);
    return seen === null ? Infinity : Math.hypot(seen[0] - place[0], seen[1] - place[1]);
  };
  return angles.reduce((best, angle) => (far(angle) < far(best) ? angle : best), 0);
}

/** The pose after a handle was dragged by x, y pixels, from a pose whose middle was at `centre`. */
export function dragged(pose: Pose, handle: Handle, centre: Vec3, [x, y]: readonly [number, number], eye: Eye): Pose {
  const { camera, viewport } = eye;
  switch (handle.kind) {
    case "plane":
      return shifted(pose, alongView(camera, x, y, centre, viewport));
    case "arrow": {
      const size = arrowPixels * pixelSizeAt(camera, centre, viewport);
      const share = alongScreen(centre, addScaled(centre, handle.axis, size), [x, y], eye);
      return shifted(pose, scale(handle.axis, share * size));
    }
    case "ring": {
      // by the way that the held point goes on the screen, so that a ring seen from its edge works
      const step = 0.01;
      const held = ringPoint(centre, handle.axis, handle.at, ringPixels, eye);
      const next = ringPoint(centre, handle.axis, handle.at + step, ringPixels, eye);
      return turned(pose, centre, handle.axis, step * alongScreen(held, next, [x, y], eye));
    }
  }
}

/** How far along an axis a point goes that is dragged by x, y pixels [mm]. */
export function draggedAlong(at: Vec3, axis: Vec3, [x, y]: readonly [number, number], eye: Eye): number {
  const { camera, viewport } = eye;
  const pixel = pixelSizeAt(camera, at, viewport);
  // where the axis points at the viewer it cannot be followed on the screen: upward is away from him
  const toViewer = dot(axis, camera.back);
  if (Math.abs(toViewer) > steepest) {
    return y * pixel * Math.sign(toViewer);
  }
  return pixel * alongScreen(at, addScaled(at, axis, pixel), [x, y], eye);
}

/** How often a way on the screen holds the one from `from` to `to`; nothing where that is a point. */
function alongScreen(from: Vec3, to: Vec3, [x, y]: readonly [number, number], { camera, viewport }: Eye): number {
  const [a, b] = [project(camera, from, viewport), project(camera, to, viewport)];
  if (a === null || b === null) {
    return 0;
  }
  const way = [b[0] - a[0], b[1] - a[1]] as const;
  const squared = way[0] ** 2 + way[1] ** 2;
  return squared > 1e-9 ? (x * way[0] + y * way[1]) / squared : 0;
}

/** Two unit vectors across an axis, right-handed with it. */
function across(axis: Vec3): readonly [Vec3, Vec3] {
  const other: Vec3 = Math.abs(dot(axis, [0, 0, 1])) < 0.5 ? [0, 0, 1] : [1, 0, 0];
  const u = cross(other, axis);
  const unit = scale(u, 1 / Math.hypot(...u));
  return [unit, cross(axis, unit)];
}
