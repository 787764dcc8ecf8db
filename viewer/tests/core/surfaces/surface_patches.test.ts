import { expect, test } from "vitest";
import type { SurfacePatch } from "../../../src/core/protocol";
import { decodeSurface, PatchError, SurfacePatches } from "../../../src/core/surfaces/surface_patches";
import type { Vec3 } from "../../../src/core/geometry/vector";
import { Random } from "../../support/random";
import { ballSurface, patchOf } from "../../support/ball_surface";

const corners: readonly Vec3[] = [[10, 0, -4], [12, 0, -4], [10, 5, -4], [10, 0, 3]];
const normals: readonly Vec3[] = [[0, 0, 1], [0, 1, 0], [1, 0, 0], [0, 0, -1]];
const good = patchOf([0, 0, 0], corners, normals, [0, 1, 2, 0, 2, 3]);

function decode(patch: SurfacePatch, id = 3): ReturnType<typeof decodeSurface> {
  return decodeSurface({ id, whole: false, dropped: [], patches: [patch] });
}

test("vertices stand where they were to a 65535th of their box, normals to a 127th", () => {
  const [patch] = decode(good).patches;
  corners.forEach((corner, i) => {
    corner.forEach((place, axis) => {
      const share = (patch?.vertices[3 * i + axis] ?? 0) / 65535;
      const edge = patch?.size[axis] ?? 0;
      expect(Math.abs((patch?.origin[axis] ?? 0) + share * edge - place)).toBeLessThanOrEqual(edge / 65535);
      expect((patch?.normals[4 * i + axis] ?? 0) / 127).toBe(normals[i]?.[axis]);
    });
  });
  expect([...(patch?.triangles ?? [])]).toEqual([0, 1, 2, 0, 2, 3]);
});

test("bytes that begin anywhere in a message are read the same", () => {
  const moved = (bytes: Uint8Array): Uint8Array => {
    const memory = new Uint8Array(bytes.length + 1);
    memory.set(bytes, 1);
    return memory.subarray(1);
  };
  const odd = {
    ...good,
    vertices: moved(good.vertices),
    normals: moved(good.normals),
    triangles: moved(good.triangles),
  };
  expect(decode(odd)).toEqual(decode(good));
});

const short = (bytes: Uint8Array, by: number): Uint8Array => bytes.subarray(0, bytes.length - by);

test.each([
  ["half a vertex", { vertices: short(good.vertices, 3) }, /21 bytes of vertices; allowed: 6 each/],
  ["a vertex without normal", { normals: short(good.normals, 4) }, /12 bytes of normals for 4 vertices/],
  ["a normal too many", { normals: new Uint8Array(20) }, /20 bytes of normals for 4 vertices/],
  ["half a triangle", { triangles: short(good.triangles, 2) }, /10 bytes of triangles; allowed: 6 each/],
  ["a vertex that is not there", { triangles: new Uint8Array([0, 0, 1, 0, 4, 0]) }, /a triangle has vertex 4 of 4/],
  ["triangles without vertices", { vertices: new Uint8Array(), normals: new Uint8Array() }, /vertex 3 of 0/],
  ["a box turned inside out", { size: [1, -1, 1] as Vec3 }, /edges 1, -1, 1 mm/],
])("a patch with %s is refused, and says which and why", (_, lie, told) => {
  const lying = (): unknown => decode({ ...good, index: [1, -2, 3], ...lie });
  expect(lying).toThrow(PatchError);
  expect(lying).toThrow(told);
  expect(lying).toThrow("patch (1 -2 3) of segment 3");
});

test("random bytes are refused or make a patch whose triangles have all their vertices", () => {
  const random = new Random(41);
  const bytes = (most: number): Uint8Array =>
    Uint8Array.from({ length: random.whole(0, most) }, () => random.whole(0, 3));
  let taken = 0;
  for (let trial = 0; trial < 2000; ++trial) {
    try {
      const [patch] = decode({ ...good, vertices: bytes(24), normals: bytes(16), triangles: bytes(12) }).patches;
      taken += 1;
      expect(Math.max(-1, ...(patch?.triangles ?? []))).toBeLessThan((patch?.vertices.length ?? 0) / 3);
      expect(patch?.normals).toHaveLength((4 * (patch?.vertices.length ?? 0)) / 3);
    } catch (error) {
      expect(error).toBeInstanceOf(PatchError);
    }
  }
  expect(taken).toBeGreaterThan(0);
});

test.each([
  [65535, 2, Uint16Array],
  [65536, 2, Uint32Array],
  [65537, 4, Uint32Array],
] as const)("of %d vertices each is numbered in %d bytes, and none by what ends a strip", (count, bytesEach, held) => {
  const last = count - 1;
  const numbers = bytesEach === 2 ? Uint16Array.of(0, 1, last) : Uint32Array.of(0, 1, last);
  const [patch] = decode({
    ...good,
    vertices: new Uint8Array(6 * count),
    normals: new Uint8Array(4 * count),
    triangles: new Uint8Array(numbers.buffer),
  }).patches;
  expect(patch?.triangles).toBeInstanceOf(held);
  expect(patch?.triangles[2]).toBe(last);
});

test("patches are exchanged one by one, dropped, and forgotten with the whole", () => {
  const surfaces = new SurfacePatches();
  surfaces.apply(decodeSurface(ballSurface(1, [0, 0, 0], 5, 4)));
  surfaces.apply(decodeSurface(ballSurface(2, [0, 0, 0], 5, 2)));
  // 32 rings of 64 columns, two triangles each
  expect(surfaces.sizes.get(1)).toMatchObject({ patches: 4, triangles: 4096 });

  const smaller = { ...good, index: [2, 0, 0] as Vec3 };
  surfaces.apply(decodeSurface({ id: 1, whole: false, dropped: [[0, 0, 0], [9, 9, 9]], patches: [smaller] }));
  expect(surfaces.sizes.get(1)).toMatchObject({ patches: 3, triangles: 2048 + 2 });

  // a patch that is empty now may also be sent as such
  const empty = { ...good, index: [2, 0, 0] as Vec3, triangles: new Uint8Array() };
  surfaces.apply(decodeSurface({ id: 1, whole: false, dropped: [], patches: [empty] }));
  expect(surfaces.sizes.get(1)?.patches).toBe(2);

  surfaces.apply(decodeSurface({ id: 1, whole: true, dropped: [], patches: [] }));
  expect(surfaces.ids).toEqual([2]);
});

test("the memory of a surface is what its patches hold", () => {
  const surfaces = new SurfacePatches();
  surfaces.apply(decode(good, 1));
  expect(surfaces.sizes.get(1)?.bytes).toBe(4 * 6 + 4 * 4 + 6 * 2);
});
