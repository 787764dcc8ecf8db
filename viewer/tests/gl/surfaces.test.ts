/**
 * Surfaces of segments in a real browser, with the real shaders: balls in patches, over and
 * inside a scan of 48³ mm, seen from before on 96² pixels.
 */
import { afterAll, beforeAll, expect, test } from "vitest";
import { extentOf, lookFrom, project } from "../../src/core/geometry/camera";
import type { InsideModes } from "../../src/core/segments/shown_segments";
import { distance, type Vec3 } from "../../src/core/geometry/vector";
import { openGlBrowser, type GlBrowser } from "./browser";
import type { MarchTest } from "./scenes_page";
import type { ScreenTest, SurfaceTest } from "./screen_page";
import type { Detailed } from "./surface_page";

const edge = 96;
const viewport = { width: edge, height: edge };
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

/** Pixel of a picture; y counts from the top. */
function pixelAt(pixels: readonly number[], x: number, y: number): readonly [number, number, number] {
  const i = 4 * (x + edge * (edge - 1 - y));
  return [pixels[i] ?? 0, pixels[i + 1] ?? 0, pixels[i + 2] ?? 0];
}

const air: MarchTest = { field: "flat", spacing: [1, 1, 1], from: "A", stepsPerVoxel: 1, extinction: 0 };
const middle: Vec3 = [24, 24, 24];
const red: SurfaceTest = { centre: middle, radius: 12, sectors: 4, appearance: { colour: [1, 0, 0] } };

const camera = lookFrom(
  "A",
  extentOf([0, 1, 2, 3, 4, 5, 6, 7].map((i) => [i & 1 ? 48 : 0, i & 2 ? 48 : 0, i & 4 ? 48 : 0])),
  viewport,
);

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

/** How many pixels two pictures differ in by more than `most` in any channel. */
function differing(one: readonly number[], other: readonly number[], most: number): number {
  let count = 0;
  for (let i = 0; i < one.length; i += 4) {
    count += [0, 1, 2].some((c) => Math.abs((one[i + c] ?? 0) - (other[i + c] ?? 0)) > most) ? 1 : 0;
  }
  return count;
}

/** A green ball of the scan itself, of 14 mm. */
const green: MarchTest = {
  field: "ball",
  spacing: [1, 1, 1],
  from: "A",
  stepsPerVoxel: 2,
  segment: "visible",
  softTissue: 0,
};
const bone: Partial<SurfaceTest["appearance"]> = { colour: [0, 1, 0], range: [0, 32767] };
const redDot = (y: number, opacity = 1): SurfaceTest => ({
  centre: [24, y, 24],
  radius: 4,
  sectors: 4,
  appearance: { colour: [1, 0, 0], opacity },
});
const centre = edge / 2;

test("of a surface and the scan the nearer one is seen", async () => {
  const plain = pixelAt(await show({ scan: green }), centre, centre);
  // the viewer stands at smaller y; the scan's ball reaches from 10 to 38
  expect(isRed(pixelAt(await show({ scan: green, surfaces: [redDot(8)] }), centre, centre))).toBe(true);
  expect(pixelAt(await show({ scan: green, surfaces: [redDot(24)] }), centre, centre)).toEqual(plain);
  expect(pixelAt(await show({ scan: green, surfaces: [redDot(42)] }), centre, centre)).toEqual(plain);
});

test("a surface half inside of the scan's ball is cut where it goes in", async () => {
  const pixels = await show({ scan: green, surfaces: [redDot(10)] });
  // a red cap in the middle, green around it
  const [r, g] = pixelAt(pixels, centre, centre);
  expect(r).toBeGreaterThan(2 * g);
  expect(isRed(pixelAt(pixels, centre + 10, centre))).toBe(false);
});

test("tissue before a surface veils it, tissue behind does not", async () => {
  const tissue: MarchTest = { field: "flat", spacing: [1, 1, 1], from: "A", stepsPerVoxel: 1, extinction: 0.6 };
  const redness = async (y: number): Promise<number> => {
    const [r, , b] = pixelAt(await show({ scan: tissue, surfaces: [redDot(y)] }), centre, centre);
    return r - b;
  };
  const [before, within, deep] = [await redness(-6), await redness(16), await redness(40)];
  expect(before).toBeGreaterThan(within + 20);
  expect(within).toBeGreaterThan(deep + 20);
});

test("a ball drawn as a surface looks like the ball drawn from its voxels", async () => {
  const hidden: MarchTest = { ...green, segment: "hidden" };
  const ball: SurfaceTest = { centre: middle, radius: 14, sectors: 4, appearance: bone };
  const [voxels, surface] = [await show({ scan: green }), await show({ scan: hidden, surfaces: [ball] })];
  const inside = (i: number): boolean =>
    Math.hypot((i % edge) + 0.5 - centre, Math.floor(i / edge) + 0.5 - centre) < outlineRadius(13);
  const differences = Array.from({ length: edge * edge }, (_, i) => i)
    .filter(inside)
    .map((i) => Math.abs((voxels[4 * i + 1] ?? 0) - (surface[4 * i + 1] ?? 0)));
  // normals of 8 bits and of central differences: a few degrees, and so a few of 255 in the light
  expect(differences.reduce((sum, d) => sum + d, 0) / differences.length).toBeLessThan(4);
  expect(Math.max(...differences)).toBeLessThan(30);
});

test.each([1, 0.5])("seams between patches do not show, opacity %d", async (opacity) => {
  const cut = async (sectors: number): Promise<number[]> =>
    show({
      scan: green,
      surfaces: [{ centre: middle, radius: 17, sectors, appearance: { colour: [1, 0, 0], opacity } }],
    });
  // boxes of other sizes move a vertex by up to 0.3 µm, which may turn the odd pixel at an edge
  expect(differing(await cut(1), await cut(16), 6)).toBeLessThan(8);
});

test("a translucent surface lets the scan behind it through, as much as its opacity says", async () => {
  const [r0, g0] = pixelAt(await show({ scan: green }), centre, centre);
  const reds: number[] = [];
  for (const opacity of [0.2, 0.5, 0.8]) {
    const [r, g] = pixelAt(await show({ scan: green, surfaces: [redDot(4, opacity)] }), centre, centre);
    expect(g).toBeLessThan(g0);
    expect(g).toBeGreaterThan(20);
    reds.push(r - r0);
  }
  expect(reds).toEqual([...reds].sort((a, b) => a - b));
  expect(reds[0]).toBeGreaterThan(20);
});

test("a translucent surface behind the scan or behind an opaque surface is not seen", async () => {
  expect(differing(await show({ scan: green }), await show({ scan: green, surfaces: [redDot(42, 0.5)] }), 3)).toBe(0);
  const blue: SurfaceTest = { centre: [24, 6, 24], radius: 6, sectors: 2, appearance: { colour: [0, 0, 1] } };
  const covered = await show({ scan: green, surfaces: [blue, redDot(6, 0.5)] });
  expect(differing(await show({ scan: green, surfaces: [blue] }), covered, 3)).toBe(0);
});

test("translucent surfaces in one another look the same in whatever order they are listed", async () => {
  const outer: SurfaceTest = {
    centre: middle,
    radius: 12,
    sectors: 4,
    appearance: { colour: [0, 0, 1], opacity: 0.4 },
  };
  const inner: SurfaceTest = { centre: middle, radius: 6, sectors: 4, appearance: { colour: [1, 0, 0], opacity: 0.6 } };
  const [one, other] = [
    await show({ scan: air, surfaces: [outer, inner] }),
    await show({ scan: air, surfaces: [inner, outer] }),
  ];
  expect(differing(one, other, 2)).toBe(0);
  const [r, , b] = pixelAt(one, centre, centre);
  const [rimRed, , rimBlue] = pixelAt(one, centre + 14, centre);
  expect(r).toBeGreaterThan(b);
  expect(rimBlue).toBeGreaterThan(2 * rimRed);
});

test("each surface has its own ambient and specular light", async () => {
  const ball = (x: number, appearance: SurfaceTest["appearance"]): SurfaceTest => ({
    centre: [x, 24, 24],
    radius: 8,
    sectors: 4,
    appearance: { colour: [1, 0, 0], ...appearance },
  });
  const middles = async (appearance: SurfaceTest["appearance"]): Promise<readonly [number, number]> => {
    const pixels = await show({ scan: air, surfaces: [ball(12, appearance), ball(36, {})] });
    const brightest = (from: number): number => {
      const places = Array.from({ length: edge * (edge / 2) }, (_, i) =>
        pixelAt(pixels, from + (i % (edge / 2)), Math.floor(i / (edge / 2))),
      );
      // green of a red ball is its highlight
      return Math.max(...places.filter(([red]) => red > 40).map(([, green]) => green));
    };
    return [brightest(0), brightest(edge / 2)];
  };
  const [plain, other] = await middles({});
  const [dull, beside] = await middles({ specular: 0 });
  expect(beside).toBe(other);
  expect(dull).toBeLessThan(0.7 * plain);
});

test("a wireframe is lines between which one looks through", async () => {
  const ball = (wireframe: boolean): SurfaceTest => ({
    centre: middle,
    radius: 20,
    sectors: 4,
    rings: 8,
    appearance: { colour: [1, 0, 0], wireframe },
  });
  const reds = async (wireframe: boolean): Promise<number> => {
    const pixels = await show({ scan: green, surfaces: [ball(wireframe)] });
    return Array.from({ length: edge * edge }, (_, i) => pixelAt(pixels, i % edge, Math.floor(i / edge))).filter(isRed)
      .length;
  };
  const [lines, solid] = [await reds(true), await reds(false)];
  expect(lines).toBeGreaterThan(100);
  expect(lines).toBeLessThan(0.8 * solid);
});

test("a segment stands where its pose puts it", async () => {
  // a quarter turn about z, then 6 mm up: (24, 14, 24) comes to (34, 24, 30)
  const pose = [0, -1, 0, 48, 1, 0, 0, 0, 0, 0, 1, 6, 0, 0, 0, 1];
  const posed = await show({ scan: air, surfaces: [{ ...redDot(14), appearance: { colour: [1, 0, 0], pose } }] });
  const there = await show({ scan: air, surfaces: [{ ...redDot(14), centre: [34, 24, 30] }] });
  // the ball's own columns have turned with it: facets at its outline
  expect(differing(posed, there, 30)).toBeLessThan(15);
});

test("hidden segments, and those of no opacity, draw no surface", async () => {
  const none = await show({ scan: green });
  for (const appearance of [{ visible: false }, { opacity: 0 }, { shown_as: "volume" as const }]) {
    expect(differing(none, await show({ scan: green, surfaces: [{ ...redDot(8), appearance }] }), 0)).toBe(0);
  }
});

test("averaged pictures smooth the outline of a surface and leave the rest", async () => {
  const [plain, averaged] = [
    await show({ scan: air, surfaces: [red] }),
    await show({ scan: air, surfaces: [red], jitter: true }),
  ];
  expect(pixelAt(averaged, centre, centre)[0]).toBeCloseTo(pixelAt(plain, centre, centre)[0], -1);
  const between = (pixels: readonly number[]): number =>
    Array.from({ length: edge }, (_, x) => pixelAt(pixels, x, centre)[0]).filter((r) => r > 50 && r < 90).length;
  expect(between(averaged)).toBeGreaterThanOrEqual(between(plain));
});

test("patches outside of the view are not drawn", async () => {
  const triangles = (target: Vec3, away: number): Promise<number> =>
    browser.page.evaluate(
      ([t, a]) =>
        window.glTests?.drawnTriangles({ centre: [24, 24, 24], radius: 12, sectors: 16, appearance: {} }, t, a) ??
        Promise.reject(new Error("no page")),
      [target, away] as const,
    );
  // 32 rings of 64 columns, two triangles each
  expect(await triangles(middle, 120)).toBe(4096);
  // to the right of the ball: the sectors on its left are out of view
  const close = await triangles([50, 24, 24], 30);
  expect(close).toBeGreaterThan(0);
  expect(close).toBeLessThan(3000);
  expect(await triangles([200, 24, 24], 30)).toBe(0);
});

test.each([
  [2, 48],
  [3, 7],
  [4, 1],
])("at 1/%d of the resolution, in strips of %d rows, surfaces stand where they should", async (divisor, strip) => {
  const size = edge / divisor;
  const pixels = await browser.page.evaluate(
    ([scan, balls, d, s]) => window.glTests?.coarseLevel(scan, balls, d, s) ?? Promise.reject(new Error("no page")),
    [green, [redDot(8), { ...red, radius: 4, centre: [24, 42, 24] as Vec3 }], divisor, strip] as const,
  );
  expect(pixels).toHaveLength(4 * size * size);
  const channel = (x: number, y: number, c: number): number => pixels[4 * (x + size * y) + c] ?? 0;
  for (let y = 0; y < size; ++y) {
    for (let x = 0; x < size; ++x) {
      const away = divisor * Math.hypot(x + 0.5 - size / 2, y + 0.5 - size / 2);
      const [red, green] = [channel(x, y, 0), channel(x, y, 1)];
      // the near dot is 4 mm, a little larger for being near; then comes the scan's ball
      if (away < outlineRadius(3.5)) {
        expect([x, y, red > green]).toEqual([x, y, true]);
      } else if (away > outlineRadius(5) + divisor && away < outlineRadius(13.5) - divisor) {
        expect([x, y, green > red]).toEqual([x, y, true]);
      } else if (away > outlineRadius(14.5) + divisor) {
        expect([x, y, red + green]).toEqual([x, y, 0]);
      }
    }
  }
});

test("voxels around a surface shade it, but not in a picture in haste", async () => {
  // all of the scan's values are in the one range, none in the other
  const of = (range: readonly [number, number]): SurfaceTest => ({ ...red, appearance: { colour: [1, 0, 0], range } });
  const [around, alone] = [of([-30_000, 30_000]), of([29_000, 30_000])];
  const redness = async (stepsPerVoxel: number, ball: SurfaceTest): Promise<number> => {
    const pixels = await browser.page.evaluate(
      ([scan, b]) => window.glTests?.coarseLevel(scan, [b], 1, 96) ?? Promise.reject(new Error("no page")),
      [{ ...air, stepsPerVoxel }, ball] as const,
    );
    return pixels[4 * (centre + edge * centre)] ?? 0;
  };
  const [free, covered, hasty] = [await redness(1, alone), await redness(1, around), await redness(0.5, around)];
  expect(covered).toBeLessThan(0.8 * free);
  expect(hasty).toBeCloseTo(free, 2);
});

test.each([1, 0.7])("the probe is plain before a surface and a ghost behind it, opacity %d", async (opacity) => {
  const probeAt = async (y: number): Promise<number> => {
    const probe: Vec3 = [24, y, 24];
    const surfaces = [{ ...red, appearance: { colour: [0.5, 0, 0] as const, opacity } }];
    const pixels = await show({ scan: air, surfaces, markers: { probe, device: probe, pixel: 0.5 } });
    return pixelAt(pixels, centre, centre)[2];
  };
  // the ball reaches from 12 to 36
  const [before, behind] = [await probeAt(8), await probeAt(30)];
  expect(before).toBeGreaterThan(behind + 60);
});

test.each([
  ["a scan", [], [0, 255, 0]],
  ["a surface", [{ ...red, centre: [24, 8, 24] as Vec3 }], [255, 0, 0]],
])("%s is drawn again where the canvas becomes smaller while the GPU is at work", async (_, surfaces, colour) => {
  const pixel = await browser.page.evaluate(
    (t) => window.glTests?.resizedMiddle(t) ?? Promise.reject(new Error("no page")),
    { scan: green, surfaces },
  );
  const brightest = Math.max(...pixel.slice(0, 3));
  expect(brightest).toBeGreaterThan(100);
  expect(colour[pixel.indexOf(brightest)]).toBe(255);
});

test.each([1, 0.5])(
  "with few triangles surfaces look nearly the same, with all of them the same, opacity %d",
  async (opacity) => {
    // nothing tells of their voxels: no body can stand for them
    const appearance = { colour: [1, 0, 0] as const, opacity, range: null };
    const balls: SurfaceTest[] = [
      { centre: middle, radius: 17, sectors: 4, rings: 96, appearance },
      { centre: [24, 6, 24], radius: 4, sectors: 1, rings: 96, appearance },
    ];
    const pictures = await browser.page.evaluate(
      ([scan, b]) => window.glTests?.detailed(scan, b) ?? Promise.reject(new Error("no page")),
      [green, balls] as const,
    );
    const { all, few, inParts, partly, edited, later, again } = pictures;
    expect(few.all).toBe(all.drawn);
    expect(few.drawn).toBeLessThan(all.drawn / 10);
    expect(inParts).toEqual(few);
    // a patch that was edited just now is seen as it is; the others of its surface meet it, vertex by vertex
    expect(partly.all).toBe(all.drawn);
    expect(partly.drawn).toBeGreaterThan(all.drawn / 8);
    expect(partly.drawn).toBeLessThan(all.drawn / 2);
    expect(edited).toEqual(all);
    expect(later).toEqual(few);
    expect(again).toEqual(all);
    for (const { pixels } of [few, partly]) {
      const off = pixels.map((value, i) => Math.abs(value - (all.pixels[i] ?? 0)));
      expect(off.reduce((sum, one) => sum + one, 0) / off.length).toBeLessThan(0.01);
      // facets of a ball of 17 mm lie up to 1 mm inside: at most a rim of its outline, of a 25th of the picture
      expect(off.filter((one) => one > 0.15).length / off.length).toBeLessThan(1 / 25);
    }
  },
);

const ball: SurfaceTest = {
  centre: middle,
  radius: 14,
  sectors: 4,
  rings: 96,
  appearance: { colour: [1, 0, 0], range: [0, 1000] },
};
const like = (appearance: SurfaceTest["appearance"]): SurfaceTest => ({
  ...ball,
  appearance: { ...ball.appearance, ...appearance },
});

async function embodied(
  scan: MarchTest,
  balls: readonly SurfaceTest[],
  modes: InsideModes = {},
): Promise<[Detailed, Detailed, Detailed]> {
  const pictures = await browser.page.evaluate(
    ([s, b, m]) => window.glTests?.embodied(s, b, m) ?? Promise.reject(new Error("no page")),
    [scan, balls, modes] as const,
  );
  return pictures as [Detailed, Detailed, Detailed];
}

const inBall: MarchTest = { ...air, field: "ball" };
// the front half is gone: a cut face is seen
const cutOpen: MarchTest = { ...inBall, clip: [{ normal: [0, -1, 0], offset: -20 }] };
// its own colour is seen through the surface
const inTissue: MarchTest = { ...inBall, extinction: 0.05 };
const labelled = { range: null };
// labels tell too, and are as its values say
const edited = { range: null, made_by: [0, 1000] } as const;
// values rise by 400 for each mm toward the middle
const inner: SurfaceTest = { ...ball, radius: 12, appearance: { colour: [0, 0, 1], range: [800, 1000] } };
const innerSeenThrough: SurfaceTest = { ...inner, appearance: { ...inner.appearance, opacity: 0.6 } };
const seenThrough = { opacity: 0.5 };
const both = { shown_as: "both" } as const;

test.each([
  ["opaque", inBall, [ball], {}],
  ["opaque, told by labels", inBall, [like(labelled)], {}],
  ["opaque, cut open", cutOpen, [ball], {}],
  ["seen through", inBall, [like(seenThrough)], {}],
  ["seen through, told by labels", inBall, [like({ ...seenThrough, ...labelled })], {}],
  ["seen through, edited", inBall, [like({ ...seenThrough, ...edited })], {}],
  ["seen through, cut open", cutOpen, [like(seenThrough)], {}],
  ["seen through, one in another", inBall, [like(seenThrough), innerSeenThrough], {}],
  ["seen through, one in another, listed the other way round", inBall, [innerSeenThrough, like(seenThrough)], {}],
  ["seen through, around an opaque one", inBall, [like(seenThrough), inner], {}],
  [
    "seen through, before an iso-surface",
    { ...inBall, optics: { blend: "iso", isoValue: 800 } },
    [like(seenThrough)],
    {},
  ],
  ["beside its voxels", inBall, [like(both)], {}],
  ["seen through, beside its voxels", inBall, [like({ ...both, ...seenThrough })], {}],
  ["around tinted voxels", inTissue, [like(both)], { 1: "tinted" }],
  ["seen through, around tinted voxels", inTissue, [like({ ...both, ...seenThrough })], { 1: "tinted" }],
  [
    "seen through, around tinted voxels, told by labels",
    inTissue,
    [like({ ...both, ...seenThrough, ...labelled })],
    { 1: "tinted" },
  ],
] as const)(
  "in haste the body of its voxels stands for a surface, and looks nearly the same: %s",
  async (name, scan, balls, modes) => {
    const [all, few, again] = await embodied(scan, balls, modes);
    // of 96 rings and 192 columns, two each
    expect(all.drawn).toBeGreaterThan(30_000);
    expect([few.drawn, few.all]).toEqual([0, balls.length * 36_864]);
    expect(again).toEqual(all);
    const off = few.pixels.map((value, i) => Math.abs(value - (all.pixels[i] ?? 0)));
    // by values the rim of the outline alone differs, of a 35th of the picture; labels have steps of a voxel, and
    // normals of those
    const byLabels = name.includes("labels");
    expect(off.reduce((sum, one) => sum + one, 0) / off.length).toBeLessThan(byLabels ? 0.03 : 0.01);
    expect(off.filter((one) => one > 0.15).length / off.length).toBeLessThan(byLabels ? 1 / 10 : 1 / 35);
  },
);

test("bodies that stand for surfaces are the same with a GPU's loops and with a CPU's", async () => {
  const balls = [like(seenThrough), innerSeenThrough];
  const [cpu, gpu] = await Promise.all([true, false].map((software) => embodied({ ...inTissue, software }, balls)));
  expect(gpu?.[1].drawn).toBe(0);
  expect(gpu?.[1].pixels).toEqual(cpu?.[1].pixels);
});

test.each([
  ["it is a net", inBall, { wireframe: true }, {}],
  ["it was moved", inBall, { pose: [1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 0] }, {}],
  ["its voxels are drawn as the scan beside it", inTissue, both, { 1: "plain" }],
  ["voxels of segments are values like others", { ...inBall, optics: { blend: "mip" } }, {}, {}],
] as const)("no body stands for a surface where %s", async (_, scan, appearance, modes) => {
  const [all, few] = await embodied(scan, [like(appearance)], modes);
  expect(few.drawn).toBe(all.drawn);
  expect(few.pixels).toEqual(all.pixels);
});
