/** Two eyes before one window: parallax as geometry has it, and which eye is pointed with. */
import { expect, test } from "vitest";
import {
  eyeOf,
  extentOf,
  firstView,
  inProjection,
  project,
  rayThrough,
  type Camera,
} from "../../../src/core/geometry/camera";
import {
  eyeCamera,
  eyesOf,
  firstStereo,
  pointedEye,
  saneStereo,
  viewportOf,
  type Stereo,
} from "../../../src/core/view/stereo";
import { addScaled, cross, distance, dot, length, subtract, type Vec3 } from "../../../src/core/geometry/vector";
import { Random } from "../../support/random";

const viewport = { width: 800, height: 600 };
const extent = extentOf([[0, 0, 0], [120, 90, 60], [0, 90, 60], [120, 0, 0]]);
const camera = firstView(extent, viewport);
const parallel = inProjection(camera, true, extent);
const separation = 1 / 30;

/** A point of the scene by how far it is right of, above and before the target [mm]. */
function beside(x: number, y: number, before: number): Vec3 {
  return [[camera.right, x], [camera.up, y], [camera.back, before]].reduce<Vec3>(
    (point, [axis, by]) => addScaled(point, axis as Vec3, by as number),
    camera.target,
  );
}

/**
 * How much farther right the right eye's picture of a point is than the left one's, and how much lower [mm at the
 * target].
 */
function parallax(middle: Camera, point: Vec3): readonly [number, number] {
  const places = [-1, 1].map((side) => project(eyeCamera(middle, (side * separation) / 2), point, viewport));
  const [[leftX = NaN, leftY = NaN] = [], [rightX = NaN, rightY = NaN] = []] = places.map((place) => place ?? []);
  const pixel = (2 * middle.distance * Math.tan(middle.field / 2)) / viewport.height;
  return [(rightX - leftX) * pixel, (rightY - leftY) * pixel];
}

test.each([[0, 0], [31, -12], [-40, 22]])("what lies in the plane of the target has no parallax: %f, %f mm", (x, y) => {
  for (const middle of [camera, parallel]) {
    const [across, down] = parallax(middle, beside(x, y, 0));
    expect(across).toBeCloseTo(0, 9);
    expect(down).toBeCloseTo(0, 9);
  }
});

test.each([-80, -20, 20, 60])("%f mm before the target parallax is what the intercept theorem says", (before) => {
  const [across, down] = parallax(camera, beside(12, -7, before));
  // eyes `apart` from one another see it through the window at the target's distance
  const apart = separation * camera.distance;
  expect(across).toBeCloseTo((-apart * before) / (camera.distance - before), 9);
  expect(down).toBeCloseTo(0, 9);
  expect(parallax(parallel, beside(12, -7, before))[0]).toBeCloseTo(-separation * before, 9);
});

test("the eyes stand beside one another, a thirtieth of the distance apart, and look the same way", () => {
  const [left, right] = eyesOf({ ...firstStereo, mode: "side" }, viewport).map(({ aside }) => eyeCamera(camera, aside));
  if (left === undefined || right === undefined) throw new Error("two eyes");
  const between = subtract(eyeOf(right), eyeOf(left));
  expect(length(between)).toBeCloseTo(camera.distance / 30, 9);
  expect(dot(between, camera.right)).toBeCloseTo(camera.distance / 30, 9);
  expect([left.back, left.right, left.up]).toEqual([right.back, right.right, right.up]);
});

test("a ray through where a point is seen meets the point, for each eye and both projections", () => {
  const random = new Random(7);
  for (let i = 0; i < 200; ++i) {
    const point = beside(random.between(-40, 40), random.between(-30, 30), random.between(-50, 50));
    for (const middle of [camera, parallel]) {
      const eye = eyeCamera(middle, random.between(-0.05, 0.05));
      const [x, y] = project(eye, point, viewport) ?? [NaN, NaN];
      const { origin, direction } = rayThrough(eye, x, y, viewport);
      expect(length(direction)).toBeCloseTo(1, 12);
      expect(length(cross(subtract(point, origin), direction))).toBeLessThan(1e-9 * distance(point, origin) + 1e-9);
    }
  }
});

test("pictures fill their parts of the pane and none of the other's", () => {
  const pane = { width: 801, height: 601 };
  const rects = (stereo: Partial<Stereo>): readonly object[] =>
    eyesOf({ ...firstStereo, ...stereo }, pane).map(({ rect }) => rect);
  expect(rects({ mode: "off" })).toEqual([{ x: 0, y: 0, ...pane }]);
  expect(rects({ mode: "anaglyph" })).toEqual([{ x: 0, y: 0, ...pane }, { x: 0, y: 0, ...pane }]);
  expect(rects({ mode: "side" })).toEqual([
    { x: 0, y: 0, width: 400, height: 601 },
    { x: 401, y: 0, width: 400, height: 601 },
  ]);
  expect(rects({ mode: "stacked" })).toEqual([
    { x: 0, y: 0, width: 801, height: 300 },
    { x: 0, y: 301, width: 801, height: 300 },
  ]);
  expect(viewportOf({ ...firstStereo, mode: "side" }, pane)).toEqual({ width: 400, height: 601 });
  expect(viewportOf({ ...firstStereo, mode: "side", squeezed: true }, pane)).toEqual(pane);
});

test("the eye that is pointed with is that of the picture under the mouse; of a mixture one between both", () => {
  const aside = (stereo: Partial<Stereo>, x: number, y: number): number =>
    Math.sign(pointedEye({ ...firstStereo, ...stereo }, viewport, x, y).aside);
  expect([aside({ mode: "side" }, 10, 10), aside({ mode: "side" }, 790, 10)]).toEqual([-1, 1]);
  expect([aside({ mode: "side", swapped: true }, 10, 10), aside({ mode: "side", swapped: true }, 790, 10)]).toEqual([
    1, -1,
  ]);
  expect([aside({ mode: "stacked" }, 790, 10), aside({ mode: "stacked" }, 10, 590)]).toEqual([-1, 1]);
  expect([aside({ mode: "anaglyph" }, 10, 10), aside({ mode: "off" }, 790, 590)]).toEqual([0, 0]);
});

test("what was kept is taken where it is sane", () => {
  const kept: Stereo = { mode: "stacked", separation: 0.05, squeezed: true, swapped: true };
  expect(saneStereo(kept)).toEqual(kept);
  expect(saneStereo({ mode: "holographic", separation: 7, squeezed: 1, swapped: null })).toEqual(firstStereo);
});
