/**
 * Displaced tissue, in a real browser: a ball of a scan of 48³ voxels, seen from
 * before on 96² pixels, and surfaces of triangles.
 */
import { afterAll, beforeAll, expect, test } from "vitest";
import { extentOf, lookFrom, project } from "../../src/core/geometry/camera";
import type { Vec3 } from "../../src/core/geometry/vector";
import { openGlBrowser, type GlBrowser } from "./browser";
import type { MarchTest } from "./scenes_page";
import type { DisplacedTest, ScreenTest, SurfaceTest } from "./screen_page";

const edge = 96;
const viewport = { width: edge, height: edge };
let browser: GlBrowser;

beforeAll(async () => {
  browser = await openGlBrowser();
});

afterAll(async () => {
  await browser.close();
});

function show(what: ScreenTest): Promise<number[]> {
  return browser.page.evaluate((t) => window.glTests?.show(t) ?? Promise.reject(new Error("no page")), what);
}

/** Voxels of 1 mm, and of 2 mm from one slice to the next; the ball reaches 14 mm from the middle. */
const spacing: Vec3 = [1, 1, 2];
const green: MarchTest = { field: "ball", spacing, from: "A", stepsPerVoxel: 2, segment: "visible", softTissue: 0 };
const air: MarchTest = { field: "flat", spacing, from: "A", stepsPerVoxel: 1, extinction: 0 };
const middle: Vec3 = [24, 24, 48];
const red: SurfaceTest = { centre: middle, radius: 12, sectors: 4, appearance: { colour: [1, 0, 0] } };

/** The ball, all of it, and what it moves into. */
function all(moved: Vec3): DisplacedTest {
  return { origin: [-0.5, -0.5, 4.5], step: [1, 1, 0.5], size: [50, 50, 78], moved };
}

/** The middle of all pixels in which one colour is the strongest [pixels], and how many these are. */
function discOf(
  pixels: readonly number[],
  colour: 0 | 1 | 2,
): { readonly x: number; readonly y: number; readonly count: number } {
  let [x, y, count] = [0, 0, 0];
  for (let i = 0; i < edge * edge; ++i) {
    const [others, own] = [
      [0, 1, 2].filter((c) => c !== colour).map((c) => pixels[4 * i + c] ?? 0),
      pixels[4 * i + colour] ?? 0,
    ];
    if (own > 60 && others.every((other) => own > 1.4 * other)) {
      [x, y, count] = [x + (i % edge) + 0.5, y + edge - 0.5 - Math.floor(i / edge), count + 1];
    }
  }
  return { x: x / count, y: y / count, count };
}

/** By how much the middle of the picture's ball moves [pixels]. */
function expectedShift(moved: Vec3): readonly [number, number] {
  const corner = (i: number): Vec3 => [i & 1 ? 48 : 0, i & 2 ? 48 : 0, i & 4 ? 96 : 0];
  const camera = lookFrom("A", extentOf([0, 1, 2, 3, 4, 5, 6, 7].map(corner)), viewport);
  const to: Vec3 = [middle[0] + moved[0], middle[1] + moved[1], middle[2] + moved[2]];
  const [from, there] = [project(camera, middle, viewport), project(camera, to, viewport)];
  return [(there?.[0] ?? NaN) - (from?.[0] ?? NaN), (there?.[1] ?? NaN) - (from?.[1] ?? NaN)];
}

test.each([
  ["scan", green, [], 1],
  ["surface", air, [red], 0],
] as const)(
  "the %s is drawn where its tissue is displaced to, also between voxels",
  async (_, scan, surfaces, colour) => {
    const still = discOf(await show({ scan, surfaces }), colour);
    expect(still.count).toBeGreaterThan(300);
    for (const moved of [
      [8, 0, 0],
      [0, 0, 8],
      [0.6, 0, -0.6],
    ] as const) {
      const disc = discOf(await show({ scan, surfaces, displaced: [all(moved)] }), colour);
      const [right, down] = expectedShift(moved);
      // the mean of some hundred pixels at the outline
      expect(Math.abs(disc.x - still.x - right)).toBeLessThan(0.12);
      expect(Math.abs(disc.y - still.y - down)).toBeLessThan(0.12);
      expect(Math.abs(disc.count / still.count - 1)).toBeLessThan(0.04);
    }
  },
);

test("displacements of two boxes add up, whatever their nodes", async () => {
  const coarse: DisplacedTest = { origin: [-4, -4, 2], step: [4, 4, 2], size: [15, 15, 22], moved: [5, 0, 0] };
  const one = await show({ scan: green, displaced: [all([8, 0, 0])] });
  for (const boxes of [
    [all([3, 0, 0]), coarse],
    [coarse, all([3, 0, 0])],
  ]) {
    const [both, alone] = [discOf(await show({ scan: green, displaced: boxes }), 1), discOf(one, 1)];
    expect(Math.hypot(both.x - alone.x, both.y - alone.y)).toBeLessThan(0.1);
    expect(Math.abs(both.count / alone.count - 1)).toBeLessThan(0.01);
  }
});

test("where nothing has moved the picture is the one without a model, to the bit", async () => {
  for (const what of [{ scan: green }, { scan: air, surfaces: [red] }]) {
    expect(await show({ ...what, displaced: "none" })).toEqual(await show(what));
  }
});

test("beside the box all stays as it is", async () => {
  // only what is left of the middle, and right of it nothing
  const left: DisplacedTest = { origin: [-0.5, -0.5, 4.5], step: [1, 1, 0.5], size: [25, 50, 78], moved: [0, 0, 6] };
  const [before, after] = [await show({ scan: green }), await show({ scan: green, displaced: [left] })];
  const changed = [0, 0];
  for (let i = 0; i < edge * edge; ++i) {
    const side = i % edge < edge / 2 ? 0 : 1;
    const differs = [0, 1, 2].some((c) => Math.abs((before[4 * i + c] ?? 0) - (after[4 * i + c] ?? 0)) > 12);
    changed[side] = (changed[side] ?? 0) + (differs ? 1 : 0);
  }
  // patient left is at the right of the picture, seen from before; light of the sky reaches a little over
  const [most, least] = changed.sort((a, b) => b - a);
  expect(most).toBeGreaterThan(60);
  expect(least).toBeLessThan(20);
});

test("a segment that was moved by hand does not give way", async () => {
  const pose = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  const posed = { ...red, appearance: { ...red.appearance, pose } };
  const still = await show({ scan: air, surfaces: [posed] });
  const displaced = [all([8, 0, 0])];
  const [a, b] = [discOf(still, 0), discOf(await show({ scan: air, surfaces: [posed], displaced }), 0)];
  expect([b.x, b.y]).toEqual([a.x, a.y]);
});
