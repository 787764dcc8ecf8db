/**
 * The real shaders in a real browser, on scans of 48³ and pictures of 96²: physics first.
 */
import { afterAll, beforeAll, expect, test } from "vitest";
import { transformPoint, transformVector } from "../../src/core/geometry/affine";
import { project, rayThrough } from "../../src/core/geometry/camera";
import { srgbFromHex } from "../../src/core/base/colour";
import { flatShare } from "../../src/core/appearance/appearance";
import { throughBox } from "../../src/core/picking/pick_surface";
import { qualities, restingPictures } from "../../src/core/view/quality";
import { frameOf } from "../../src/core/scan/scan_volume";
import { distance, type Vec3 } from "../../src/core/geometry/vector";
import { scanOf } from "../support/volumes";
import { openGlBrowser, type GlBrowser } from "./browser";
import type { MarchResult, MarchTest } from "./scenes_page";
import type { MarkerTest } from "./screen_page";

const edge = 96;
const voxels = 48;
let browser: GlBrowser;

beforeAll(async () => {
  browser = await openGlBrowser();
});

afterAll(async () => {
  await browser.close();
});

function march(test: MarchTest): Promise<MarchResult> {
  return browser.page.evaluate((t) => window.glTests?.march(t) ?? Promise.reject(new Error("no page")), test);
}

function screen(test: MarchTest, markers: MarkerTest | null, jitter = false): Promise<number[]> {
  return browser.page.evaluate(
    ([t, m, j]) => window.glTests?.screen(t, m, j) ?? Promise.reject(new Error("no page")),
    [test, markers, jitter] as const,
  );
}

/** Pixel of a picture; y counts from the top. */
function pixelAt(pixels: readonly number[], x: number, y: number): readonly number[] {
  const i = 4 * (x + edge * (edge - 1 - y));
  return pixels.slice(i, i + 4);
}

function alphas({ pixels }: MarchResult): number[] {
  return pixels.filter((_, i) => i % 4 === 3);
}

const mean = (values: readonly number[]): number => values.reduce((sum, value) => sum + value, 0) / values.length;

const flat: MarchTest = { field: "flat", spacing: [1, 1, 1], from: "A", stepsPerVoxel: 2, extinction: 0.4 };
const ball: MarchTest = { field: "ball", spacing: [1, 1, 1], from: "A", stepsPerVoxel: 2 };

test.each([
  { spacing: [1, 1, 1], from: "A", stepsPerVoxel: 1 },
  { spacing: [1, 1, 1], from: "A", stepsPerVoxel: 4 },
  { spacing: [0.7, 0.9, 2.5], from: "L", stepsPerVoxel: 2 },
  { spacing: [0.7, 0.9, 2.5], from: "S", stepsPerVoxel: 2 },
] as const)(
  "a homogeneous block absorbs as Beer and Lambert say: $spacing, from $from, $stepsPerVoxel steps",
  async (part) => {
    const result = await march({ ...flat, ...part });
    const frame = frameOf(scanOf([voxels, voxels, voxels], part.spacing));
    const extinction = 0.4 * flatShare;
    const stepLength = Math.min(...part.spacing) / part.stepsPerVoxel;
    const errors: number[] = [];
    for (let y = 0; y < edge; ++y) {
      for (let x = 0; x < edge; ++x) {
        const ray = rayThrough(result.camera, x + 0.5, y + 0.5, { width: edge, height: edge });
        const origin = transformPoint(frame.gridFromScene, ray.origin);
        const span = throughBox(origin, transformVector(frame.gridFromScene, ray.direction), frame.dimensions);
        const path = span === null ? 0 : span[1] - span[0];
        const expected = 1 - Math.exp(-extinction * path);
        errors.push(Math.abs((pixelAt(result.pixels, x, y)[3] ?? 0) - expected));
      }
    }
    // a ray of whole steps is up to half a step longer or shorter than the block at its far
    // end; half floats add 0.0005
    expect(Math.max(...errors)).toBeLessThan(0.5 * extinction * stepLength + 0.002);
  },
);

test("early termination leaves no ray more than opaque", async () => {
  const result = await march({ ...flat, extinction: 50 });
  const inside = pixelAt(result.pixels, edge / 2, edge / 2);
  expect(inside[3]).toBe(1);
});

test("the bytes of RG8 and 32-bit floats give the same picture", async () => {
  const [bytes, floats] = [
    await march({ ...ball, softTissue: 0.5, format: "rg8" }),
    await march({ ...ball, softTissue: 0.5, format: "r32f" }),
  ];
  const differences = bytes.pixels.map((value, i) => Math.abs(value - (floats.pixels[i] ?? 0)));
  // filtering of bytes has 8 bits of position: 2/255 was measured as the largest error
  expect(mean(differences)).toBeLessThan(0.5 / 255);
  expect(differences.filter((difference) => difference > 4 / 255).length).toBeLessThan(differences.length / 1000);
});

test.each([0.3, 0.6, 0.9])("leaping over empty bricks changes no pixel, soft tissue %d", async (softTissue) => {
  const skipped = await march({ ...ball, softTissue, skip: true });
  const visited = await march({ ...ball, softTissue, skip: false });
  // the same sums in the same order, up to the rounding of a leap's length
  const differing = skipped.pixels.filter((value, i) => Math.abs(value - (visited.pixels[i] ?? 0)) > 2e-3);
  expect(differing.length).toBeLessThan(skipped.pixels.length / 1000);
});

test.each(["A", "R", "S"] as const)(
  "a visible segment is a ball of the right size from %s, in its own colour",
  async (from) => {
    const { pixels, camera } = await march({ ...ball, spacing: [1, 1, 2], from, segment: "visible" });
    const centre: Vec3 = [24, 24, 48];
    for (let y = 0; y < edge; y += 3) {
      for (let x = 0; x < edge; x += 3) {
        const [red = 0, green = 0, , alpha = 0] = pixelAt(pixels, x, y);
        const ray = rayThrough(camera, x + 0.5, y + 0.5, { width: edge, height: edge });
        const along =
          (centre[0] - ray.origin[0]) * ray.direction[0] +
          (centre[1] - ray.origin[1]) * ray.direction[1] +
          (centre[2] - ray.origin[2]) * ray.direction[2];
        const nearest: Vec3 = [
          ray.origin[0] + along * ray.direction[0],
          ray.origin[1] + along * ray.direction[1],
          ray.origin[2] + along * ray.direction[2],
        ];
        const away = distance(nearest, centre);
        // slices of 2 mm round the ball's edge off by less than a voxel
        if (away < 12.5) {
          expect(alpha).toBe(1);
          expect(green).toBeGreaterThan(2 * red);
        } else if (away > 15) {
          expect(alpha).toBe(0);
        }
      }
    }
  },
);

test("of segments in one another the outer one is seen, also where a step passes both", async () => {
  const { pixels } = await march({ ...ball, stepsPerVoxel: 1, segment: "nested" });
  const colours = Array.from({ length: edge * edge }, (_, i) => pixels.slice(4 * i, 4 * i + 3));
  const greens = colours.filter(([red = 0, green = 0]) => green > red);
  expect(colours.filter(([red = 0, green = 0]) => red > green).length).toBeGreaterThan(1000);
  expect(greens.length).toBe(0);
});

test("of as many segments as there is room for the last one is drawn as if it were alone", async () => {
  const alone = await march({ ...ball, segment: "visible" });
  expect((await march({ ...ball, segment: "last" })).pixels).toEqual(alone.pixels);
});

test("a hidden segment leaves nothing in the picture", async () => {
  const shown = mean(alphas(await march({ ...ball, segment: "visible" })));
  const hidden = mean(alphas(await march({ ...ball, segment: "hidden" })));
  expect(shown).toBeGreaterThan(0.1);
  expect(hidden).toBeLessThan(0.001);
});

test("the transfer function changes the picture: more soft tissue is more opaque", async () => {
  const at = async (softTissue: number): Promise<number> =>
    mean(alphas(await march({ ...ball, softTissue, segment: "hidden" })));
  const [none, some, much] = [await at(0), await at(0.5), await at(0.95)];
  expect(none).toBeLessThan(some);
  expect(some).toBeLessThan(much);
});

test("light comes from the viewer's upper left, from wherever one looks", async () => {
  for (const from of ["A", "L", "S"] as const) {
    const { pixels } = await march({ ...ball, from, segment: "visible" });
    const green = (x: number, y: number): number => pixelAt(pixels, x, y)[1] ?? 0;
    expect(green(edge / 2 - 10, edge / 2 - 10)).toBeGreaterThan(1.3 * green(edge / 2 + 10, edge / 2 + 10));
  }
});

test("segments that are no threshold are drawn from their labels, also in clear air", async () => {
  const { pixels, camera, extent } = await march({ ...ball, field: "label", from: "A" });
  expect(pixelAt(pixels, edge / 2, edge / 2)[0]).toBeGreaterThan(0.2);
  // the box fills the middle half of the scan
  const place = project(camera, [extent.centre[0] + 15, extent.centre[1], extent.centre[2]], {
    width: edge,
    height: edge,
  });
  expect(pixelAt(pixels, Math.round(place?.[0] ?? 0), edge / 2)[3]).toBe(0);
});

/**
 * Pixels in which two pictures differ, by whether they show something within `reach` pixels of the
 * hole's front: its own shadow reaches some voxels beyond it.
 */
function differences(one: MarchResult, other: MarchResult, reach = 8): { readonly near: number; readonly far: number } {
  const [[left, top], [right, bottom]] = ([[20, 8, 30], [29, 8, 19]] as const).map((corner) =>
    project(one.camera, transformPoint(frameOf(scanOf([voxels, voxels, voxels], [1, 1, 1])).sceneFromGrid, corner), {
      width: edge,
      height: edge,
    }) ?? [0, 0],
  ) as [readonly [number, number], readonly [number, number]];
  const [x0, x1] = [Math.min(left, right) - reach, Math.max(left, right) + reach];
  const [y0, y1] = [Math.min(top, bottom) - reach, Math.max(top, bottom) + reach];
  const found = { near: 0, far: 0 };
  for (let y = 0; y < edge; ++y) {
    for (let x = 0; x < edge; ++x) {
      const [a, b] = [pixelAt(one.pixels, x, y), pixelAt(other.pixels, x, y)];
      if (a.some((channel, i) => Math.abs(channel - (b[i] ?? 0)) > 0.02)) {
        const isNear = x0 <= x && x <= x1 && y0 <= y && y <= y1;
        found[isNear ? "near" : "far"] += 1;
      }
    }
  }
  return found;
}

test("an edited threshold segment has steps of voxels where it was edited, and nowhere else", async () => {
  const plain = await march({ ...ball, segment: "visible" });
  const unchanged = differences(plain, await march({ ...ball, segment: "visible", labels: "as values" }));
  expect(unchanged).toEqual({ near: 0, far: 0 });
  const edited = differences(plain, await march({ ...ball, segment: "visible", labels: "with hole" }));
  expect(edited.near).toBeGreaterThan(50);
  expect(edited.far).toBe(0);
  // by its labels alone it would have them everywhere
  const stepped = differences(plain, await march({ ...ball, segment: "visible", labels: "without values" }));
  expect(stepped.far).toBeGreaterThan(50);
});

test("nothing is left of the skin that values had before the voxels that were taken away", async () => {
  const shown = await march({ ...ball, segment: "visible", labels: "with hole" });
  const stepped = await march({ ...ball, segment: "visible", labels: "without values" });
  const plain = await march({ ...ball, segment: "visible" });
  // within the hole's rim both show the same voxels behind it: a skin would be the ball's front
  const rim = -2;
  const skin = differences(plain, stepped, rim).near;
  expect(skin).toBeGreaterThan(40);
  expect(differences(shown, stepped, rim).near).toBeLessThan(skin / 4);
});

test("a scan at half resolution shows the same ball", async () => {
  const whole = alphas(await march({ ...ball, segment: "visible" }));
  const coarse = alphas(await march({ ...ball, segment: "visible", step: 2 }));
  const differing = whole.filter((alpha, i) => Math.abs(alpha - (coarse[i] ?? 0)) > 0.5);
  // only the outline differs: a circle of 26 pixels radius, about a pixel wide
  expect(differing.length).toBeLessThan(2 * Math.PI * 30 * 1.5);
});

test("a picture in haste is much coarser, and shows scan, ground and probe as they are", async () => {
  const bone: MarchTest = { ...ball, segment: "visible" };
  const at = (y: number): MarkerTest => ({ probe: [24, y, 24], device: [24, y, 24] });
  const hasty = (markers: MarkerTest): Promise<{ divisor: number; pixels: number[] }> =>
    browser.page.evaluate(([t, m]) => window.glTests?.hasty(t, m) ?? Promise.reject(new Error("no page")), [
      bone,
      markers,
    ] as const);
  const [before, behind] = [await hasty(at(4)), await hasty(at(44))];
  // from a quarter on it is put together before it is enlarged
  expect(Math.min(before.divisor, behind.divisor)).toBeGreaterThanOrEqual(4);
  const whole = await screen(bone, at(4));
  const off = whole.map((value, i) => Math.abs(value - (before.pixels[i] ?? 0))).sort((a, b) => a - b);
  // a pixel of it is as wide as 12 at most: along outlines colours are far off, at most places they are not
  expect(mean(off)).toBeLessThan(16);
  expect(off[Math.floor(off.length / 2)]).toBeLessThan(8);
  const blue = ({ pixels }: { pixels: readonly number[] }): number => pixelAt(pixels, edge / 2, edge / 2)[2] ?? 0;
  // the probe's depth is held against that of the coarse picture: behind bone it is a ghost
  expect(Math.abs(blue(before) - blue({ pixels: whole }))).toBeLessThan(10);
  expect(blue(behind)).toBeLessThan(blue(before) - 50);
});

test("where only the background is seen nothing is left of what stood there before", async () => {
  const bone: MarchTest = { ...ball, segment: "visible" };
  // the ball is small, and all this stands by the sides of the view
  const probes = [[-190, 24, 24], [24, 24, -190], [220, 24, -150]] as const;
  const marks = [[[-180, 24, -180], [220, 24, -170]]] as const;
  const [pixels, fresh] = await browser.page.evaluate(
    ([t, p, m]) => window.glTests?.turned(t, p, m) ?? Promise.reject(new Error("no page")),
    [bone, probes, marks] as const,
  );
  const off = pixels.map((value, i) => Math.abs(value - (fresh[i] ?? 0)));
  expect(off.filter((one) => one > 1).length).toBe(0);
});

test("the background has its sRGB colours on the screen", async () => {
  const pixels = await screen({ ...ball, segment: "hidden" }, null);
  const expected = srgbFromHex("#1b222b").map((channel) => 255 * channel);
  const middle = pixelAt(pixels, edge / 2, edge / 2);
  // half a step of dither, half of rounding, and the slope of the gradient near its middle
  middle.slice(0, 3).forEach((channel, i) => {
    expect(Math.abs(channel - (expected[i] ?? 0))).toBeLessThanOrEqual(2);
  });
});

test("the probe is plain before bone and a ghost behind it", async () => {
  const bone: MarchTest = { ...ball, segment: "visible" };
  const blue = (pixels: readonly number[]): number => pixelAt(pixels, edge / 2, edge / 2)[2] ?? 0;
  const without = blue(await screen(bone, null));
  const before = blue(await screen(bone, { probe: [24, 4, 24], device: [24, 4, 24] }));
  const behind = blue(await screen(bone, { probe: [24, 44, 24], device: [24, 44, 24] }));
  expect(before).toBeGreaterThan(without + 80);
  expect(behind).toBeGreaterThan(without + 10);
  expect(behind).toBeLessThan(before - 50);
});

/** How many pixels two pictures differ in, and the box around them [pixels from the upper left]. */
function difference(one: readonly number[], other: readonly number[]): { pixels: number; box: readonly number[] } {
  const places = Array.from({ length: edge * edge }, (_, i) => [i % edge, Math.floor(i / edge)] as const).filter(
    ([x, y]) => pixelAt(one, x, y).some((channel, c) => Math.abs(channel - (pixelAt(other, x, y)[c] ?? 0)) > 12),
  );
  const [xs, ys] = [places.map(([x]) => x), places.map(([, y]) => y)];
  return { pixels: places.length, box: [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)] };
}

test("the probe's ball is drawn at its true size, and as a point without one", async () => {
  const air: MarchTest = { ...ball, segment: "hidden" };
  const none = await screen(air, null);
  const point = difference(none, await screen(air, { pixel: 0.2 }));
  const sized = difference(none, await screen(air, { pixel: 0.2, radius: 12 }));
  const hidden = { contactPoint: true, normal: true, ball: false, path: true };
  const unshown = difference(none, await screen(air, { pixel: 0.2, radius: 12, show: hidden }));
  const { camera } = await march({ ...flat, from: "A" });
  const [left = 0] = project(camera, [12, 24, 24], { width: edge, height: edge }) ?? [];
  const [right = 0] = project(camera, [36, 24, 24], { width: edge, height: edge }) ?? [];
  expect(unshown.pixels).toBe(point.pixels);
  // a ball's outline is a little wider than its middle plane, and its rim covers pixels in part
  expect(Math.abs((sized.box[2] ?? 0) - (sized.box[0] ?? 0) + 1 - (right - left))).toBeLessThan(3);
});

test("the contact's normal points out of the surface, and only in contact", async () => {
  const air: MarchTest = { ...ball, segment: "hidden" };
  const touching: MarkerTest = { pixel: 0.5, contact: true, contactPoint: [24, 24, 24], normal: [0, 0, 1] };
  const without = { contactPoint: false, normal: false, ball: true, path: true };
  const plain = await screen(air, { ...touching, show: without });
  const up = difference(plain, await screen(air, touching)).box;
  const left = difference(plain, await screen(air, { ...touching, normal: [-1, 0, 0] })).box;
  const middle = edge / 2;
  // superior is up and the patient's right is left, seen from before
  expect(middle - (up[1] ?? 0)).toBeGreaterThan(30);
  expect((up[3] ?? 0) - middle).toBeLessThan(10);
  expect(middle - (left[0] ?? 0)).toBeGreaterThan(30);
  expect((left[2] ?? 0) - middle).toBeLessThan(10);
  const free = difference(
    await screen(air, { ...touching, contact: false, show: without }),
    await screen(air, { ...touching, contact: false }),
  );
  expect(free.pixels).toBe(0);
});

test("the probe's way is a line where it was, fresh at its end, faint behind bone", async () => {
  const bone: MarchTest = { ...ball, segment: "visible" };
  const probe: Vec3 = [44, 4, 44];
  const across = (y: number): Vec3[] => [4, 12, 20, 28, 36, 44].map((x): Vec3 => [x, y, 24]);
  const none = await screen(bone, { probe, device: probe });
  const before = difference(none, await screen(bone, { probe, device: probe, way: across(6) }));
  const behind = difference(none, await screen(bone, { probe, device: probe, way: across(44) }));
  // 40 mm of 48 that fill nearly the whole picture
  expect((before.box[2] ?? 0) - (before.box[0] ?? 0)).toBeGreaterThan(50);
  expect((before.box[3] ?? 0) - (before.box[1] ?? 0)).toBeLessThan(6);
  // in the middle the ball stands before it
  expect(behind.pixels).toBeLessThan(0.7 * before.pixels);
  const show = { contactPoint: true, normal: true, ball: true, path: false };
  expect(difference(none, await screen(bone, { probe, device: probe, way: across(6), show })).pixels).toBe(0);
});

test("several jittered pictures average to the plain one", async () => {
  const tissue: MarchTest = { ...ball, softTissue: 0.6, segment: "hidden" };
  const plain = await screen(tissue, null);
  const averaged = await screen(tissue, null, true);
  const differences = plain.map((value, i) => Math.abs(value - (averaged[i] ?? 0)));
  // the outline is smoothed, the inside is the same: 4 starts of a ray against the middle one
  expect(mean(differences)).toBeLessThan(2);
  expect(mean(plain.map((value, i) => value - (averaged[i] ?? 0)))).toBeLessThan(0.5);
});

test("a finer quality takes more steps, averages more pictures at rest, and comes nearer to the finest", async () => {
  const tissue: MarchTest = { ...ball, softTissue: 0.6, segment: "hidden" };
  const drawn = await Promise.all(
    qualities.map((quality) =>
      browser.page.evaluate(([t, q]) => window.glTests?.refined(t, q) ?? Promise.reject(new Error("no page")), [
        tissue,
        quality,
      ] as const),
    ),
  );
  expect(drawn.map(({ shown }) => shown)).toEqual(
    qualities.map((quality) => ({ divisor: 1, finished: true, triangles: 0, ...restingPictures[quality] })),
  );
  const off = drawn.map(({ pixels }) =>
    mean(pixels.map((value, i) => Math.abs(value - (drawn.at(-1)?.pixels[i] ?? 0)))),
  );
  expect(off).toEqual([...off].sort((a, b) => b - a));
  expect(off[2]).toBeLessThan(0.5 * (off[0] ?? 0));
});

test("from a coarse picture to the finest each is shown that is half as coarse", async () => {
  const seen = await browser.page.evaluate((t) => window.glTests?.steps(t) ?? Promise.reject(new Error("no page")), {
    ...ball,
    softTissue: 0.5,
  } as MarchTest);
  expect(seen).toEqual([8, 4, 2, 1]);
});

test("a hole is seen first where it was made, and nothing becomes coarser meanwhile", async () => {
  // at the ball's front, as seen from anterior
  const hole = { low: [20, 8, 20], high: [28, 16, 28] } as const;
  const { before, first, last, worst } = await browser.page.evaluate(
    ([t, box]) => window.glTests?.bored(t, box) ?? Promise.reject(new Error("no page")),
    [{ ...ball, segment: "visible" } as MarchTest, hole] as const,
  );
  const { pixels, box } = difference(before, first);
  expect(pixels).toBeGreaterThan(50);
  // 8 mm of 48 that fill nearly the whole picture, and as far as values and gradients reach
  const [left = 0, top = 0, right = edge, bottom = edge] = box;
  expect(Math.max(right - left, bottom - top)).toBeLessThan(edge / 2);
  expect(worst).toBe(1);
  // its shadow comes later
  expect(difference(first, last).pixels).toBeLessThan(difference(before, last).pixels);
});

test("at rest a GPU does not wait for frames, and is final once on the screen; a CPU shows first", async () => {
  const drawn = await browser.page.evaluate(
    async (scene) =>
      [await window.glTests?.withoutFrames(scene, false), await window.glTests?.withoutFrames(scene, true)] as const,
    { ...ball, segment: "visible" } as MarchTest,
  );
  const [gpu, cpu] = drawn;
  // one level and all pictures that are averaged after it, in a strip each at least
  expect(gpu?.pieces).toBeGreaterThanOrEqual(restingPictures.balanced.passes);
  expect(gpu?.finished).toEqual([false, true]);
  // the first whole picture waits for a frame, before those that are averaged with it
  expect(cpu?.pieces).toBeGreaterThanOrEqual(1);
  expect(cpu?.finished).toEqual([false, false]);
});

test.each([true, false])(
  "the programs of a first picture are there before the scan, and what it shows is what the whole one shows; " +
  "software: %s",
  async (software) => {
    for (const scene of [
      { ...ball, softTissue: 0.5 },
      { ...ball, segment: "visible" as const },
    ]) {
      const { links, first, whole } = await browser.page.evaluate(
        ([one, cpu]) => window.glTests?.programs(one, cpu) ?? Promise.reject(new Error("no page")),
        [scene, software] as const,
      );
      const [prepared, awaited, after] = links;
      expect(prepared).toBeGreaterThan(0);
      // nothing is compiled while the picture is awaited; the rest follows it
      expect(awaited).toBe(0);
      expect(after).toBeGreaterThan(0);
      const off = first.map((value, i) => Math.abs(value - (whole[i] ?? 0)));
      expect(Math.max(...whole.filter((_, i) => i % 4 === 0))).toBeGreaterThan(60);
      expect(mean(off)).toBeLessThan(6);
    }
  },
);
