/** Where the light of the picture comes from. */
import type { Camera } from "../../core/geometry/camera";
import { add, normalize, scale, type Vec3 } from "../../core/geometry/vector";

/** Over the viewer's left shoulder. */
export function keyLight(camera: Camera): Vec3 {
  return normalize(add(add(scale(camera.right, -0.45), scale(camera.up, 0.65)), scale(camera.back, 0.75)));
}
