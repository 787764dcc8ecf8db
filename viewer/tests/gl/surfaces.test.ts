/**
 * Surfaces of segments in a real browser, with the real shaders: balls in patches, over and
 * inside a scan of 48³ mm, seen from before on 96² pixels.
 */
import { afterAll, beforeAll, expect, test } from "vitest";
import { extentOf, lookFrom, project } from "../../src/core/camera";
import { distance, type Vec3 } from "../../src/core/vector";
import { openGlBrowser, type GlBrowser } from "./browser";
import type { MarchTest, ScreenTest, SurfaceTest } from "./page";

const edge = 96;
const viewport = { width: edge, height: edge };
let browser: GlBrowser;

beforeAll(async () => {
  browser = await openGlBrowser();
}, 60_000);

afterAll(async () => {
  await browser.close();
});

function show(what: ScreenTest): Promise<number[]> {
  return browser.page.evaluate((t) => window.glTests?.show(t) ?? Promise.reject(new Error("no page")), what);
}

/** Pixel of a picture; y counts from the top. */
function pixelAt(pixels: readonly number[], x: number, y: number): readonly [number, number, number] {
  const i = 4 * (x + edge * (edge - 1 - y));
  return [pixels[i] ?? 0, pixels[i + 1] ?? 0, pixels[i + 2] ?? 0];
}

const air: MarchTest = { field: "flat", spacing: [1, 1, 1], from: "A", stepsPerVoxel: 1, extinction: 0 };
const middle: Vec3 = [24, 24, 24];
const red: SurfaceTest = { centre: middle, radius: 12, sectors: 4, look: { colour: [1, 0, 0] } };

const camera = lookFrom("A", extentOf([0, 1, 2, 3, 4, 5, 6, 7].map((i) => [i & 1 ? 48 : 0, i & 2 ? 48 : 0, i & 4 ? 48 : 0])), viewport);

/** Radius of a ball's outline [pixels]: the cone around it is a little wider than its middle. */
function outlineRadius(radius: number): number {
  const away = distance(camera.target, middle) + camera.distance;
  const [right = 0] = project(camera, [24 + radius / Math.sqrt(1 - (radius / away) ** 2), 24, 24], viewport) ?? [];
  return right - edge / 2;
}

const isRed = ([r, g, b]: readonly [number, number, number]): boolean => r > 1.6 * g && r > 1.6 * b && r > 40;

test("a ball of patches is a red disc of the right size, without holes", async () => {
  const pixels = await show({ scan: air, surfaces: [red] });
  for (let y = 0; y < edge; ++y) {
    for (let x = 0; x < edge; ++x) {
      const away = Math.hypot(x + 0.5 - edge / 2, y + 0.5 - edge / 2) - outlineRadius(12);
      // facets of 64 columns lie up to 0.1 % inside of the ball
      if (Math.abs(away) > 1) {
        expect([x, y, isRed(pixelAt(pixels, x, y))]).toEqual([x, y, away < 0]);
      }
    }
  }
});
