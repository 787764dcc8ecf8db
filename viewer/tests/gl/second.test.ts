/**
 * A second scan in the picture of the first, against the same rays on the CPU: it is looked up through its
 * matrix, where it stands now, and both absorb. Pictures of 96², no jitter.
 */
import { afterAll, beforeAll, expect, test } from "vitest";
import { transformPoint, transformVector, type Affine } from "../../src/core/geometry/affine";
import { rayThrough } from "../../src/core/geometry/camera";
import { linearFromSrgb } from "../../src/core/base/colour";
import { throughBox } from "../../src/core/picking/pick_surface";
import { frameOf } from "../../src/core/scan/scan_volume";
import { scale, type Vec3 } from "../../src/core/geometry/vector";
import { scanOf } from "../support/volumes";
import { openGlBrowser, type GlBrowser } from "./browser";
import type { MarchResult } from "./scenes_page";
import { channel, edge, raysOf } from "./rays";
import type { SecondTest } from "./second_page";

let browser: GlBrowser;

beforeAll(async () => {
  browser = await openGlBrowser();
});

afterAll(async () => {
  await browser.close();
});

function second(test: SecondTest): Promise<MarchResult[]> {
  return browser.page.evaluate((t) => window.glTests?.second(t) ?? Promise.reject(new Error("no page")), test);
}

const first = frameOf(scanOf([48, 48, 48], [1, 1, 1]));

/** Lengths of the rays in the first scan and in the second, up to `end` of its voxels along x [mm]. */
function lengths(result: MarchResult, place: Affine, end = 40): { readonly first: number; readonly second: number }[] {
  const inFirst = raysOf(result, first);
  return inFirst.map(({ span }, i) => {
    const [x, y] = [i % edge, edge - 1 - Math.floor(i / edge)];
    const ray = rayThrough(result.camera, x + 0.5, y + 0.5, { width: edge, height: edge });
    // voxels of 0.5 mm
    const origin: Vec3 = scale(transformPoint(place, ray.origin), 2);
    const other = throughBox(origin, scale(transformVector(place, ray.direction), 2), [end, 40, 40]);
    const length = (part: readonly [number, number] | null): number =>
      part === null ? 0 : Math.max(0, part[1] - part[0]);
    return { first: length(span), second: length(other) };
  });
}

/** Shares of pixels that are as they should be: at the box's outline a pixel is of two kinds. */
function alike(drawn: readonly number[], expected: readonly number[], within: number): number {
  return drawn.filter((value, i) => Math.abs(value - (expected[i] ?? 0)) < within).length / drawn.length;
}

const turned: Affine = [0.8, -0.6, 0, 6, 0.6, 0.8, 0, -24, 0, 0, 1, -10];
const straight: Affine = [1, 0, 0, -6, 0, 1, 0, -6, 0, 0, 1, -20];
/** Half out of the first scan's face toward the viewer, and wholly before it. */
const outward: Affine = [1, 0, 0, -6, 0, 1, 0, 10, 0, 0, 1, -20];
const before: Affine = [1, 0, 0, -14, 0, 1, 0, 25, 0, 0, 1, -14];
const places = [turned, straight, outward, before];

test.each([1, 2])(
  "a second scan absorbs where its matrix puts it, also beside the first, and follows it; subsampled by %d",
  async (step) => {
    const extinction = 0.06;
    const results = await second({ places, blend: "composite", first: 0, second: extinction, step });
    places.forEach((place, i) => {
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
  },
);

test("both absorb where they are, each with its own colour", async () => {
  const results = await second({ places, blend: "composite", first: 0.02, second: 0.06 });
  places.forEach((place, i) => {
    const result = results[i];
    if (result === undefined) {
      throw new Error("no picture");
    }
    const expected = lengths(result, place).map((length) => 1 - Math.exp(-0.02 * length.first - 0.06 * length.second));
    expect(alike(channel(result, 3), expected, 0.02)).toBeGreaterThan(0.995);
    const middle = 4 * (edge / 2 + edge * (edge / 2));
    expect(result.pixels[middle]).toBeGreaterThan(0.1);
    expect(result.pixels[middle + 2]).toBeGreaterThan(0.1);
  });
});

test.each(["mip", "minip", "average"] as const)(
  "in mode %s each scan has its value, the second over the first",
  async (blend) => {
    // of values that are all alike: the first's share of its window is 0.65, the second's 0.5
    const results = await second({ places, blend, first: 0.02, second: 0.06, opacity: 0.4 });
    places.forEach((place, i) => {
      const result = results[i];
      if (result === undefined) {
        throw new Error("no picture");
      }
      const share = lengths(result, place).map((length) => {
        const first = length.first > 0 ? 0.65 : 0;
        return length.second > 0 ? 0.6 * first + 0.4 * 0.5 : first;
      });
      expect(new Set(share).size).toBeGreaterThan(2);
      expect(alike(channel(result, 3), share, 0.01)).toBeGreaterThan(0.97);
      expect(
        alike(
          channel(result, 0),
          share.map((s) => linearFromSrgb([s, s, s])[0]),
          0.01,
        ),
      ).toBeGreaterThan(0.97);
    });
  },
);

test("its iso-surface is seen through before that of the first, and hidden behind it", async () => {
  const all = [before, outward, straight];
  const [shown, out, hidden] = await second({
    places: all,
    blend: "iso",
    first: 0.02,
    second: 0.06,
    opacity: 0.4,
    isoValue: 50,
  });
  const [alone] = await second({ places: [before], blend: "iso", first: 0, second: 0.06, opacity: 0.4, isoValue: 50 });
  if (shown === undefined || out === undefined || hidden === undefined || alone === undefined) {
    throw new Error("no picture");
  }
  expect(
    alike(
      channel(alone, 3),
      lengths(alone, before).map((length) => (length.second > 0 ? 0.4 : 0)),
      0.01,
    ),
  ).toBeGreaterThan(0.98);
  const opaque = lengths(shown, before).map((length) => (length.first > 0 ? 1 : length.second > 0 ? 0.4 : 0));
  expect(alike(channel(shown, 3), opaque, 0.01)).toBeGreaterThan(0.98);
  // its colour is blue, that of the first red
  const blue = (result: MarchResult, place: Affine): number[] => {
    const met = lengths(result, place).map((length) => length.first > 0 && length.second > 0);
    return channel(result, 2).filter((_, i) => met[i] === true);
  };
  for (const [result, place] of [[shown, before], [out, outward]] as const) {
    const seen = blue(result, place);
    expect(seen.filter((light) => light > 0.1).length / seen.length).toBeGreaterThan(0.95);
  }
  // a highlight of the first is white
  const seen = blue(hidden, straight);
  expect(seen.filter((light) => light < 0.1).length / seen.length).toBeGreaterThan(0.95);
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

/** What a step along a ray is in, from the viewer on: of the first scan, of the second, of none. */
interface Part {
  readonly first: boolean;
  readonly second: boolean;
}

const fine = 0.2;

/** The parts of each pixel's ray, `fine` mm each, where cells of 7 mm show the one or the other. */
function partsInCells(result: MarchResult, place: Affine): Part[][] {
  return raysOf(result, first).map(({ origin, direction }, i) => {
    const [x, y] = [i % edge, edge - 1 - Math.floor(i / edge)];
    const ray = rayThrough(result.camera, x + 0.5, y + 0.5, { width: edge, height: edge });
    const [there, thither] = [transformPoint(place, ray.origin), transformVector(place, ray.direction)];
    const spans = [throughBox(origin, direction, [48, 48, 48]), throughBox(there, thither, [20, 20, 20])];
    const ends = spans.flatMap((span) => span ?? []);
    const parts: Part[] = [];
    for (let t = Math.min(...ends) + fine / 2; t < Math.max(...ends); t += fine) {
      const [inFirst, inSecond] = spans.map((span) => span !== null && span[0] <= t && t <= span[1]);
      const cells = origin.map((from, axis) => Math.floor((from + t * (direction[axis] ?? 0)) / 7));
      const turn = inSecond === true && (((cells[0] ?? 0) + (cells[1] ?? 0) + (cells[2] ?? 0)) & 1) === 1;
      parts.push({ first: inFirst === true && !turn, second: turn });
    }
    return parts;
  });
}

test("in a checkerboard each cell holds one of both, also beside the first", async () => {
  const extinctions = { first: 0.05, second: 0.08 };
  const both = [turned, outward];
  const results = await second({
    places: both,
    blend: "composite",
    ...extinctions,
    viewFusion: "checkerboard",
    square: 7,
  });
  const blended = await second({ places: both, blend: "composite", ...extinctions });
  both.forEach((place, i) => {
    const [result, other] = [results[i], blended[i]];
    if (result === undefined || other === undefined) {
      throw new Error("no picture");
    }
    const expected = partsInCells(result, place).map((parts) => {
      let [red, blue, clarity] = [0, 0, 1];
      for (const part of parts) {
        const passed = Math.exp(-fine * (part.first ? extinctions.first : part.second ? extinctions.second : 0));
        red += part.first ? clarity * (1 - passed) : 0;
        blue += part.second ? clarity * (1 - passed) : 0;
        clarity *= passed;
      }
      return { red, blue };
    });
    // an interval of 0.25 mm belongs to one cell
    expect(alike(channel(result, 0), expected.map(({ red }) => red), 0.03)).toBeGreaterThan(0.985);
    expect(alike(channel(result, 2), expected.map(({ blue }) => blue), 0.03)).toBeGreaterThan(0.985);
    expect(alike(channel(other, 2), expected.map(({ blue }) => blue), 0.03)).toBeLessThan(0.95);
    expect(Math.max(...expected.map(({ blue }) => blue))).toBeGreaterThan(0.1);
  });
});

test("a checkerboard of iso-surfaces shows the body that a ray meets first in a cell of its own", async () => {
  const all = [turned, outward];
  const results = await second({
    places: all,
    blend: "iso",
    first: 0.02,
    second: 0.06,
    opacity: 0.4,
    isoValue: 50,
    viewFusion: "checkerboard",
    square: 7,
  });
  all.forEach((place, i) => {
    const result = results[i];
    if (result === undefined) {
      throw new Error("no picture");
    }
    const colours = { first: 0, second: 2 } as const;
    const met = partsInCells(result, place).map((parts) => parts.find((part) => part.first || part.second));
    const counts = { first: 0, second: 0, wrong: 0 };
    met.forEach((part, pixel) => {
      const light = result.pixels.slice(4 * pixel, 4 * pixel + 4);
      const shown = part === undefined ? null : part.second ? "second" : "first";
      const other = shown === "first" ? colours.second : colours.first;
      const right =
        shown === null ? light[3] === 0 : light[3] === 1 && (light[colours[shown]] ?? 0) > (light[other] ?? 0);
      counts[shown ?? "first"] += shown === null ? 0 : 1;
      counts.wrong += right ? 0 : 1;
    });
    expect(counts.wrong).toBeLessThan(0.02 * edge * edge);
    expect(counts.first).toBeGreaterThan(500);
    expect(i === 0 || counts.second > 300).toBe(true);
  });
});

test.each(["mip", "average"] as const)("in mode %s squares of the view show the one or the other", async (blend) => {
  const results = await second({
    places: [straight],
    blend,
    first: 0.02,
    second: 0.06,
    viewFusion: "checkerboard",
    square: 7,
  });
  const [result] = results;
  if (result === undefined) {
    throw new Error("no picture");
  }
  const half = Math.tan(result.camera.field / 2) * result.camera.distance;
  const share = lengths(result, straight).map((length, i) => {
    const at = (pixel: number): number => Math.floor((((pixel + 0.5) / edge) * 2 - 1) * (half / 7));
    const odd = ((at(i % edge) + at(Math.floor(i / edge))) & 1) === 1;
    return odd && length.second > 0 ? 0.5 : length.first > 0 ? 0.65 : 0;
  });
  expect(new Set(share).size).toBe(3);
  expect(alike(channel(result, 3), share, 0.01)).toBeGreaterThan(0.97);
});

test("of two that flicker one is seen, and the first where there is no second", async () => {
  const whole = { places: [straight], blend: "composite", first: 0.05, second: 0.08, viewFusion: "flicker" } as const;
  const [one] = await second({ ...whole, turn: "first" });
  const [other] = await second({ ...whole, turn: "second" });
  if (one === undefined || other === undefined) {
    throw new Error("no picture");
  }
  const expected = lengths(one, straight);
  expect(Math.max(...channel(one, 2))).toBeLessThan(0.002);
  expect(
    alike(
      channel(one, 3),
      expected.map((length) => 1 - Math.exp(-0.05 * length.first)),
      0.02,
    ),
  ).toBeGreaterThan(0.995);
  const both = expected.map((length) => 1 - Math.exp(-0.05 * (length.first - length.second) - 0.08 * length.second));
  expect(alike(channel(other, 3), both, 0.02)).toBeGreaterThan(0.995);
});
