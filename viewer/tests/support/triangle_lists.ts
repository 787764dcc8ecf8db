/** What tests ask of triangles that are numbers of vertices. */
import { decodeSurface, type Patch } from "../../src/core/surfaces/surface_patches";
import type { Vec3 } from "../../src/core/geometry/vector";
import { patchOf } from "./ball_surface";

type Triangle = readonly [number, number, number];

export function listed(numbers: ArrayLike<number>): Triangle[] {
  return Array.from({ length: numbers.length / 3 }, (_, i) => [
    numbers[3 * i] ?? -1,
    numbers[3 * i + 1] ?? -1,
    numbers[3 * i + 2] ?? -1,
  ]);
}

/** Where a vertex stands in the scene [mm]. */
export function place({ origin, size, vertices }: Patch, vertex: number): Vec3 {
  const along = (axis: 0 | 1 | 2): number => origin[axis] + ((vertices[3 * vertex + axis] ?? NaN) / 65535) * size[axis];
  return [along(0), along(1), along(2)];
}

/** Edges that an odd number of triangles has: where a surface ends. */
export function ends(numbers: ArrayLike<number>): string[] {
  const odd = new Set<string>();
  for (const [a, b, c] of listed(numbers)) {
    for (const [from, to] of [[a, b], [b, c], [c, a]] as const) {
      const name = `${String(Math.min(from, to))} ${String(Math.max(from, to))}`;
      if (!odd.delete(name)) {
        odd.add(name);
      }
    }
  }
  return [...odd].sort();
}

/** A patch as it is after it was sent. */
export function decoded(
  points: readonly Vec3[],
  normals: readonly Vec3[],
  triangles: readonly number[],
  index: Vec3 = [0, 0, 0],
): Patch {
  const [patch] = decodeSurface({
    id: 1,
    whole: true,
    dropped: [],
    patches: [patchOf(index, points, normals, triangles)],
  }).patches;
  if (patch === undefined) {
    throw new Error("no patch");
  }
  return patch;
}

/** Vertices of each face of `thinWall`. */
export const faceVertices = 31 * 31;

/** Two squares of 30 × 30 mm, 1 mm apart, that face away from each other; the lower one's vertices come first. */
export function thinWall(): Patch {
  const [low, high] = [sheet(0, -1), sheet(1, 1)];
  const squares = Array.from({ length: faceVertices }, (_, i) => i).filter((i) => i % 31 < 30 && i < 31 * 30);
  const one = squares.flatMap((i) => [i, i + 1, i + 31, i + 31, i + 1, i + 32]);
  return decoded(
    [...low.points, ...high.points],
    [...low.normals, ...high.normals],
    [...one, ...one.map((i) => i + faceVertices)],
  );
}

function sheet(height: number, up: number): { points: Vec3[]; normals: Vec3[] } {
  const points = Array.from({ length: faceVertices }, (_, i): Vec3 => [i % 31, Math.floor(i / 31), height]);
  return { points, normals: points.map(() => [0, 0, up]) };
}
