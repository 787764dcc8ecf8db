/**
 * A second scan in the picture of the first, against the same rays on the CPU: it is looked up through its
 * matrix, where it stands now, and both absorb. Pictures of 96², no jitter.
 */
import { afterAll, beforeAll, expect, test } from "vitest";
import { transformPoint, transformVector, type Affine } from "../../src/core/affine";
import { rayThrough } from "../../src/core/camera";
import { throughBox } from "../../src/core/pick_surface";
import { frameOf } from "../../src/core/scan_volume";
import { scale, type Vec3 } from "../../src/core/vector";
import { scanOf } from "../core/volumes";
import { openGlBrowser, type GlBrowser } from "./browser";
import type { MarchResult } from "./page";
import { channel, edge, raysOf } from "./rays";
import type { SecondTest } from "./second_page";

let browser: GlBrowser;

beforeAll(async () => {
  browser = await openGlBrowser();
}, 60_000);

afterAll(async () => {
  await browser.close();
});

function second(test: SecondTest): Promise<MarchResult[]> {
  return browser.page.evaluate((t) => window.glTests?.second(t) ?? Promise.reject(new Error("no page")), test);
}

const first = frameOf(scanOf([48, 48, 48], [1, 1, 1]));

/** Lengths of the rays in the first scan, and in what of it the second fills, up to `end` of its voxels along x [mm]. */
function lengths(result: MarchResult, place: Affine, end = 40): { readonly first: number; readonly second: number }[] {
  const inFirst = raysOf(result, first);
  return inFirst.map(({ span }, i) => {
    const [x, y] = [i % edge, edge - 1 - Math.floor(i / edge)];
    const ray = rayThrough(result.camera, x + 0.5, y + 0.5, { width: edge, height: edge });
    // voxels of 0.5 mm
    const origin: Vec3 = scale(transformPoint(place, ray.origin), 2);
    const other = throughBox(origin, scale(transformVector(place, ray.direction), 2), [end, 40, 40]);
    const both = span === null || other === null ? 0 : Math.max(0, Math.min(span[1], other[1]) - Math.max(span[0], other[0]));
    return { first: span === null ? 0 : span[1] - span[0], second: both };
  });
}

/** Shares of pixels that are as they should be: at the box's outline a pixel is of two kinds. */
function alike(drawn: readonly number[], expected: readonly number[], within: number): number {
  return drawn.filter((value, i) => Math.abs(value - (expected[i] ?? 0)) < within).length / drawn.length;
}

const turned: Affine = [0.8, -0.6, 0, 6, 0.6, 0.8, 0, -24, 0, 0, 1, -10];
const straight: Affine = [1, 0, 0, -6, 0, 1, 0, -6, 0, 0, 1, -20];

test.each([1, 2])("a second scan absorbs where its matrix puts it, and follows it; subsampled by %d", async (step) => {
  const extinction = 0.06;
  const results = await second({ places: [turned, straight], blend: "composite", first: 0, second: extinction, step });
  [turned, straight].forEach((place, i) => {
    const result = results[i];
    if (result === undefined) {
      throw new Error("no picture");
    }
    const expected = lengths(result, place).map((length) => 1 - Math.exp(-extinction * length.second));
    expect(Math.max(...expected)).toBeGreaterThan(0.5);
    // an interval of 0.25 mm is all of it or nothing
    expect(alike(channel(result, 3), expected, 0.02)).toBeGreaterThan(0.995);
    // its own colour
    expect(alike(channel(result, 2), channel(result, 3), 0.002)).toBe(1);
    expect(Math.max(...channel(result, 0))).toBeLessThan(0.002);
  });
});

test("both absorb where both are, each with its own colour", async () => {
  const [result] = await second({ places: [straight], blend: "composite", first: 0.02, second: 0.06 });
  if (result === undefined) {
    throw new Error("no picture");
  }
  const expected = lengths(result, straight).map((length) => 1 - Math.exp(-0.02 * length.first - 0.06 * length.second));
  expect(alike(channel(result, 3), expected, 0.02)).toBeGreaterThan(0.995);
  const middle = 4 * (edge / 2 + edge * (edge / 2));
  expect(result.pixels[middle]).toBeGreaterThan(0.1);
  expect(result.pixels[middle + 2]).toBeGreaterThan(0.1);
});

test("what is empty of the second scan is leapt over, and nothing else", async () => {
  const [result] = await second({ places: [straight], blend: "absorption", first: 0, second: 0.06, half: true });
  if (result === undefined) {
    throw new Error("no picture");
  }
  const expected = lengths(result, straight, 20).map((length) => 1 - Math.exp(-0.06 * length.second));
  expect(Math.max(...expected)).toBeGreaterThan(0.5);
  expect(alike(channel(result, 3), expected, 0.03)).toBeGreaterThan(0.99);
});
