/**
 * Two eyes in a real browser, with the real shaders: scan, surfaces and probe have the parallax of their
 * depth, and the anaglyph is mixed as its source says. 96² pixels, no jitter.
 */
import { afterAll, beforeAll, expect, test } from "vitest";
import { extentOf, lookFrom, project } from "../../src/core/geometry/camera";
import { eyeCamera, eyesOf, firstStereo, viewportOf, type Stereo } from "../../src/core/view/stereo";
import { addScaled, type Vec3 } from "../../src/core/geometry/vector";
import { openGlBrowser, type GlBrowser } from "./browser";
import type { MarchTest } from "./scenes_page";
import type { ScreenTest } from "./screen_page";

const edge = 96;
const pane = { width: edge, height: edge };
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

type Colour = readonly [number, number, number];
const middle: Vec3 = [24, 24, 24];
const air: MarchTest = { field: "flat", spacing: [1, 1, 1], from: "A", stepsPerVoxel: 1, extinction: 0 };
const front = lookFrom(
  "A",
  extentOf([0, 1, 2, 3, 4, 5, 6, 7].map((i) => [i & 1 ? 48 : 0, i & 2 ? 48 : 0, i & 4 ? 48 : 0])),
  pane,
);

/** Each shows one thing in the middle of the scan. */
const things: readonly (readonly [string, ScreenTest, (colour: Colour) => boolean])[] = [
  [
    "the scan",
    { scan: { field: "ball", spacing: [1, 1, 1], from: "A", stepsPerVoxel: 2, segment: "visible", softTissue: 0 } },
    ([r, g]) => g > 40 && g > 1.6 * r,
  ],
  [
    "a surface",
    { scan: air, surfaces: [{ centre: middle, radius: 8, sectors: 4, appearance: { colour: [1, 0, 0] } }] },
    ([r, g]) => r > 40 && r > 1.6 * g,
  ],
  ["the probe", { scan: air, markers: { probe: middle, device: middle } }, ([r, , b]) => b > 120 && b > 1.3 * r],
];

/** Middle of what has a colour, in each part of the picture that an eye has [pixels of the eye's view]. */
function middles(pixels: readonly number[], stereo: Stereo, isThing: (colour: Colour) => boolean): number[][] {
  const seen = viewportOf(stereo, pane);
  return eyesOf(stereo, pane).map(({ rect }) => {
    let [x, y, count] = [0, 0, 0];
    for (let row = 0; row < rect.height; ++row) {
      for (let column = 0; column < rect.width; ++column) {
        const i = 4 * (rect.x + column + edge * (edge - 1 - rect.y - row));
        if (isThing([pixels[i] ?? 0, pixels[i + 1] ?? 0, pixels[i + 2] ?? 0])) {
          [x, y, count] = [x + column + 0.5, y + row + 0.5, count + 1];
        }
      }
    }
    expect(count).toBeGreaterThan(10);
    return [(x / count) * (seen.width / rect.width), (y / count) * (seen.height / rect.height)];
  });
}

const ways: readonly (readonly [string, Stereo])[] = [
  ["side by side", { ...firstStereo, mode: "side", squeezed: true, separation: 0.2 }],
  ["top-bottom", { ...firstStereo, mode: "stacked", separation: 0.2 }],
];

test.each(ways.flatMap(([way, stereo]) => things.map(([what, ...thing]) => [way, what, stereo, ...thing] as const)))(
  "%s: the parallax of %s",
  async (_way, _what, stereo, scene, isThing) => {
    // in the plane of the screen, before it, and behind it
    for (const before of stereo.mode === "side" ? [0, 20, -20] : [20]) {
      const view = {
        ...front,
        target: addScaled(front.target, front.back, -before),
        distance: front.distance + before,
      };
      const pixels = await show({ ...scene, stereo, behind: before });
      const found = middles(pixels, stereo, isThing);
      const expected = eyesOf(stereo, pane).map(
        ({ aside }) => project(eyeCamera(view, aside), middle, viewportOf(stereo, pane)) ?? [],
      );
      found.forEach(([x = NaN, y = NaN], eye) => {
        expect(Math.abs(x - (expected[eye]?.[0] ?? NaN))).toBeLessThan(0.8);
        expect(Math.abs(y - (expected[eye]?.[1] ?? NaN))).toBeLessThan(0.8);
      });
      const parallax = (found[1]?.[0] ?? NaN) - (found[0]?.[0] ?? NaN);
      if (before === 0) {
        expect(Math.abs(parallax)).toBeLessThan(0.6);
      } else {
        // crossed before the screen
        expect(Math.sign(parallax)).toBe(-Math.sign(before));
        expect(Math.abs(parallax)).toBeGreaterThan(2);
      }
    }
  },
);

const linear = (byte: number): number =>
  byte / 255 <= 0.04045 ? byte / 255 / 12.92 : ((byte / 255 + 0.055) / 1.055) ** 2.4;
const coded = (light: number): number =>
  255 * (light <= 0.0031308 ? 12.92 * light : 1.055 * light ** (1 / 2.4) - 0.055);
// Dubois (2009), rows: red, green and blue of the anaglyph
const fromLeft = [[0.437, 0.449, 0.164], [-0.062, -0.062, -0.024], [-0.048, -0.05, -0.017]] as const;
const fromRight = [[-0.011, -0.032, -0.007], [0.377, 0.761, 0.009], [-0.026, -0.093, 1.234]] as const;

function mixed(colour: Colour): readonly number[] {
  const [r, g, b] = [linear(colour[0]), linear(colour[1]), linear(colour[2])];
  const share = (row: readonly number[] | undefined): number =>
    Math.min(1, Math.max(0, (row?.[0] ?? 0) * r + (row?.[1] ?? 0) * g + (row?.[2] ?? 0) * b));
  return [0, 1, 2].map((c) => coded(Math.min(1, share(fromLeft[c]) + share(fromRight[c]))));
}

test("an anaglyph of two equal pictures has their colours as least squares mix them", async () => {
  const scene: ScreenTest = {
    scan: { ...air, field: "ball", extinction: 0.3 },
    markers: { probe: middle, device: [30, 20, 24] },
  };
  const plain = await show(scene);
  const anaglyph = await show({ ...scene, stereo: { ...firstStereo, mode: "anaglyph", separation: 0 } });
  let most = 0;
  for (let i = 0; i < plain.length; i += 4) {
    const expected = mixed([plain[i] ?? 0, plain[i + 1] ?? 0, plain[i + 2] ?? 0]);
    // edges of markers are smoothed where there is one picture only
    const off = Math.max(...expected.map((value, c) => Math.abs(value - (anaglyph[i + c] ?? 0))));
    most = Math.max(most, off);
  }
  expect(most).toBeLessThan(2.5);
});

test("in an anaglyph the left eye's red stands at the right of what is before the screen", async () => {
  const scene: ScreenTest = {
    scan: air,
    surfaces: [{ centre: middle, radius: 8, sectors: 4, appearance: { colour: [1, 1, 1] } }],
  };
  const redness = async (behind: number): Promise<number> => {
    const pixels = await show({ ...scene, stereo: { ...firstStereo, mode: "anaglyph", separation: 0.2 }, behind });
    const row = edge / 2;
    let [sum, weight] = [0, 0];
    for (let x = 0; x < edge; ++x) {
      const i = 4 * (x + edge * row);
      const red = (pixels[i] ?? 0) - ((pixels[i + 1] ?? 0) + (pixels[i + 2] ?? 0)) / 2;
      [sum, weight] = [sum + red * (x + 0.5 - edge / 2), weight + Math.abs(red)];
    }
    return sum / weight;
  };
  expect(await redness(20)).toBeGreaterThan(1);
  expect(await redness(-20)).toBeLessThan(-1);
});

test("both eyes see the scan after the view was resized before either had drawn it", async () => {
  const [[, { scan }, isGreen]] = things as [(typeof things)[number]];
  const eyes = await browser.page.evaluate(
    (t) => window.glTests?.resizedEyes(t) ?? Promise.reject(new Error("no page")),
    { scan },
  );
  expect(eyes.map(([r = 0, g = 0, b = 0]) => isGreen([r, g, b]))).toEqual([true, true]);
});
