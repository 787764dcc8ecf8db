/**
 * Each format in which a scan's values go to the GPU tells the same: all 65 536 of them, and what lies between two;
 * and where a GPU does not filter it well enough it is not taken. Chromium's own software GL has no 16-bit textures;
 * Mesa's has them, but rounds to bytes what lies between texels of bytes.
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

const all = [
  ...(["rg8", "r32f", "texels"] as const).map((format) => ["chromium", format] as const),
  ...(["r16", "r32f", "texels"] as const).map((format) => ["mesa", format] as const),
];

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
  expect(Math.max(...off)).toBeLessThan(0.05);
});

test.each(all)("on %s's GL %s is found to be exact between voxels along all axes", async (renderer, format) => {
  const error = await pageOf(renderer).evaluate((wish) => window.glTests?.errorOf(wish) ?? NaN, format);
  expect(error).toBeLessThan(0.05);
});

const norm16 = "EXT_texture_norm16";
const floatLinear = "OES_texture_float_linear";
const choices = [
  ["chromium", [], "rg8", ["rg8"]],
  ["mesa", [], "r16", ["r16"]],
  // as in Firefox, which has no 16-bit textures
  ["mesa", [norm16], "r32f", ["rg8", "r32f"]],
  ["mesa", [norm16, floatLinear], "texels", ["rg8"]],
] as const;

test.each(choices)("on %s's GL without %s a page takes %s", async (renderer, without, format, tried) => {
  const filter = await pageOf(renderer).evaluate(
    (wish) => window.glTests?.usualFilter(wish) ?? Promise.reject(new Error("no page")),
    without,
  );
  expect([filter.format, Object.keys(filter.errors)]).toEqual([format, tried]);
  if (renderer === "mesa" && "rg8" in filter.errors) {
    // half of a high byte, or more where several roundings add up
    expect(filter.errors.rg8).toBeGreaterThan(100);
  }
});

const onMesa = ["r16", "r32f", "texels"] as const;

test.each(onMesa)("on Mesa's GL a picture by %s is that of bytes on Chromium's", async (format) => {
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

test("a second scan that the shader filters is that of bytes", async () => {
  const turned = [0.8, -0.6, 0, 6, 0.6, 0.8, 0, -24, 0, 0, 1, -10];
  const draw = (format: "rg8" | "texels"): Promise<readonly number[]> =>
    pageOf("chromium").evaluate(
      (t) => window.glTests?.second(t)[0]?.pixels ?? Promise.reject(new Error("no page")),
      { places: [turned], blend: "shaded", first: 0.02, second: 0.2, half: true, format } as const,
    );
  const [one, other] = [await draw("texels"), await draw("rg8")];
  expect(Math.max(...one.map((value, i) => Math.abs(value - (other[i] ?? 0))))).toBeLessThan(2 / 255);
  expect(Math.max(...other)).toBeGreaterThan(0.2);
});
