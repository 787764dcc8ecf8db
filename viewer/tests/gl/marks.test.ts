/**
 * Marks in a real browser, with the real shaders: lines are plain where nothing stands before them and faint behind
 * tissue or a surface, as wide on the screen far as near, and rings stand at their points. 96² pixels, no jitter.
 */
import { afterAll, beforeAll, expect, test } from "vitest";
import { extentOf, inProjection, lookFrom, project } from "../../src/core/geometry/camera";
import { eyeCamera, eyesOf, firstStereo } from "../../src/core/view/stereo";
import type { Vec3 } from "../../src/core/geometry/vector";
import { openGlBrowser, type GlBrowser } from "./browser";
import type { MarchTest } from "./scenes_page";
import type { ScreenTest } from "./screen_page";

const edge = 96;
const pane = { width: edge, height: edge };
const middle: Vec3 = [24, 24, 24];
const extent = extentOf([0, 1, 2, 3, 4, 5, 6, 7].map((i) => [i & 1 ? 48 : 0, i & 2 ? 48 : 0, i & 4 ? 48 : 0]));
const front = lookFrom("A", extent, pane);
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

/** Brightest of a mark's red within two pixels of a point of the scene. */
function redAt(pixels: readonly number[], point: Vec3, camera = front): number {
  const [x = NaN, y = NaN] = project(camera, point, pane) ?? [];
  let most = 0;
  for (let row = Math.floor(y) - 2; row <= Math.floor(y) + 2; ++row) {
    most = Math.max(most, pixels[4 * (Math.floor(x) + edge * (edge - 1 - row))] ?? 0);
  }
  return most;
}

const green: MarchTest = { field: "ball", spacing: [1, 1, 1], from: "A", stepsPerVoxel: 2, segment: "visible" };
const air: MarchTest = { field: "flat", spacing: [1, 1, 1], from: "A", stepsPerVoxel: 1, extinction: 0 };
const through = [[2, 24, 24], [46, 24, 24]] as const;
const before = [[2, 4, 24], [46, 4, 24]] as const;
const inside = [14, 19, 24, 29, 34];
const outside = [4, 7, 41, 44];

test.each([
  ["the scan", { scan: green }],
  ["the scan, orthographic", { scan: { ...green, orthographic: true } }],
  [
    "a surface",
    { scan: air, surfaces: [{ centre: middle, radius: 14, sectors: 4, appearance: { colour: [0, 1, 0] as const } }] },
  ],
] as const)("a line through %s is faint inside, and plain beside and before it", async (_, scene) => {
  const scan: MarchTest = scene.scan;
  const camera = inProjection(front, scan.orthographic === true, extent);
  const [bare, hidden, open] = [
    await show(scene),
    await show({ ...scene, marks: [through] }),
    await show({ ...scene, marks: [before] }),
  ];
  for (const x of inside) {
    const point: Vec3 = [x, 24, 24];
    const [none, faint] = [redAt(bare, point, camera), redAt(hidden, point, camera)];
    expect(faint).toBeGreaterThan(none + 20);
    expect(faint).toBeLessThan(150);
    expect(redAt(open, [x, 4, 24], camera)).toBeGreaterThan(220);
  }
  for (const x of outside) {
    expect(redAt(hidden, [x, 24, 24], camera)).toBeGreaterThan(220);
  }
});

test("rings stand at points, and lines are as wide near as far, for each eye", async () => {
  const stereo = { ...firstStereo, mode: "stacked", squeezed: true, separation: 0.1 } as const;
  // along the view, from near to far
  const away: readonly Vec3[] = [[8, 4, 12], [40, 44, 36]];
  const pixels = await show({ scan: air, marks: [away] });
  const widthAt = (share: number): number => {
    const [a = middle, b = middle] = away;
    const point: Vec3 = [0, 1, 2].map((i) => (a[i] ?? 0) + share * ((b[i] ?? 0) - (a[i] ?? 0))) as unknown as Vec3;
    const [x = NaN, y = NaN] = project(front, point, pane) ?? [];
    let lit = 0;
    for (let row = Math.floor(y) - 6; row <= Math.floor(y) + 6; ++row) {
      lit += (pixels[4 * (Math.floor(x) + edge * (edge - 1 - row))] ?? 0) / 255;
    }
    return lit;
  };
  expect(Math.abs(widthAt(0.3) - widthAt(0.8))).toBeLessThan(0.8);
  const both = await show({ scan: air, marks: [[middle]], stereo, behind: 15 });
  const back = {
    ...front,
    target: middle.map((c, i) => c - 15 * (front.back[i] ?? 0)) as unknown as Vec3,
    distance: front.distance + 15,
  };
  for (const { aside, rect } of eyesOf(stereo, pane)) {
    const [x = NaN, y = NaN] = project(eyeCamera(back, aside), middle, pane) ?? [];
    const redOf = (right: number): number => {
      const column = Math.floor(x + right);
      return both[4 * (column + edge * (edge - 1 - rect.y - Math.floor((y / edge) * rect.height)))] ?? 0;
    };
    // the ring at four pixels, its dark inside
    expect(Math.max(redOf(4), redOf(3.5), redOf(4.5))).toBeGreaterThan(150);
    expect(redOf(0)).toBeLessThan(60);
  }
});
