/**
 * A whole surface with few triangles over vertices of its own, for pictures that are drawn in haste.
 *
 * The mean of each cluster of vertices, whichever patches they belong to, stands for all of them, and triangles whose
 * corners fall together are left out: so patches join without borders. They are taken in one after the other, each in a
 * short time. Frame: that of the patches, the scene before the segment's pose.
 */
import type { Patch } from "./surface_patches";
import { length, scale, subtract, type Vec3 } from "../geometry/vector";
import { at, clusterName, pointsOf, sumOfEdges } from "./vertex_clusters";

/** Edge of a cube, in mean edges of the surface's triangles. */
const edgesPerCube = 6;
/** Patches by whose edges those of all are told. */
const sampled = 16;

export class CoarseSurface {
  private readonly left: Patch[];
  /** Lower corner and edges of the box around all patches [mm]. */
  private readonly corner: Vec3;
  private readonly size: Vec3;
  /** Edge of a cube [mm]. */
  private readonly cube: number;
  private readonly numbers = new Map<number, number>();
  /**
   * Of each cluster: sums of its vertices' places from the corner [mm] and of their normals, shape [cluster_count, 6].
   */
  private readonly sums: number[] = [];
  private readonly counts: number[] = [];
  private readonly triangles: number[] = [];

  constructor(patches: readonly Patch[]) {
    this.left = [...patches];
    const low = (axis: 0 | 1 | 2): number =>
      patches.reduce((least, { origin }) => Math.min(least, origin[axis]), Infinity);
    const high = (axis: 0 | 1 | 2): number =>
      patches.reduce((most, { origin, size }) => Math.max(most, origin[axis] + size[axis]), -Infinity);
    this.corner = [low(0), low(1), low(2)];
    this.size = subtract([high(0), high(1), high(2)], this.corner);
    this.cube = edgesPerCube * meanEdge(patches);
  }

  /** All patches were taken in. */
  get isWhole(): boolean {
    return this.left.length === 0;
  }

  /** Takes in the next patch. */
  takeNext(): void {
    const patch = this.left.pop();
    if (patch === undefined) {
      return;
    }
    const clusters = this.gather(patch);
    const { triangles } = patch;
    for (let corner = 0; corner < triangles.length; corner += 3) {
      const a = at(clusters, at(triangles, corner));
      const b = at(clusters, at(triangles, corner + 1));
      const c = at(clusters, at(triangles, corner + 2));
      if (a !== b && b !== c && c !== a) {
        this.triangles.push(a, b, c);
      }
    }
  }

  /** What was taken in, as one patch. */
  get patch(): Patch {
    const { corner, counts, size, sums, triangles } = this;
    const count = counts.length;
    const share = (cluster: number, axis: number): number =>
      at(sums, 6 * cluster + axis) / at(counts, cluster) / Math.max(at(size, axis), 1e-9);
    const normals = new Int8Array(4 * count);
    for (let cluster = 0; cluster < count; ++cluster) {
      const sum: Vec3 = [at(sums, 6 * cluster + 3), at(sums, 6 * cluster + 4), at(sums, 6 * cluster + 5)];
      normals.set(scale(sum, 127 / Math.max(length(sum), 1)), 4 * cluster);
    }
    return {
      key: "",
      origin: corner,
      size,
      vertices: Uint16Array.from({ length: 3 * count }, (_, i) => Math.round(65535 * share(Math.floor(i / 3), i % 3))),
      normals,
      triangles: count < 65536 ? Uint16Array.from(triangles) : Uint32Array.from(triangles),
    };
  }

  /** The cluster of each vertex of a patch, which are counted into them. */
  private gather(patch: Patch): Uint32Array {
    const { counts, cube, numbers, sums } = this;
    const points = pointsOf(patch);
    const { normals } = patch;
    const [x, y, z] = subtract(patch.origin, this.corner);
    return Uint32Array.from({ length: points.length / 3 }, (_, vertex) => {
      const place: Vec3 = [x + at(points, 3 * vertex), y + at(points, 3 * vertex + 1), z + at(points, 3 * vertex + 2)];
      const name = clusterName((axis) => Math.floor(at(place, axis) / cube), normals, vertex);
      const number = numbers.get(name) ?? counts.length;
      if (number === counts.length) {
        numbers.set(name, number);
        counts.push(0);
        sums.push(0, 0, 0, 0, 0, 0);
      }
      counts[number] = at(counts, number) + 1;
      for (let axis = 0; axis < 3; ++axis) {
        sums[6 * number + axis] = at(sums, 6 * number + axis) + at(place, axis);
        sums[6 * number + 3 + axis] = at(sums, 6 * number + 3 + axis) + at(normals, 4 * vertex + axis);
      }
      return number;
    });
  }
}

/** Mean edge of a surface's triangles, by some of its patches [mm]. */
function meanEdge(patches: readonly Patch[]): number {
  const every = Math.ceil(patches.length / sampled);
  const some = patches.filter((_, i) => i % every === 0);
  const sum = some.reduce((length, patch) => length + sumOfEdges(pointsOf(patch), patch.triangles), 0);
  return sum / Math.max(1, some.reduce((count, { triangles }) => count + triangles.length, 0));
}
