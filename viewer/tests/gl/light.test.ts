/**
 * The light volume of the real shaders against what light does: nothing in emptiness, Beer and Lambert
 * behind a slab, half of the sky before a wall. Scans of 48³ voxels of 1 mm, cells of 1.5 mm.
 */
import { afterAll, beforeAll, expect, test } from "vitest";
import type { Vec3 } from "../../src/core/geometry/vector";
import type { Box } from "../../src/core/scan/voxel_change";
import { openGlBrowser, type GlBrowser } from "./browser";
import type { LightResult, LightTest } from "./light_page";

let browser: GlBrowser;

beforeAll(async () => {
  browser = await openGlBrowser();
});

afterAll(async () => {
  await browser.close();
});

function light(test: LightTest): Promise<LightResult> {
  return browser.page.evaluate((t) => window.glTests?.light(t) ?? Promise.reject(new Error("no page")), test);
}

const most = 48;
const edge = 1.5;
const box = (low: Vec3, high: Vec3): Box => ({ low, high });

/** The number of the cell around a point [mm]. */
function cellAt({ counts }: LightResult, point: Vec3): number {
  const [x = 0, y = 0, z = 0] = point.map((place) => Math.floor(place / edge));
  return x + counts[0] * (y + counts[1] * z);
}

const slab = box([0, 0, 32], [most, most, 38]);

test("through emptiness all of the light comes everywhere", async () => {
  const { counts, sky, key } = await light({ dense: [], extinction: 1 });
  expect(counts).toEqual([32, 32, 32]);
  expect(Math.min(...sky)).toBe(1);
  expect(Math.min(...key)).toBe(1);
});

test("a slab shades what is below it by Beer and Lambert, and nothing above it", async () => {
  const extinction = 0.08;
  const result = await light({ dense: [slab], extinction });
  const { keyDirection, key } = result;
  const expected = Math.exp((-extinction * 6) / keyDirection[2]);
  expect(expected).toBeGreaterThan(0.2);
  expect(expected).toBeLessThan(0.6);
  // from here the lamp is seen through the slab and not past it
  for (const start of [[30, 40, 20], [24, 42, 26], [40, 44, 14]] as const) {
    const rise = (38 - start[2]) / keyDirection[2];
    const leaves = start.map((place, axis) => place + rise * (keyDirection[axis as 0 | 1 | 2]));
    expect(leaves.every((place) => place > 0 && place < most)).toBe(true);
    expect(Math.abs((key[cellAt(result, start)] ?? 0) - expected)).toBeLessThan(0.02);
  }
  expect(key[cellAt(result, [24, 24, 44])]).toBe(1);
});

test("before an opaque wall the sky is whole, in a corner half, and within nothing", async () => {
  const wall = box([0, 0, 0], [most, most, 12]);
  const other = box([0, 0, 0], [12, most, most]);
  const flat = await light({ dense: [wall], extinction: 9 });
  const corner = await light({ dense: [wall, other], extinction: 9 });
  // two cells away, where a surface looks its light up
  expect(flat.sky[cellAt(flat, [24, 24, 14.9])]).toBeGreaterThan(0.9);
  const inCorner = corner.sky[cellAt(corner, [14.9, 24, 14.9])] ?? 0;
  expect(inCorner).toBeGreaterThan(0.45);
  expect(inCorner).toBeLessThan(0.75);
  expect(flat.sky[cellAt(flat, [24, 24, 3])]).toBeLessThan(0.02);
});

test("an edit lets light in again, and only the layers around it are looked at again", async () => {
  const whole = await light({ dense: [slab], extinction: 9 });
  const opened = await light({ dense: [slab], extinction: 9, removed: slab });
  const at = cellAt(whole, [30, 40, 20]);
  expect(whole.key[at]).toBeLessThan(0.02);
  expect(Math.min(...opened.key)).toBe(1);
  expect(Math.min(...opened.sky)).toBe(1);
  // all 32 layers of light, and those of opacity that the slab reaches: 30 to 40 mm
  expect(opened.layersAfterEdit).toBe(32 + 7);
});

test("what is cut away shades nothing, and what the value encloses shades in the mode of the iso-surface", async () => {
  const above = { normal: [0, 0, 1] as const, offset: 30 };
  const cut = await light({ dense: [slab], extinction: 9, clip: [above] });
  expect(Math.min(...cut.key)).toBe(1);
  const iso = await light({ dense: [slab], extinction: 0.001, blend: "iso" });
  expect(iso.key[cellAt(iso, [30, 40, 20])]).toBeLessThan(0.02);
});

test("nothing is worked out where nothing of it is seen", async () => {
  const { sky } = await light({ dense: [slab], extinction: 1, lighting: { occlusion: 0, shadow: 0 } });
  expect(sky).toHaveLength(0);
  const grey = await light({ dense: [slab], extinction: 1, blend: "mip" });
  expect(grey.sky).toHaveLength(0);
});
