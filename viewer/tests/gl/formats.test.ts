/**
 * Each format in which a scan's values go to the GPU tells the same: all 65 536 of them, and what lies between two.
 * Chromium's own software GL has no 16-bit textures; Mesa's has them.
 */
import { afterAll, beforeAll, expect, test } from "vitest";
import { openGlBrowser, type GlBrowser } from "./browser";
import type { MarchTest } from "./scenes_page";

const edge = 256;
const renderers = { chromium: [], mesa: ["--use-angle=gl-egl", "--ignore-gpu-blocklist"] } as const;
const browsers = new Map<keyof typeof renderers, GlBrowser>();

beforeAll(async () => {
  browsers.set("chromium", await openGlBrowser());
  browsers.set("mesa", await openGlBrowser(renderers.mesa));
});

afterAll(async () => {
  await Promise.all([...browsers.values()].map((browser) => browser.close()));
});

function pageOf(renderer: keyof typeof renderers): GlBrowser["page"] {
  const browser = browsers.get(renderer);
  if (browser === undefined) {
    throw new Error(`no browser on ${renderer}'s software GL`);
  }
  return browser.page;
}

const all = [["chromium", "rg8"], ["chromium", "r32f"], ["mesa", "r16"], ["mesa", "rg8"], ["mesa", "r32f"]] as const;

test.each(all)("on %s's GL %s holds every value, and between two voxels their mean", async (renderer, format) => {
  const read = (aside: number): Promise<number[]> =>
    pageOf(renderer).evaluate((wish) => window.glTests?.reading(wish) ?? Promise.reject(new Error("no page")), {
      format,
      aside,
    });
  const held = await read(0);
  expect(Math.max(...held.map((value, i) => Math.abs(value - i)))).toBeLessThan(0.05);
  const between = await read(0.5);
  const off = between.map((value, i) => (i % edge === edge - 1 ? 0 : Math.abs(value - i - 0.5)));
  expect(Math.max(...off)).toBeLessThan(0.6);
});

test("a page takes 16-bit textures where the GPU has them, else bytes", async () => {
  const usual = (renderer: keyof typeof renderers): Promise<string> =>
    pageOf(renderer).evaluate(() => window.glTests?.usualFormat() ?? "no WebGL2");
  expect([await usual("mesa"), await usual("chromium")]).toEqual(["r16", "rg8"]);
});

// not by bytes, for which there is no need there: Mesa on a CPU rounds to 8 bits between texels of 8 bits
test.each(["r16", "r32f"] as const)("on Mesa's GL a picture by %s is that of bytes on Chromium's", async (format) => {
  const scan: MarchTest = { field: "marble", spacing: [1, 1, 1], from: "A", stepsPerVoxel: 2, softTissue: 0.5 };
  const draw = async (renderer: keyof typeof renderers, by: MarchTest): Promise<readonly number[]> => {
    const drawn = await pageOf(renderer).evaluate(
      (t) => window.glTests?.march(t) ?? Promise.reject(new Error("no page")),
      by,
    );
    return drawn.pixels;
  };
  const [one, other] = [await draw("mesa", { ...scan, format }), await draw("chromium", { ...scan, format: "rg8" })];
  const off = one.map((value, i) => Math.abs(value - (other[i] ?? 0)));
  // the bounds of the project for two ways of drawing the same
  expect(off.reduce((sum, difference) => sum + difference, 0) / off.length).toBeLessThan(2 / 255);
  expect(off.filter((difference) => difference <= 8 / 255).length / off.length).toBeGreaterThanOrEqual(0.999);
  expect(Math.max(...other)).toBeGreaterThan(0.2);
});
