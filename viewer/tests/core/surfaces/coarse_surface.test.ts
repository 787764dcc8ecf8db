import { describe, expect, test } from "vitest";
import { CoarseSurface } from "../../../src/core/surfaces/coarse_surface";
import { throughTriangle } from "../../../src/core/picking/pick_patches";
import { decodeSurface, type Patch } from "../../../src/core/surfaces/surface_patches";
import { dot, length, normalize, subtract, type Vec3 } from "../../../src/core/geometry/vector";
import { Random } from "../../support/random";
import { ballSurface } from "../../support/ball_surface";
import { decoded, ends, listed, place, thinWall } from "../../support/triangle_lists";

function coarse(patches: readonly Patch[]): Patch {
  const surface = new CoarseSurface(patches);
  for (let left = patches.length; left > 0; --left) {
    expect(surface.isWhole).toBe(false);
    surface.takeNext();
  }
  expect(surface.isWhole).toBe(true);
  return surface.patch;
}

describe("a ball of four patches", () => {
  const [centre, radius] = [[-30, 5, 12] satisfies Vec3, 20];
  const { patches } = decodeSurface(ballSurface(1, centre, radius, 4, 96));
  const few = coarse(patches);

  test("has a twelfth of its triangles at most, of three vertices each", () => {
    expect(few.triangles.length).toBeGreaterThan(0);
    expect(few.triangles.length).toBeLessThan(patches.reduce((sum, { triangles }) => sum + triangles.length, 0) / 12);
    for (const triangle of listed(few.triangles)) {
      expect(new Set(triangle).size).toBe(3);
      expect(Math.max(...triangle)).toBeLessThan(few.vertices.length / 3);
    }
  });

  test("has no end: patches meet without a crack", () => {
    expect(patches.some(({ triangles }) => ends(triangles).length > 0)).toBe(true);
    expect(ends(few.triangles)).toEqual([]);
  });

  test("stands where it stood, no deeper than its facets are long", () => {
    const random = new Random(6);
    const triangles = listed(few.triangles).map(
      (triangle) => triangle.map((vertex) => place(few, vertex)) as [Vec3, Vec3, Vec3],
    );
    // a cube's edge is 6 mean edges of 0.6 mm; a facet as long as the diagonal of two cubes, 12.5 mm, lies 1 mm inside
    const deepest = radius - Math.sqrt(radius ** 2 - (12.5 / 2) ** 2);
    for (let trial = 0; trial < 500; ++trial) {
      const way = random.vector(1);
      const met = triangles.map((corners) => throughTriangle(centre, way, ...corners)).filter((t) => t !== null);
      expect(met.length).toBeGreaterThan(0);
      for (const t of met) {
        expect(t * length(way)).toBeLessThan(radius + 1e-3);
        expect(radius - t * length(way)).toBeLessThan(deepest);
      }
    }
  });

  test("has normals of length one that point out of it", () => {
    for (let vertex = 0; vertex < few.vertices.length / 3; ++vertex) {
      const normal: Vec3 = [
        few.normals[4 * vertex] ?? 0,
        few.normals[4 * vertex + 1] ?? 0,
        few.normals[4 * vertex + 2] ?? 0,
      ];
      // bytes cut off less than one along each axis
      expect(length(normal)).toBeGreaterThan(127 - 2);
      expect(dot(normalize(normal), normalize(subtract(place(few, vertex), centre)))).toBeGreaterThan(Math.cos(0.03));
    }
  });
});

test("the two faces of a thin wall stay apart", () => {
  const wall = thinWall();
  const few = coarse([wall]);
  const heights = listed(few.triangles).map((triangle) => triangle.map((vertex) => place(few, vertex)[2]));
  expect(heights.every((three) => three.every((height) => height === three[0] && (height === 0 || height === 1)))).toBe(
    true,
  );
  expect(new Set(heights.flat()).size).toBe(2);
  expect(few.triangles.length).toBeLessThan(wall.triangles.length / 12);
});

test("of what is smaller than a cube nothing is left, of nothing neither", () => {
  const up: Vec3[] = [[0, 0, 1], [0, 0, 1], [0, 0, 1]];
  expect(coarse([decoded([[0, 0, 0], [1, 0, 0], [0, 1, 0]], up, [0, 1, 2])]).triangles).toHaveLength(0);
  expect(coarse([decoded([[2, 2, 2], [2, 2, 2], [2, 2, 2]], up, [0, 1, 2])]).triangles).toHaveLength(0);
  expect(coarse([]).triangles).toHaveLength(0);
});
