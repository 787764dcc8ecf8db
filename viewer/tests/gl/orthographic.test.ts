/**
 * The orthographic projection in a real browser with the real shaders, against its geometry. Scans of
 * 48³ mm whose ball has its middle at 24 mm and a radius of 14 mm; pictures of 96², no jitter.
 */
import { afterAll, beforeAll, expect, test } from "vitest";
import { pixelSizeAt } from "../../src/core/geometry/camera";
import { frameOf } from "../../src/core/scan/scan_volume";
import { dot, length, subtract, type Vec3 } from "../../src/core/geometry/vector";
import { scanOf } from "../support/volumes";
import { openGlBrowser, type GlBrowser } from "./browser";
import type { MarchResult, MarchTest } from "./scenes_page";
import type { ScreenTest, SurfaceTest } from "./screen_page";
import { channel, edge, raysOf } from "./rays";

const frame = frameOf(scanOf([48, 48, 48], [1, 1, 1]));
const middle: Vec3 = [24, 24, 24];
let browser: GlBrowser;

beforeAll(async () => {
  browser = await openGlBrowser();
});

afterAll(async () => {
  await browser.close();
});

function march(part: Partial<MarchTest> & Pick<MarchTest, "field">): Promise<MarchResult> {
  const whole: MarchTest = { spacing: [1, 1, 1], from: "A", orthographic: true, stepsPerVoxel: 2, ...part };
  return browser.page.evaluate((t) => window.glTests?.march(t) ?? Promise.reject(new Error("no page")), whole);
}

function show(what: ScreenTest): Promise<number[]> {
  return browser.page.evaluate((t) => window.glTests?.show(t) ?? Promise.reject(new Error("no page")), what);
}

test("a block that is seen along its edges is as opaque everywhere, and as large as it is", async () => {
  const result = await march({ field: "flat", extinction: 0.4, optics: { blend: "absorption", density: 0.05 } });
  const alpha = channel(result, 3);
  const inside = alpha.filter((value) => value > 1e-3);
  // half floats
  expect(Math.max(...inside.map((value) => Math.abs(value - (1 - Math.exp(-0.02 * 48)))))).toBeLessThan(0.001);
  const pixel = pixelSizeAt(result.camera, middle, { width: edge, height: edge });
  expect(Math.abs(Math.sqrt(inside.length) * pixel - 48)).toBeLessThan(1.5 * pixel);
});

test("a slab is one of depth, also without perspective", async () => {
  const slab = await march({
    field: "flat",
    extinction: 0.4,
    optics: { blend: "absorption", density: 0.05, slab: 10 },
  });
  expect(Math.max(...channel(slab, 3))).toBeCloseTo(1 - Math.exp(-0.02 * 10), 2);
});

/** How far each pixel's ray passes by the middle [mm], rows from the bottom. */
function passes(result: MarchResult): number[] {
  return raysOf(result, frame).map(({ origin, direction }) => {
    const to = subtract(middle, origin);
    return Math.sqrt(Math.max(0, length(to) ** 2 - dot(to, direction) ** 2));
  });
}

test("scan and surface of one ball have the same outline, that of the ball", async () => {
  const solid = await march({ field: "ball", segment: "visible" });
  const air = {
    field: "flat",
    spacing: [1, 1, 1],
    from: "A",
    orthographic: true,
    stepsPerVoxel: 1,
    extinction: 0,
  } as const;
  const surface = await show({
    scan: air,
    surfaces: [{ centre: middle, radius: 14, sectors: 4, appearance: { colour: [1, 0, 0] } }],
  });
  passes(solid).forEach((away, i) => {
    if (Math.abs(away - 14) > 0.7) {
      const [r = 0, g = 0] = surface.slice(4 * i, 4 * i + 2);
      expect([i, solid.pixels[4 * i + 3] === 1, r > 1.6 * g]).toEqual([i, away < 14, away < 14]);
    }
  });
});

test("of a surface and the scan the nearer one is seen", async () => {
  const green = {
    field: "ball",
    spacing: [1, 1, 1],
    from: "A",
    orthographic: true,
    stepsPerVoxel: 2,
    segment: "visible",
  } as const;
  const dotAt = (y: number): SurfaceTest => ({
    centre: [24, y, 24],
    radius: 4,
    sectors: 4,
    appearance: { colour: [1, 0, 0] },
  });
  const centre = 4 * (edge / 2 + edge * (edge / 2));
  const middleOf = async (y: number): Promise<readonly number[]> =>
    (await show({ scan: green, surfaces: [dotAt(y)] })).slice(centre, centre + 2);
  // the scan's ball begins at 10 mm
  const [before, behind] = [await middleOf(8), await middleOf(24)];
  expect(before[0]).toBeGreaterThan(1.6 * (before[1] ?? 0));
  expect(behind[1]).toBeGreaterThan(1.6 * (behind[0] ?? 0));
});
