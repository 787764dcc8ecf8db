/**
 * Saved pictures in a real browser, drawn tile by tile with the real shaders, against geometry: a ball of
 * 14 mm in a scan of 48³ mm, as the scan has it and as a surface. Tiles of software GL are of 192².
 */
import { afterAll, beforeAll, expect, test } from "vitest";
import { rayThrough, type Camera, type Viewport } from "../../src/core/geometry/camera";
import { eyeCamera, eyesOf, firstStereo, viewportOf, type Stereo } from "../../src/core/view/stereo";
import { dot, length, subtract, type Vec3 } from "../../src/core/geometry/vector";
import { openGlBrowser, type GlBrowser } from "./browser";
import type { MarchTest } from "./scenes_page";
import type { ScreenTest } from "./screen_page";

const middle: Vec3 = [24, 24, 24];
/** Of a tile and a bit in each direction. */
const size = { width: 206, height: 200 };
let browser: GlBrowser;

beforeAll(async () => {
  browser = await openGlBrowser();
});

afterAll(async () => {
  await browser.close();
});

type Snapshot = Awaited<ReturnType<NonNullable<Window["glTests"]>["snapshot"]>>;

function snapshot(what: ScreenTest, transparent: boolean): Promise<Snapshot> {
  return browser.page.evaluate(
    ([t, s, clear]) => window.glTests?.snapshot(t, s, clear) ?? Promise.reject(new Error("no page")),
    [what, size, transparent] as const,
  );
}

/** How far the ray of a place passes by the middle [mm]. */
function awayAt(camera: Camera, x: number, y: number, seen: Viewport): number {
  const { origin, direction } = rayThrough(camera, x, y, seen);
  const to = subtract(middle, origin);
  return Math.sqrt(Math.max(0, length(to) ** 2 - dot(to, direction) ** 2));
}

/** How far the ray of each pixel passes by the middle [mm], rows from the top. */
function passes({ camera }: Snapshot): number[] {
  return Array.from({ length: size.width * size.height }, (_, i) =>
    awayAt(camera, (i % size.width) + 0.5, Math.floor(i / size.width) + 0.5, size),
  );
}

const green: MarchTest = { field: "ball", spacing: [1, 1, 1], from: "A", stepsPerVoxel: 2, segment: "visible" };
const air: MarchTest = { field: "flat", spacing: [1, 1, 1], from: "A", stepsPerVoxel: 1, extinction: 0 };

test.each([
  ["of the scan", { scan: green }],
  [
    "of a surface",
    { scan: air, surfaces: [{ centre: middle, radius: 14, sectors: 4, appearance: { colour: [0, 1, 0] as const } }] },
  ],
  ["orthographic", { scan: { ...green, orthographic: true } }],
] as const)("a transparent picture %s has the ball's outline across all tiles", async (_, what) => {
  const taken = await snapshot(what, true);
  let inside = 0;
  passes(taken).forEach((away, i) => {
    // a step of the ray beside the outline
    if (Math.abs(away - 14) > 0.3) {
      inside += away < 14 ? 1 : 0;
      expect([i, taken.saved[4 * i + 3]]).toEqual([i, away < 14 ? 255 : 0]);
    }
  });
  expect(inside).toBeGreaterThan(3000);
  expect(taken.shares).toHaveLength(4);
  expect(taken.shares.at(-1)).toBe(1);
  // the screen is as it was
  expect(taken.after).toEqual(taken.before);
});

const pairs: readonly Stereo[] = [
  { ...firstStereo, mode: "side", separation: 0.2 },
  { ...firstStereo, mode: "side", squeezed: true, swapped: true, separation: 0.2 },
  { ...firstStereo, mode: "stacked", separation: 0.2 },
];

test.each(pairs)("each eye of a pair has what it sees: $mode, squeezed $squeezed", async (stereo) => {
  const { camera, saved } = await snapshot({ scan: green, stereo, behind: 20 }, true);
  const seen = viewportOf(stereo, size);
  for (const { aside, rect } of eyesOf(stereo, size)) {
    const eye = eyeCamera(camera, aside);
    let inside = 0;
    for (let y = 0; y < rect.height; ++y) {
      for (let x = 0; x < rect.width; ++x) {
        const away = awayAt(eye, ((x + 0.5) * seen.width) / rect.width, ((y + 0.5) * seen.height) / rect.height, seen);
        if (Math.abs(away - 14) > 0.3) {
          inside += away < 14 ? 1 : 0;
          expect([x, y, saved[4 * (rect.x + x + size.width * (rect.y + y)) + 3]]).toEqual([x, y, away < 14 ? 255 : 0]);
        }
      }
    }
    expect(inside).toBeGreaterThan(500);
  }
});

test("a saved anaglyph has red of the left eye and cyan of the right one, across all tiles", async () => {
  const stereo: Stereo = { ...firstStereo, mode: "anaglyph", separation: 0.2 };
  const { camera, saved, shares } = await snapshot({ scan: green, stereo, behind: 20 }, true);
  expect(shares).toHaveLength(4);
  const [left, right] = eyesOf(stereo, size).map(({ aside }) => eyeCamera(camera, aside));
  const counts = { left: 0, right: 0, both: 0, none: 0 };
  for (let i = 0; i < size.width * size.height; ++i) {
    const place = [(i % size.width) + 0.5, Math.floor(i / size.width) + 0.5] as const;
    const [byLeft, byRight] = [awayAt(left ?? camera, ...place, size), awayAt(right ?? camera, ...place, size)];
    if (Math.abs(byLeft - 14) > 0.3 && Math.abs(byRight - 14) > 0.3) {
      const seenBy = byLeft < 14 ? (byRight < 14 ? "both" : "left") : byRight < 14 ? "right" : "none";
      const [red = 0, grn = 0, , opacity] = saved.slice(4 * i, 4 * i + 4);
      counts[seenBy] += 1;
      expect([i, opacity, red > 10, grn > 10]).toEqual([i, seenBy === "none" ? 0 : 255, byLeft < 14, byRight < 14]);
    }
  }
  expect(Math.min(...Object.values(counts))).toBeGreaterThan(300);
});

test("an opaque picture has the page's background, without seams, and the colours of the transparent one", async () => {
  const [opaque, clear] = [await snapshot({ scan: green }, false), await snapshot({ scan: green }, true)];
  const at = (taken: Snapshot, x: number, y: number): number[] =>
    taken.saved.slice(4 * (x + size.width * y), 4 * (x + size.width * y) + 4);
  for (let y = 0; y < size.height; y += 7) {
    for (const x of [5, 96, 191, 192, 200]) {
      const [one, other] = [at(opaque, x, y), at(clear, x, y)];
      expect(one[3]).toBe(255);
      if (other[3] === 255) {
        // grain of half a step
        expect(Math.max(...[0, 1, 2].map((c) => Math.abs((one[c] ?? 0) - (other[c] ?? 0))))).toBeLessThanOrEqual(1);
      }
    }
    // the ground is smooth where tiles meet
    const [left, right] = [at(opaque, 191, y), at(opaque, 192, y)];
    expect(Math.max(...[0, 1, 2].map((c) => Math.abs((left[c] ?? 0) - (right[c] ?? 0))))).toBeLessThanOrEqual(2);
  }
});

test("a picture that is cancelled is not drawn to its end", async () => {
  const said = await browser.page.evaluate(
    (t) => window.glTests?.cancelled(t) ?? Promise.reject(new Error("no page")),
    green,
  );
  expect(said).toBe("cancelled after 1");
});
