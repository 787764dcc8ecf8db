/**
 * Where a mouse or keys take the hand: a point in the scene that the device is pulled to.
 * The hand moves in the movement frame: scene positions, axes of the view (thesis 4.7).
 */
import { alongView, pixelSizeAt, type Camera, type Viewport } from "../geometry/camera";
import { add, addScaled, clampToBall, type Vec3 } from "../geometry/vector";

/** Farthest that the hand goes ahead of the probe [mm], so that the way back stays short. */
export const farthestAhead = 40;

/** Hand after a move in the view plane by x pixels rightward and y downward. */
export function moveInView(hand: Vec3, probe: Vec3, x: number, y: number, camera: Camera, viewport: Viewport): Vec3 {
  const moved = addScaled(hand, alongView(camera, x, y, probe, viewport), 1);
  return clampToBall(moved, probe, farthestAhead);
}

/** Hand after a move away from the viewer by as much as `pixels` cover at the probe. */
export function moveInDepth(hand: Vec3, probe: Vec3, pixels: number, camera: Camera, viewport: Viewport): Vec3 {
  const moved = addScaled(hand, camera.back, -pixels * pixelSizeAt(camera, probe, viewport));
  return clampToBall(moved, probe, farthestAhead);
}

/** Hand after a move along a vector of the scene [mm]. */
export function moveAlong(hand: Vec3, probe: Vec3, way: Vec3): Vec3 {
  return clampToBall(add(hand, way), probe, farthestAhead);
}
