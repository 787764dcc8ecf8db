/**
 * What is cut away, in a real browser with the real shaders, against the geometry of what is left.
 * Scans of 48³ mm whose ball has its middle at 24 mm and a radius of 14 mm; pictures of 96², no jitter.
 */
import { afterAll, beforeAll, expect, test } from "vitest";
import { keptSpan, planesOf, type Clip, type Plane } from "../../src/core/view/clip";
import { frameOf } from "../../src/core/scan/scan_volume";
import { addScaled, dot, normalize, scale, subtract, type Vec3 } from "../../src/core/geometry/vector";
import { linearFromSrgb } from "../../src/core/base/colour";
import { keyLight } from "../../src/gl/march/key_light";
import { scanOf } from "../support/volumes";
import { openGlBrowser, type GlBrowser } from "./browser";
import type { MarchResult, MarchTest } from "./scenes_page";
import type { ScreenTest } from "./screen_page";
import { channel, litSurface, raysOf } from "./rays";

const frame = frameOf(scanOf([48, 48, 48], [1, 1, 1]));
const middle: Vec3 = [24, 24, 24];
const oblique: Plane = { normal: normalize([0.5, -0.7, 0.4]), offset: dot(normalize([0.5, -0.7, 0.4]), [26, 20, 27]) };
/** The viewer stands at smaller y: the front half is cut away. */
const front: Plane = { normal: [0, -1, 0], offset: -24 };
const box: Clip = { box: { on: true, low: [16, 20, 0], high: [8, 0, 18] }, planes: [] };
let browser: GlBrowser;

beforeAll(async () => {
  browser = await openGlBrowser();
});

afterAll(async () => {
  await browser.close();
});

function march(part: Partial<MarchTest> & Pick<MarchTest, "field">): Promise<MarchResult> {
  const whole: MarchTest = { spacing: [1, 1, 1], from: "A", stepsPerVoxel: 2, ...part };
  return browser.page.evaluate((t) => window.glTests?.march(t) ?? Promise.reject(new Error("no page")), whole);
}

function show(what: ScreenTest): Promise<number[]> {
  return browser.page.evaluate((t) => window.glTests?.show(t) ?? Promise.reject(new Error("no page")), what);
}

/** Where a ray goes through a ball around the middle; null where it passes by. */
function throughBall(origin: Vec3, direction: Vec3, radius: number): readonly [number, number] | null {
  const to = subtract(middle, origin);
  const along = dot(to, direction);
  const reach = radius ** 2 - dot(to, to) + along ** 2;
  return reach < 0 ? null : [along - Math.sqrt(reach), along + Math.sqrt(reach)];
}

test.each([
  ["an oblique plane", [oblique]],
  ["a box and an oblique plane", [...planesOf(box, frame), oblique]],
] as const)("a homogeneous block absorbs as long as the way through what %s leaves", async (_, clip) => {
  const result = await march({ field: "flat", extinction: 0.4, optics: { blend: "absorption", density: 0.05 }, clip });
  const lengths = raysOf(result, frame).map(({ origin, direction, span }) => {
    const kept = keptSpan(clip, { origin, direction });
    return span === null ? 0 : Math.max(0, Math.min(span[1], kept[1]) - Math.max(span[0], kept[0]));
  });
  const errors = channel(result, 3).map((alpha, i) => Math.abs(alpha - (1 - Math.exp(-0.02 * (lengths[i] ?? 0)))));
  // half floats, rounding of rays at edges
  expect(Math.max(...errors)).toBeLessThan(0.003);
  const cut = lengths.filter((length) => length === 0).length;
  expect(cut).toBeGreaterThan(500);
  expect(lengths.length - cut).toBeGreaterThan(500);
});

test("the cut face of a solid ball is a flat disc, lit as such and covered by nothing that is cut away", async () => {
  const result = await march({ field: "ball", segment: "visible", clip: [front] });
  const light = keyLight(result.camera);
  let inside = 0;
  raysOf(result, frame).forEach(({ origin, direction }, i) => {
    const hit = addScaled(origin, direction, keptSpan([front], { origin, direction })[0]);
    const away = Math.hypot(...subtract(hit, middle));
    const drawn = result.pixels.slice(4 * i, 4 * i + 4);
    // the outline is a pixel of its own
    if (away < 13.3) {
      inside += 1;
      const lit = litSurface([0, 1, 0], [0, -1, 0], scale(direction, -1), result.camera.up, light);
      const off = [...lit, 1].map((value, c) => Math.abs(value - (drawn[c] ?? 0)));
      // half floats of up to 2
      expect(Math.max(...off)).toBeLessThan(0.004);
    }
  });
  expect(inside).toBeGreaterThan(500);
});

test("an iso-ball in a box is seen where a ray meets both", async () => {
  const clip = planesOf(box, frame);
  const result = await march({ field: "ball", extinction: 1, optics: { blend: "iso", isoValue: 0 }, clip });
  const counts = { seen: 0, cut: 0 };
  raysOf(result, frame).forEach(({ origin, direction }, i) => {
    const kept = keptSpan(clip, { origin, direction });
    const through = (radius: number): boolean => {
      const ball = throughBall(origin, direction, radius);
      return ball !== null && Math.min(ball[1], kept[1]) - Math.max(ball[0], kept[0]) > 0.5 * (14 - radius);
    };
    const alpha = result.pixels[4 * i + 3];
    if (through(13.5)) {
      counts.seen += 1;
      expect([i, alpha]).toEqual([i, 1]);
    } else if (!through(14.5)) {
      counts.cut += throughBall(origin, direction, 13.5) === null ? 0 : 1;
      expect([i, alpha]).toEqual([i, 0]);
    }
  });
  expect(Math.min(counts.seen, counts.cut)).toBeGreaterThan(200);
});

test.each(["shaded", "mip", "iso"] as const)(
  "in mode %s leaping over empty bricks changes no pixel of a cut scan",
  async (blend) => {
    const optics = { blend, isoValue: 250, window: { window: 400, level: 300 } };
    const cut = { field: "ball", softTissue: 0.6, optics, clip: [oblique, ...planesOf(box, frame)] } as const;
    const skipped = await march({ ...cut, skip: true });
    const visited = await march({ ...cut, skip: false });
    const differing = skipped.pixels.filter((value, i) => Math.abs(value - (visited.pixels[i] ?? 0)) > 2e-3);
    expect(differing.length).toBeLessThan(skipped.pixels.length / 1000);
    expect(Math.max(...channel(skipped, 3))).toBeGreaterThan(0.2);
  },
);

test("a cut surface is closed by a flat face in its colour where the scan has its segment", async () => {
  const lighting = { occlusion: 0, shadow: 0 };
  const ball = { field: "ball", spacing: [1, 1, 1], from: "A", stepsPerVoxel: 1, extinction: 0, lighting } as const;
  const surfaces = [
    { centre: middle, radius: 14, sectors: 4, appearance: { colour: [0.7, 0, 0] as const, range: [0, 3000] as const } },
  ];
  const pixels = await show({ scan: { ...ball, clip: [front] }, surfaces });
  const result = await march({ ...ball });
  const light = keyLight(result.camera);
  let inside = 0;
  raysOf(result, frame).forEach(({ origin, direction }, i) => {
    const hit = addScaled(origin, direction, keptSpan([front], { origin, direction })[0]);
    if (Math.hypot(...subtract(hit, middle)) < 13) {
      inside += 1;
      const [red] = litSurface(linearFromSrgb([0.7, 0, 0]), [0, -1, 0], scale(direction, -1), result.camera.up, light);
      const seen = 255 * (1.055 * red ** (1 / 2.4) - 0.055);
      expect(Math.abs(seen - (pixels[4 * i] ?? 0))).toBeLessThan(3);
    }
  });
  expect(inside).toBeGreaterThan(500);
});

test.each([false, true])("a cut translucent surface is closed by a face; orthographic %s", async (orthographic) => {
  const lighting = { occlusion: 0, shadow: 0 };
  const ball = {
    field: "ball",
    spacing: [1, 1, 1],
    from: "A",
    stepsPerVoxel: 1,
    extinction: 0,
    lighting,
    orthographic,
  } as const;
  const appearance = { colour: [0.7, 0, 0] as const, opacity: 0.4 };
  const cut = async (range: readonly [number, number] | null): Promise<number[]> =>
    show({
      scan: { ...ball, clip: [front] },
      surfaces: [{ centre: middle, radius: 14, sectors: 4, appearance: { ...appearance, range } }],
    });
  const [closed, hollow] = [await cut([0, 3000]), await cut(null)];
  const result = await march({ ...ball });
  const light = keyLight(result.camera);
  let inside = 0;
  raysOf(result, frame).forEach(({ origin, direction }, i) => {
    const hit = addScaled(origin, direction, keptSpan([front], { origin, direction })[0]);
    const away = Math.hypot(...subtract(hit, middle));
    const seen = (pixels: readonly number[]): number => (pixels[4 * i] ?? 0) / 255;
    if (away < 13) {
      inside += 1;
      const [red] = litSurface(linearFromSrgb([0.7, 0, 0]), [0, -1, 0], scale(direction, -1), result.camera.up, light);
      const [behind] = linearFromSrgb([seen(hollow), 0, 0]);
      const expected = 0.4 * red + 0.6 * behind;
      expect(Math.abs(1.055 * expected ** (1 / 2.4) - 0.055 - seen(closed))).toBeLessThan(4 / 255);
    } else if (away > 15) {
      expect(seen(closed)).toBe(seen(hollow));
    }
  });
  expect(inside).toBeGreaterThan(500);
});

/** Seen nearly from its edge, so that it takes whole rays. */
const aside: Plane = { normal: normalize([0.9, -0.2, 0.4]), offset: dot(normalize([0.9, -0.2, 0.4]), [26, 20, 27]) };

test("of a cut surface that is seen which is left, from outside and from within", async () => {
  const air = { field: "flat", spacing: [1, 1, 1], from: "A", stepsPerVoxel: 1, extinction: 0 } as const;
  const surfaces = [{ centre: middle, radius: 12, sectors: 4, appearance: { colour: [1, 0, 0] as const } }];
  const pixels = await show({ scan: { ...air, clip: [aside] }, surfaces });
  const { camera, extent } = await march({ ...air });
  const counts = { seen: 0, cut: 0 };
  raysOf({ pixels: [], camera, extent }, frame).forEach(({ origin, direction }, i) => {
    const left = (radius: number, room: number): boolean =>
      (throughBall(origin, direction, radius) ?? []).some(
        (t) => dot(aside.normal, addScaled(origin, direction, t)) < aside.offset - room,
      );
    const [r = 0, g = 0] = pixels.slice(4 * i, 4 * i + 2);
    const red = r > 1.6 * g && r > 30;
    // facets lie up to 0.1 % inside of the ball, and edges are a pixel wide
    if (left(11.5, 0.5)) {
      counts.seen += 1;
      expect([i, red]).toEqual([i, true]);
    } else if (!left(12.5, -0.5)) {
      counts.cut += throughBall(origin, direction, 11.5) === null ? 0 : 1;
      expect([i, red]).toEqual([i, false]);
    }
  });
  expect(counts.seen).toBeGreaterThan(500);
  expect(counts.cut).toBeGreaterThan(100);
});
