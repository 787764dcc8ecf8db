/**
 * Where a slice cuts the surfaces of segments, wherever these stand by now: for segments that were moved
 * and meshes of their own grid, which the scan's voxels tell nothing of.
 *
 * Result: an SVG path in CSS pixels of the slice, one stroke for each triangle that is cut.
 */
import { transformPoint, transformVector } from "../geometry/affine";
import type { Viewport } from "../geometry/camera";
import type { Pose } from "../protocol";
import type { SlicePlane } from "./slice_plane";
import type { Patch } from "../surfaces/surface_patches";
import { dot, scale, subtract, type Vec3 } from "../geometry/vector";

/** Largest number of a vertex along its patch's box. */
const fullShare = 65535;

/** A linear function of a vertex's three numbers. */
type Form = readonly [number, number, number, number];

export function outlineOnSlice(patches: readonly Patch[], pose: Pose, plane: SlicePlane, viewport: Viewport): string {
  return patches.map((patch) => patchOutline(patch, pose, plane, viewport)).join("");
}

function patchOutline(patch: Patch, pose: Pose, plane: SlicePlane, viewport: Viewport): string {
  const form = (axis: Vec3, perMm: number, first: number): Form => {
    const along = ([[1, 0, 0], [0, 1, 0], [0, 0, 1]] as const).map(
      (edge, i) => (dot(axis, transformVector(pose, edge)) * perMm * (patch.size[i] ?? 0)) / fullShare,
    );
    const start = subtract(transformPoint(pose, patch.origin), plane.centre);
    return [along[0] ?? 0, along[1] ?? 0, along[2] ?? 0, first + dot(axis, start) * perMm];
  };
  const before = form(plane.toward, 1, 0);
  if (missesBox(before)) {
    return "";
  }
  const right = form(plane.right, 1 / plane.pixel, viewport.width / 2);
  const down = form(scale(plane.up, -1), 1 / plane.pixel, viewport.height / 2);
  const { vertices, triangles } = patch;
  const distances = new Float64Array(vertices.length / 3).map((_, i) => valueAt(before, vertices, i));

  const place = (a: number, b: number): string => {
    const [da, db] = [distances[a] ?? 0, distances[b] ?? 0];
    const share = da / (da - db);
    const on = (along: Form): number => {
      const [va, vb] = [valueAt(along, vertices, a), valueAt(along, vertices, b)];
      return va + (vb - va) * share;
    };
    return `${on(right).toFixed(1)} ${on(down).toFixed(1)}`;
  };
  let path = "";
  for (let corner = 0; corner + 2 < triangles.length; corner += 3) {
    const [a, b, c] = [triangles[corner] ?? 0, triangles[corner + 1] ?? 0, triangles[corner + 2] ?? 0];
    const [ia, ib, ic] = [isBefore(distances, a), isBefore(distances, b), isBefore(distances, c)];
    if (ia !== ib || ib !== ic) {
      // the corner that stands alone, and the two edges that leave it
      const [alone, one, other] = ib === ic ? [a, b, c] : ia === ic ? [b, a, c] : [c, a, b];
      path += `M${place(alone, one)}L${place(alone, other)}`;
    }
  }
  return path;
}

function isBefore(distances: Float64Array, vertex: number): boolean {
  return (distances[vertex] ?? 0) >= 0;
}

function valueAt([x, y, z, constant]: Form, vertices: Uint16Array, vertex: number): number {
  const i = 3 * vertex;
  return constant + x * (vertices[i] ?? 0) + y * (vertices[i + 1] ?? 0) + z * (vertices[i + 2] ?? 0);
}

/** Whether a form has one sign over a patch's whole box. */
function missesBox([x, y, z, constant]: Form): boolean {
  const ends = [x, y, z].map((slope) => slope * fullShare);
  const least = ends.reduce((sum, end) => sum + Math.min(end, 0), constant);
  const most = ends.reduce((sum, end) => sum + Math.max(end, 0), constant);
  return least > 0 || most < 0;
}
