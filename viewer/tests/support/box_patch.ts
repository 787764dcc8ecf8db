/** A patch for tests: the surface of a box. */
import type { Patch } from "../../src/core/surfaces/surface_patches";
import type { Vec3 } from "../../src/core/geometry/vector";

/** The surface of a box of 12 triangles, as a patch [mm]. */
export function boxPatch(origin: Vec3, size: Vec3): Patch {
  const corners = [0, 1, 2, 3, 4, 5, 6, 7].flatMap((bits) => [0, 1, 2].map((axis) => ((bits >> axis) & 1) * 65535));
  const sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
  const triangles = sides.flatMap(([a = 0, b = 0, c = 0, d = 0]) => [a, b, c, a, c, d]);
  return {
    key: "0 0 0",
    origin,
    size,
    vertices: Uint16Array.from(corners),
    normals: new Int8Array(32),
    triangles: Uint16Array.from(triangles),
  };
}
