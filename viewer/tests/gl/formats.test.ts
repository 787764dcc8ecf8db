/**
 * Each format in which a scan's values go to the GPU tells the same: all 65 536 of them, and what lies between two.
 */
import { afterAll, beforeAll, expect, test } from "vitest";
import { openGlBrowser, type GlBrowser } from "./browser";

const edge = 256;
let browser: GlBrowser;
let norm16 = false;

beforeAll(async () => {
  browser = await openGlBrowser();
  norm16 = await browser.page.evaluate(() => window.glTests?.hasNorm16() ?? false);
}, 60_000);

afterAll(async () => {
  await browser.close();
});

test.for(["r16", "rg8", "r32f"] as const)("%s holds every value, and between two voxels their mean", async (format, { skip }) => {
  skip(format === "r16" && !norm16, "this GPU has no EXT_texture_norm16");
  const read = (aside: number): Promise<number[]> =>
    browser.page.evaluate((wish) => window.glTests?.reading(wish) ?? Promise.reject(new Error("no page")), { format, aside });
  const held = await read(0);
  expect(Math.max(...held.map((value, i) => Math.abs(value - i)))).toBeLessThan(0.05);
  const between = await read(0.5);
  const off = between.map((value, i) => (i % edge === edge - 1 ? 0 : Math.abs(value - i - 0.5)));
  expect(Math.max(...off)).toBeLessThan(0.6);
});
