import { describe, expect, test } from "vitest";
import { coarseTriangles } from "../../../src/core/surfaces/coarse_triangles";
import { throughTriangle } from "../../../src/core/picking/pick_patches";
import { decodeSurface } from "../../../src/core/surfaces/surface_patches";
import { length, type Vec3 } from "../../../src/core/geometry/vector";
import { Random } from "../../support/random";
import { ballSurface } from "../../support/ball_surface";
import { decoded, ends, faceVertices, listed, place, thinWall } from "../../support/triangle_lists";

const radius = 20;
const rings = 96;
/** A ball about the origin in four patches, of 36 864 triangles. */
const ball = decodeSurface(ballSurface(1, [0, 0, 0], radius, 4, rings)).patches;

describe.each(ball.map((patch) => [patch.key, patch] as const))("patch %s of a ball", (_, patch) => {
  const few = coarseTriangles(patch);

  test("has a fifth of its triangles at most", () => {
    expect(few.length).toBeGreaterThan(0);
    expect(few.length).toBeLessThan(patch.triangles.length / 5);
  });

  test("has triangles of three vertices of its own", () => {
    for (const triangle of listed(few)) {
      expect(new Set(triangle).size).toBe(3);
      expect(Math.max(...triangle)).toBeLessThan(patch.vertices.length / 3);
    }
  });

  test("ends where it ended, to the vertex: no crack beside its neighbours, no hole in it", () => {
    expect(ends(few)).toEqual(ends(patch.triangles));
  });
});

test("a ball stays closed, and its facets lie no deeper than their length allows", () => {
  const random = new Random(5);
  const triangles = ball.flatMap((patch) =>
    listed(coarseTriangles(patch)).map(
      (triangle) => triangle.map((vertex) => place(patch, vertex)) as [Vec3, Vec3, Vec3],
    ),
  );
  // a cube's edge is 5 mean edges of 0.6 mm; a facet as long as the diagonal of two cubes, 10.4 mm, lies 0.7 mm inside
  const deepest = radius - Math.sqrt(radius ** 2 - (10.4 / 2) ** 2);
  for (let trial = 0; trial < 500; ++trial) {
    const way = random.vector(1);
    const met = triangles.map((corners) => throughTriangle([0, 0, 0], way, ...corners)).filter((t) => t !== null);
    expect(met.length).toBeGreaterThan(0);
    for (const t of met) {
      expect(radius - t * length(way)).toBeLessThan(deepest);
    }
  }
});

test("the two faces of a thin wall stay apart", () => {
  const patch = thinWall();
  const faces = listed(coarseTriangles(patch)).map(
    (triangle) => new Set(triangle.map((vertex) => (vertex < faceVertices ? "low" : "high"))),
  );
  expect(faces.every((face) => face.size === 1)).toBe(true);
  const count = (face: "low" | "high"): number => faces.filter((one) => one.has(face)).length;
  expect(count("low")).toBe(count("high"));
  expect(count("low")).toBeLessThan(patch.triangles.length / 2 / 3 / 4);
});

test("a patch without triangles has none left, and one of a single triangle keeps it", () => {
  const corners: Vec3[] = [[0, 0, 0], [1, 0, 0], [0, 1, 0]];
  const up: Vec3[] = [[0, 0, 1], [0, 0, 1], [0, 0, 1]];
  const empty = { ...decoded(corners, up, []), vertices: new Uint16Array(), normals: new Int8Array() };
  expect([...coarseTriangles(empty)]).toEqual([]);
  expect([...coarseTriangles(decoded(corners, up, []))]).toEqual([]);
  expect([...coarseTriangles(decoded(corners, up, [0, 1, 2]))]).toEqual([0, 1, 2]);
  // all in one place
  expect([...coarseTriangles(decoded([corners[0] ?? [0, 0, 0], [0, 0, 0], [0, 0, 0]], up, [0, 1, 2]))]).toEqual([
    0, 1, 2,
  ]);
});
