import { expect, test } from "vitest";
import { extentOf, inProjection, lookFrom, orbit, pan, project, zoom } from "../../../src/core/geometry/camera";
import { dot, length } from "../../../src/core/geometry/vector";
import { mostTurned, turnedView } from "../../../src/core/view/turned_view";

const extent = extentOf([0, 1, 2, 3, 4, 5, 6, 7].map((i) => [i & 1 ? 200 : 0, i & 2 ? 150 : 0, i & 4 ? 180 : 0]));
const viewport = { width: 800, height: 600 };
const drawn = lookFrom("A", extent, viewport);

test("small turns are followed whole, with pans and zooms", () => {
  const now = zoom(pan(orbit(drawn, 0.1, -0.1), 40, 20, viewport), 0.8, extent);
  expect(turnedView(drawn, now, true)).toBe(now);
});

test("a larger turn is followed as far as it may go, about the same axis", () => {
  const now = orbit(drawn, 1, 0);
  const camera = turnedView(drawn, now, true);
  const expected = orbit(drawn, mostTurned, 0);
  expect(camera).not.toBeNull();
  for (const axis of ["right", "up", "back"] as const) {
    expect(camera?.[axis]).toEqual(expected[axis].map((each) => expect.closeTo(each, 9) as number));
  }
  // what lies in the middle of both views stays there
  expect(camera && project(camera, drawn.target, viewport)).toEqual([expect.closeTo(400, 6), expect.closeTo(300, 6)]);
  expect(camera && dot(camera.right, camera.back)).toBeCloseTo(0, 9);
  expect(camera && length(camera.up)).toBeCloseTo(1, 9);
});

test("even half a turn has an axis", () => {
  const now = orbit(drawn, Math.PI, 0);
  const camera = turnedView(drawn, now, true);
  expect(camera && camera.right.every(Number.isFinite)).toBe(true);
});

test("without depth a picture is moved and zoomed, not turned", () => {
  const moved = zoom(pan(drawn, 40, 20, viewport), 0.8, extent);
  expect(turnedView(drawn, moved, false)).toBe(moved);
  expect(turnedView(drawn, orbit(drawn, 0.02, 0), false)).toBeNull();
});

test("another projection, or a much larger scale, is not shown by what was drawn", () => {
  expect(turnedView(drawn, inProjection(drawn, true, extent), true)).toBeNull();
  expect(turnedView(drawn, zoom(drawn, 0.4, extent), true)).toBeNull();
});
