/**
 * Fewer triangles of a patch over the same vertices, for pictures that are drawn in haste while other patches of its
 * surface are edited.
 *
 * Of each cluster of vertices the one nearest to their mean stands for all, and triangles whose corners fall together
 * are left out. Vertices on the patch's border stand for themselves: neighbouring patches meet there as before,
 * whatever each of them leaves out.
 */
import type { Patch } from "./surface_patches";
import { at, clusterName, next, pointsOf, sumOfEdges } from "./vertex_clusters";

type Numbers = Patch["triangles"];

/** Edge of a cube, in mean edges of the patch's triangles. */
const edgesPerCube = 5;

/** The triangles that are left of a patch, numbered as its own are. */
export function coarseTriangles(patch: Patch): Numbers {
  const points = pointsOf(patch);
  const clusters = clustersOf(patch, points);
  return remaining(patch.triangles, nearestToMean(points, clusters));
}

/**
 * 1 for vertices on the border. Around any other one the triangles close a ring, in which each
 * neighbour comes next once and before once: so the numbers of their neighbours cancel out.
 */
function borderOf(count: number, triangles: Numbers): Uint8Array {
  const rest = new Float64Array(count);
  for (let corner = 0; corner < triangles.length; ++corner) {
    const vertex = at(triangles, corner);
    rest[vertex] = at(rest, vertex) + at(triangles, next(corner)) - at(triangles, next(next(corner)));
  }
  return Uint8Array.from(rest, (sum) => (sum === 0 ? 0 : 1));
}

/** The cluster of each vertex, numbered from 0; each vertex on the border has one of its own. */
function clustersOf({ normals, triangles }: Patch, points: Float32Array): Uint32Array {
  const edge = (edgesPerCube * sumOfEdges(points, triangles)) / Math.max(1, triangles.length);
  const numbers = new Map<number, number>();
  let count = 0;
  return Uint32Array.from(borderOf(points.length / 3, triangles), (isBorder, vertex) => {
    if (isBorder === 1) {
      return count++;
    }
    const name = clusterName((axis) => Math.floor(at(points, 3 * vertex + axis) / edge), normals, vertex);
    const number = numbers.get(name) ?? count++;
    numbers.set(name, number);
    return number;
  });
}

/** For each vertex the one that stands for it: of those in its cluster the nearest to their mean. */
function nearestToMean(points: Float32Array, clusters: Uint32Array): Uint32Array {
  const means = new Float64Array(3 * clusters.length);
  const counts = new Uint32Array(clusters.length);
  clusters.forEach((cluster, vertex) => {
    const n = (counts[cluster] = at(counts, cluster) + 1);
    for (let axis = 0; axis < 3; ++axis) {
      means[3 * cluster + axis] = at(means, 3 * cluster + axis) * (1 - 1 / n) + at(points, 3 * vertex + axis) / n;
    }
  });
  const least = new Float64Array(clusters.length).fill(Infinity);
  const nearest = new Uint32Array(clusters.length);
  clusters.forEach((cluster, vertex) => {
    const away = (axis: number): number => at(points, 3 * vertex + axis) - at(means, 3 * cluster + axis);
    const distance = away(0) ** 2 + away(1) ** 2 + away(2) ** 2;
    if (distance < at(least, cluster)) {
      least[cluster] = distance;
      nearest[cluster] = vertex;
    }
  });
  return clusters.map((cluster) => at(nearest, cluster));
}

/** Triangles whose corners have three to stand for them. */
function remaining(triangles: Numbers, standing: Uint32Array): Numbers {
  const left = triangles.slice();
  let length = 0;
  for (let corner = 0; corner < triangles.length; corner += 3) {
    const a = at(standing, at(triangles, corner));
    const b = at(standing, at(triangles, corner + 1));
    const c = at(standing, at(triangles, corner + 2));
    if (a !== b && b !== c && c !== a) {
      left.set([a, b, c], length);
      length += 3;
    }
  }
  return left.slice(0, length);
}
