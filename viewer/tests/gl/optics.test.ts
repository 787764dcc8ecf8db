/**
 * Each blend mode of the real shaders against what its model says: analytic where it can be, else the
 * same rays on the CPU. Scans of 48³, pictures of 96², no jitter.
 */
import { afterAll, beforeAll, expect, test } from "vitest";
import { linearFromSrgb } from "../../src/core/base/colour";
import { biasedAt } from "../../src/core/scan/field";
import { flatShare, type Lighting } from "../../src/core/appearance/appearance";
import { blends, greyOf, shadedOptics, type GreyBlend } from "../../src/core/appearance/optics";
import { frameOf, type ScanVolume } from "../../src/core/scan/scan_volume";
import { physical } from "../../src/core/scan/stored_values";
import type { WindowLevel } from "../../src/core/appearance/window_level";
import { addScaled, dot, normalize, scale, subtract, type Vec3 } from "../../src/core/geometry/vector";
import { keyLight } from "../../src/gl/march/key_light";
import { scanOf, volumeOf } from "../support/volumes";
import { openGlBrowser, type GlBrowser } from "./browser";
import { marble } from "./marble";
import type { MarchResult, MarchTest } from "./scenes_page";
import { channel, edge, litSurface, raysOf } from "./rays";

const voxels = 48;
const spacing: Vec3 = [1, 1, 1];
const frame = frameOf(scanOf([voxels, voxels, voxels], spacing));
let browser: GlBrowser;

beforeAll(async () => {
  browser = await openGlBrowser();
});

afterAll(async () => {
  await browser.close();
});

function march(part: Partial<MarchTest> & Pick<MarchTest, "field">): Promise<MarchResult> {
  const whole: MarchTest = { spacing, from: "A", stepsPerVoxel: 2, ...part };
  return browser.page.evaluate((t) => window.glTests?.march(t) ?? Promise.reject(new Error("no page")), whole);
}

const mean = (values: readonly number[]): number => values.reduce((sum, value) => sum + value, 0) / values.length;

/** Differences as a person sees them, in sRGB. */
function seen(linear: number): number {
  const c = Math.min(1, Math.max(0, linear));
  return c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055;
}

/** The bounds of the project: a mean of 2/255, and 8/255 for 99.9 % of all. */
function expectAlike(one: readonly number[], other: readonly number[], share = 0.999): void {
  const differences = one.map((value, i) => Math.abs(value - (other[i] ?? 0)));
  const within = differences.filter((difference) => difference <= 8 / 255).length;
  expect(mean(differences)).toBeLessThan(2 / 255);
  expect(within / differences.length).toBeGreaterThanOrEqual(share);
}

// half floats, rounding of rays at the block's edges
const fine = 0.003;
const tint: Vec3 = [0.2, 0.4, 0.6];

test.each([1, 2, 4])(
  "absorption of a homogeneous block is that of its length, with %d steps a voxel",
  async (stepsPerVoxel) => {
    const result = await march({
      field: "flat",
      extinction: 0.4,
      stepsPerVoxel,
      optics: { blend: "absorption", density: 0.05 },
    });
    const expected = raysOf(result, frame).map(
      ({ span }) => 1 - Math.exp(-0.05 * 0.4 * (span === null ? 0 : span[1] - span[0])),
    );
    for (const c of [0, 1, 2, 3]) {
      // bright where much is absorbed
      expect(Math.max(...channel(result, c).map((value, i) => Math.abs(value - (expected[i] ?? 0))))).toBeLessThan(
        fine,
      );
    }
  },
);

test("emission grows with the length of the way, in the tissue's colour, and nothing hides it", async () => {
  const result = await march({ field: "flat", extinction: 0.4, optics: { blend: "emission", density: 0.05 } });
  const lengths = raysOf(result, frame).map(({ span }) => (span === null ? 0 : span[1] - span[0]));
  for (const c of [0, 1, 2] as const) {
    const errors = channel(result, c).map((value, i) => Math.abs(value - 0.05 * 0.4 * tint[c] * (lengths[i] ?? 0)));
    expect(Math.max(...errors)).toBeLessThan(fine);
  }
});

test("a composite without light is the tissue's own colour, as much as it absorbs", async () => {
  const result = await march({ field: "flat", extinction: 0.4, optics: { blend: "composite" } });
  const opacities = raysOf(result, frame).map(
    ({ span }) => 1 - Math.exp(-flatShare * 0.4 * (span === null ? 0 : span[1] - span[0])),
  );
  for (const c of [0, 1, 2] as const) {
    const errors = channel(result, c).map((value, i) => Math.abs(value - tint[c] * (opacities[i] ?? 0)));
    expect(Math.max(...errors)).toBeLessThan(fine);
  }
});

/** One value of each ray, by samples four times as dense as the shader's. */
function reference(volume: ScanVolume, result: MarchResult, optics: GreyTest): number[] {
  const { blend, slab, tissueFrom, window } = optics;
  const { camera } = result;
  return raysOf(result, frame).map(({ origin, direction, span }) => {
    const [enter, leave] = span ?? [0, 0];
    const depth = -dot(direction, camera.back);
    const values: number[] = [];
    for (let t = enter + 0.0625; t < leave; t += 0.125) {
      if (slab === null || Math.abs(t * depth - camera.distance) <= slab / 2) {
        values.push(physical(biasedAt(volume, addScaled(origin, direction, t)), frame.rescale));
      }
    }
    const isTissue = values.map((value) => value >= tissueFrom);
    const [first, last] = [isTissue.indexOf(true), isTissue.lastIndexOf(true)];
    const counted = blend === "mip" ? values : first < 0 ? [] : values.slice(first, last + 1);
    const all = { mip: Math.max(...counted), minip: Math.min(...counted), average: mean(counted) };
    return counted.length === 0 ? 0 : Math.min(1, Math.max(0, greyOf(all[blend], window)));
  });
}

interface GreyTest {
  readonly blend: GreyBlend;
  readonly tissueFrom: number;
  readonly slab: number | null;
  readonly window: WindowLevel;
}

const everything = -5000;
const wide = { window: 1400, level: 0 };

test.each([
  { blend: "mip", tissueFrom: -300, slab: null, window: wide },
  { blend: "mip", tissueFrom: -300, slab: 9, window: wide },
  { blend: "minip", tissueFrom: everything, slab: 9, window: { window: 1600, level: -400 } },
  { blend: "minip", tissueFrom: -300, slab: null, window: wide },
  { blend: "average", tissueFrom: everything, slab: null, window: wide },
  { blend: "average", tissueFrom: -300, slab: null, window: wide },
] as const)(
  "$blend of values from $tissueFrom HU, slab $slab mm, is that of the same rays on the CPU",
  async (optics) => {
    const result = await march({ field: "marble", stepsPerVoxel: 4, optics });
    const volume = volumeOf(scanOf([voxels, voxels, voxels], spacing), marble);
    const expected = reference(volume, result, optics);
    // where a ray only just has tissue, the first sample of it decides
    const grazing = optics.blend !== "mip" && optics.tissueFrom > everything ? 0.98 : 0.999;
    expectAlike(channel(result, 0).map(seen), expected, grazing);
    expect(Math.max(...expected) - Math.min(...expected)).toBeGreaterThan(0.25);
  },
);

test.each([
  { blend: "shaded", softTissue: 0.6 },
  { blend: "composite", softTissue: 0.6 },
  { blend: "absorption", softTissue: 0.4 },
  { blend: "mip", softTissue: 0 },
  { blend: "iso", softTissue: 0 },
] as const)("in mode $blend leaping over empty bricks changes no pixel", async ({ blend, softTissue }) => {
  const test = {
    field: "ball",
    softTissue,
    optics: { blend, density: 1, isoValue: 250, window: { window: 400, level: 300 } },
  } as const;
  const skipped = await march({ ...test, skip: true });
  const visited = await march({ ...test, skip: false });
  const differing = skipped.pixels.filter((value, i) => Math.abs(value - (visited.pixels[i] ?? 0)) > 2e-3);
  expect(differing.length).toBeLessThan(skipped.pixels.length / 1000);
  expect(Math.max(...channel(skipped, 3))).toBeGreaterThan(0.2);
});

test.each(["shaded", "composite", "absorption", "emission"] as const)(
  "in mode %s rays are the same with a GPU's loops and with a CPU's",
  async (blend) => {
    // tissue, where steps are quartered, around a solid segment
    const scene = {
      field: "ball",
      softTissue: 0.6,
      segment: "visible",
      optics: { blend, density: blend === "emission" ? 0.02 : 1 },
    } as const;
    const [cpu, gpu] = [await march({ ...scene, software: true }), await march({ ...scene, software: false })];
    expect(gpu.pixels).toEqual(cpu.pixels);
    expect(Math.max(...channel(cpu, 3))).toBeGreaterThan(0.2);
  },
);

test.each(blends.filter((blend) => blend !== "minip" && blend !== "average"))(
  "in mode %s the step changes cost and not look: a quarter, a half and a whole voxel agree",
  async (blend) => {
    const optics = {
      blend,
      density: blend === "emission" ? 0.02 : 1,
      isoValue: 250,
      window: { window: 1400, level: 0 },
    };
    const at = async (stepsPerVoxel: number): Promise<number[]> =>
      (await march({ field: "ball", softTissue: 0.5, stepsPerVoxel, optics })).pixels.map(seen);
    const quarter = await at(4);
    expectAlike(quarter, await at(2));
    expectAlike(quarter, await at(1));
    expect(Math.max(...quarter)).toBeGreaterThan(0.3);
  },
);

// steps of four voxels: there the mean between two samples is far from the value between them
test.each(["shaded", "composite", "absorption"] as const)(
  "in mode %s a scan whose values fall as the stored ones rise is drawn the same",
  async (blend) => {
    const at = async (slope: number): Promise<number[]> =>
      (await march({ field: "ball", softTissue: 0.5, stepsPerVoxel: 0.25, slope, optics: { blend } })).pixels.map(seen);
    const usual = await at(1);
    expectAlike(await at(-1), usual);
    expect(Math.max(...usual)).toBeGreaterThan(0.3);
  },
);

test("an iso-surface is the analytic picture of a lit sphere", async () => {
  // the field falls by 400 per mm from the middle: 0 at 14 mm
  const result = await march({ field: "ball", extinction: 1, optics: { blend: "iso", isoValue: 0 } });
  const centre: Vec3 = [24, 24, 24];
  const light = keyLight(result.camera);
  const expected: number[] = [];
  const drawn: number[] = [];
  raysOf(result, frame).forEach(({ origin, direction }, i) => {
    const to = subtract(centre, origin);
    const along = dot(to, direction);
    const off = Math.sqrt(Math.max(0, dot(to, to) - along * along));
    // the outline is a pixel of its own
    if (off > 14 || off < 13.5) {
      const hit = addScaled(origin, direction, along - Math.sqrt(Math.max(0, 14 ** 2 - off ** 2)));
      const normal = normalize(subtract(hit, centre));
      const lit = litSurface(tint, normal, scale(direction, -1), result.camera.up, light);
      const pixel = off < 14 ? [...lit, 1] : off > 14.5 ? [0, 0, 0, 0] : [];
      expected.push(...pixel.map(seen));
      drawn.push(...(pixel.length === 0 ? [] : result.pixels.slice(4 * i, 4 * i + 4).map(seen)));
    }
  });
  expect(expected.filter((value) => value > 0.999).length).toBeGreaterThan(1000);
  expectAlike(drawn, expected, 0.995);
});

test("a tinted segment is tissue in its colour, as opaque as it is without", async () => {
  const test = { field: "ball", softTissue: 0.3, optics: { blend: "composite" } } as const;
  const plain = await march(test);
  const tinted = await march({ ...test, segment: "tinted" });
  const solid = await march({ ...test, segment: "visible" });
  const opacity = (result: MarchResult): number => mean(channel(result, 3));
  expect(opacity(tinted)).toBeCloseTo(opacity(plain), 3);
  expect(opacity(solid)).toBeGreaterThanOrEqual(opacity(plain));
  // its colour is green
  const green = (result: MarchResult): number => mean(channel(result, 1)) - mean(channel(result, 0));
  expect(green(plain)).toBeLessThan(0);
  expect(green(tinted)).toBeGreaterThan(0.05);
});

test("light is the sum of its parts, and boundaries are as strong as they are asked for", async () => {
  const test = { field: "ball", softTissue: 0.5 } as const;
  const none = { ambient: 0, diffuse: 0, specular: 0 };
  const lit = async (lighting: Partial<Lighting>): Promise<number[]> => channel(await march({ ...test, lighting }), 1);
  const all = await lit({});
  const parts = [
    await lit({ ...none, ambient: 1 }),
    await lit({ ...none, diffuse: 1 }),
    await lit({ ...none, specular: 1 }),
  ];
  expect(Math.max(...(await lit(none)))).toBeLessThan(1e-3);
  // half floats of up to 2
  all.forEach((value, i) => {
    expect(Math.abs(value - parts.reduce((sum, part) => sum + (part[i] ?? 0), 0))).toBeLessThan(0.005);
  });
  const sharp = await lit({ ...none, specular: 1, shininess: 4 });
  expect(mean(sharp)).toBeLessThan(0.7 * mean(parts[2] ?? []));
  const opacity = async (edges: number): Promise<number> =>
    mean(channel(await march({ ...test, field: "flat", extinction: 0.02, lighting: { edges } }), 3));
  expect(await opacity(0)).toBeGreaterThan(5 * (await opacity(0.94)));
});

test.each([
  { field: "ball", segment: "visible" },
  { field: "ball", segment: "tinted" },
  { field: "label" },
] as const)("a segment's own light is that of a picture which is lit so: $field $segment", async (scene) => {
  const seen = { ...scene, softTissue: 0 };
  const own = await march({ ...seen, material: [0.5, 0] });
  const all = await march({ ...seen, lighting: { ambient: 0.5, specular: 0 } });
  const plain = await march(seen);
  own.pixels.forEach((value, i) => {
    expect(Math.abs(value - (all.pixels[i] ?? 0))).toBeLessThan(0.002);
  });
  expect(mean(channel(plain, 0)) + mean(channel(plain, 1))).toBeGreaterThan(
    1.1 * (mean(channel(own, 0)) + mean(channel(own, 1))),
  );
});

test("a slab shows what is inside of it and nothing else", async () => {
  const optics = { blend: "mip", window: { window: 400, level: 300 } } as const;
  const whole = await march({ field: "ball", optics });
  const cut = await march({ field: "ball", optics: { ...optics, slab: 4 } });
  const middle = 4 * (edge / 2 + edge * (edge / 2));
  expect(whole.pixels[middle + 3]).toBe(1);
  expect(cut.pixels[middle + 3]).toBe(1);
  // seen from the front the slab holds the ball's middle: all of its outline, and no more
  const covered = (result: MarchResult): number => channel(result, 3).filter((alpha) => alpha > 0.5).length;
  expect(Math.abs(covered(cut) - covered(whole))).toBeLessThan(0.05 * covered(whole));
  const thin = await march({ field: "flat", extinction: 0.4, optics: { blend: "absorption", density: 0.05, slab: 4 } });
  expect(thin.pixels[middle + 3]).toBeCloseTo(1 - Math.exp(-0.05 * 0.4 * 4), 2);
});

test("grey is what the window says, on the screen as in the reference", () => {
  expect(greyOf(-160, shadedOptics.window)).toBe(0);
  expect(greyOf(240, shadedOptics.window)).toBe(1);
  expect(linearFromSrgb([greyOf(40, shadedOptics.window), 0, 1])[0]).toBeCloseTo(0.214, 3);
});
