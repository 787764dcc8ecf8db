/**
 * Clusters of a surface's vertices: those in a cube whose normals look toward the same side of it. By their sides the
 * two faces of a thin wall stay apart, and what is hollow does not come to the light.
 * Source: Rossignac and Borrel, "Multi-resolution 3D approximations for rendering complex scenes" (1993).
 */
import type { Patch } from "./surface_patches";

/** More cubes than there are along any axis: vertices stand in 65536 places. */
const mostAlong = 65537;

/**
 * The name of the cluster that a vertex falls into: of the cube that holds a point, as its place along each axis, and
 * of the normal's side.
 */
export function clusterName(cube: (axis: number) => number, normals: Int8Array, vertex: number): number {
  return 6 * ((cube(2) * mostAlong + cube(1)) * mostAlong + cube(0)) + sideOf(normals, 4 * vertex);
}

/** Places of a patch's vertices in its box [mm], shape [vertex_count, 3]. */
export function pointsOf({ vertices, size }: Patch): Float32Array {
  return Float32Array.from(vertices, (share, i) => (share / 65535) * (size[i % 3] ?? 0));
}

/** Sum of the lengths of triangles' edges. */
export function sumOfEdges(points: Float32Array, triangles: ArrayLike<number>): number {
  let sum = 0;
  for (let corner = 0; corner < triangles.length; ++corner) {
    const [a, b] = [3 * at(triangles, corner), 3 * at(triangles, next(corner))];
    const along = (axis: number): number => at(points, b + axis) - at(points, a + axis);
    sum += Math.sqrt(along(0) ** 2 + along(1) ** 2 + along(2) ** 2);
  }
  return sum;
}

/** The side of a cube that the normal which begins at a place looks toward, 0 to 5. */
function sideOf(normals: Int8Array, place: number): number {
  const [x, y, z] = [at(normals, place), at(normals, place + 1), at(normals, place + 2)];
  const most = Math.max(Math.abs(x), Math.abs(y), Math.abs(z));
  if (most === Math.abs(x)) {
    return x > 0 ? 0 : 1;
  }
  if (most === Math.abs(y)) {
    return y > 0 ? 2 : 3;
  }
  return z > 0 ? 4 : 5;
}

/** The corner after one in its triangle. */
export function next(corner: number): number {
  return corner % 3 === 2 ? corner - 2 : corner + 1;
}

export function at(numbers: ArrayLike<number>, place: number): number {
  return numbers[place] ?? 0;
}
