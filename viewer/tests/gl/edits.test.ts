/**
 * Edits in a real browser: what they send to the GPU, and that they are shown whole or not at all.
 */
import { afterAll, beforeAll, expect, test } from "vitest";
import type { Vec3 } from "../../src/core/geometry/vector";
import { ballSurface } from "../support/ball_surface";
import { openGlBrowser, type GlBrowser } from "./browser";
import type { EditResult, EditTest } from "./edit_page";
import type { MarchTest } from "./scenes_page";

let browser: GlBrowser;

beforeAll(async () => {
  browser = await openGlBrowser();
});

afterAll(async () => {
  await browser.close();
});

type Sent = Omit<EditTest, "before" | "surfaces"> & { readonly before?: Balls; readonly surfaces?: Balls };
type Balls = readonly { readonly centre: Vec3; readonly sectors?: number; readonly lie?: boolean }[];

/** Surfaces as plain numbers: bytes do not travel into the browser as what they are. */
function edit({ before = [], surfaces = [], ...test }: Sent): Promise<EditResult> {
  const plain = (balls: Balls): unknown =>
    balls.map(({ centre, sectors = 2, lie = false }, i) => {
      const surface = ballSurface(i + 1, centre, 6, sectors);
      const patches = surface.patches.map((patch, p) => ({
        ...patch,
        vertices: [...patch.vertices],
        normals: [...patch.normals],
        triangles: [...patch.triangles.subarray(0, lie && p === sectors - 1 ? 5 : undefined)],
      }));
      return { ...surface, patches };
    });
  return browser.page.evaluate(
    ([t, b, s]) => {
      interface Packed { readonly patches: readonly Record<string, unknown>[] }
      const unpacked = (all: unknown): never =>
        (all as Packed[]).map((surface) => ({
          ...surface,
          patches: surface.patches.map((patch) => ({
            ...patch,
            vertices: Uint8Array.from(patch["vertices"] as number[]),
            normals: Uint8Array.from(patch["normals"] as number[]),
            triangles: Uint8Array.from(patch["triangles"] as number[]),
          })),
        })) as never;
      return (
        window.glTests?.edit({ ...t, before: unpacked(b), surfaces: unpacked(s) }) ??
        Promise.reject(new Error("no page"))
      );
    },
    [test, plain(before), plain(surfaces)] as const,
  );
}

/** How many pixels two pictures differ in by more than `most` in any channel. */
function differing(one: readonly number[], other: readonly number[], most = 0): number {
  let count = 0;
  for (let i = 0; i < one.length; i += 4) {
    count += [0, 1, 2].some((c) => Math.abs((one[i + c] ?? 0) - (other[i + c] ?? 0)) > most) ? 1 : 0;
  }
  return count;
}

const scan: MarchTest = {
  field: "ball",
  spacing: [1, 1, 1],
  from: "A",
  stepsPerVoxel: 2,
  segment: "visible",
  softTissue: 0,
};
/** A hole in the front of the scan's ball, which reaches from 10 to 38 on each axis. */
const hole = { low: [20, 8, 19] as Vec3, high: [29, 20, 30] as Vec3 };
const box = [20, 8, 19, 9, 12, 11];
const nothing = {
  scan,
  ...hole,
  value: null,
  label: null,
  appearances: [{ colour: [1, 0, 0] as Vec3, shown_as: "surface" as const, range: null }],
};

test.each([
  ["values", -1000, null, [box]],
  ["labels", null, 1, [box]],
  ["values and labels", -1000, 0, [box, box]],
] as const)(
  "an edit of %s sends just its box, and is then what a new picture shows",
  async (_, value, label, uploads) => {
    const appearances = [{ colour: [0, 0, 1] as Vec3, range: null }];
    const result = await edit({
      ...nothing,
      scan: label === 1 ? { ...scan, segment: "hidden" } : scan,
      value,
      label,
      appearances,
    });
    expect(result.complaints).toEqual([]);
    expect(result.uploads.filter((upload) => upload.join() === box.join())).toHaveLength(uploads.length);
    // beside the box only labels that did not exist before, and the small grid of bricks
    const others = result.uploads.filter((upload) => upload.join() !== box.join());
    expect(others.every(([, , , width = 0]) => width <= 48)).toBe(true);
    expect(differing(result.before, result.after, 10)).toBeGreaterThan(50);
    expect(differing(result.after, result.afresh)).toBe(0);
  },
);

test("values that fill empty space are drawn: bricks that were leapt over are not any more", async () => {
  const corner = { low: [2, 2, 38] as Vec3, high: [12, 12, 46] as Vec3 };
  const result = await edit({ ...nothing, ...corner, value: 500 });
  expect(differing(result.before, result.after, 20)).toBeGreaterThan(50);
  expect(differing(result.after, result.afresh)).toBe(0);
});

test("voxels and patches of one edit are in the next picture together", async () => {
  const result = await edit({
    ...nothing,
    value: -1000,
    before: [{ centre: [24, 8, 24] }],
    surfaces: [{ centre: [24, 8, 40] }],
  });
  expect(result.complaints).toEqual([]);
  // vertices, normals and triangles of two patches, sent before anything is drawn
  expect(result.buffers).toBe(6);
  // clocks of pages are coarse
  expect(result.milliseconds).toBeGreaterThanOrEqual(0);
  expect(differing(result.before, result.after, 10)).toBeGreaterThan(100);
  expect(differing(result.after, result.afresh)).toBe(0);
});

test("of an edit with one patch that lies nothing is shown, and it is told why", async () => {
  const result = await edit({
    ...nothing,
    value: -1000,
    before: [{ centre: [24, 8, 24] }],
    surfaces: [{ centre: [24, 8, 40], lie: true }],
  });
  expect(result.complaints).toEqual([
    "Edit 1 cannot be shown: patch (1 0 0) of segment 1: 5 bytes of triangles; allowed: 6 each.",
  ]);
  expect(result.uploads).toEqual([]);
  expect(result.buffers).toBe(0);
  expect(differing(result.before, result.after)).toBe(0);
});
