import { expect, test } from "vitest";
import { transformPoint } from "../../../src/core/geometry/affine";
import { extentOf, lookFrom, orbit, pixelSizeAt, project } from "../../../src/core/geometry/camera";
import { dragged, gizmoAxes, nearestOnRing, ringPixels, ringPoint, type Eye } from "../../../src/core/view/gizmo";
import { unmoved } from "../../../src/core/geometry/object_pose";
import { cross, dot, normalize, subtract, type Vec3 } from "../../../src/core/geometry/vector";

const viewport = { width: 800, height: 600 };
const extent = extentOf([[-60, -60, -60], [60, 60, 60]]);
const front = lookFrom("A", extent, viewport);
const eye: Eye = { camera: orbit(front, 0.5, 0.35), viewport };
const centre: Vec3 = [5, -8, 12];

function moved(pose: readonly number[]): Vec3 {
  return subtract(transformPoint(pose, centre), centre);
}

test("the disc drags an object in the view plane, by what the pointer goes", () => {
  const way = moved(dragged(unmoved, { kind: "plane" }, centre, [30, -40], eye));
  expect(dot(way, eye.camera.back)).toBeCloseTo(0, 9);
  expect(Math.hypot(...way)).toBeCloseTo(50 * pixelSizeAt(eye.camera, centre, viewport), 6);
});

test.each(gizmoAxes)("the arrow $letter drags an object along its axis only, under the pointer", ({ axis }) => {
  const way = moved(dragged(unmoved, { kind: "arrow", axis }, centre, [7, 3], eye));
  expect(Math.hypot(...cross(way, axis))).toBeCloseTo(0, 9);
  // and back where the pointer goes back
  const back = moved(dragged(unmoved, { kind: "arrow", axis }, centre, [-7, -3], eye));
  expect(dot(way, axis)).toBeCloseTo(-dot(back, axis), 9);
});

test.each(gizmoAxes)("a ring about $letter turns the held point along with the pointer", ({ axis }) => {
  for (const at of [0.3, 1.9, 4.4]) {
    const held = ringPoint(centre, axis, at, ringPixels, eye);
    const seen = (point: Vec3): readonly [number, number] => project(eye.camera, point, viewport) ?? [NaN, NaN];
    const next = seen(ringPoint(centre, axis, at + 0.02, ringPixels, eye));
    const from = seen(held);
    const pose = dragged(unmoved, { kind: "ring", axis, at }, centre, [next[0] - from[0], next[1] - from[1]], eye);
    const to = seen(transformPoint(pose, held));
    // a tenth of a pixel: the ring bends
    expect(Math.hypot(to[0] - next[0], to[1] - next[1])).toBeLessThan(0.1);
    expect(moved(pose).map(Math.abs).every((part) => part < 1e-9)).toBe(true);
    expect(nearestOnRing(centre, axis, from, eye)).toBeCloseTo(at, 0);
  }
});

test("an arrow that points at the viewer drags nothing", () => {
  const along: Eye = { camera: { ...front, target: centre }, viewport };
  const axis = normalize(along.camera.back);
  expect(moved(dragged(unmoved, { kind: "arrow", axis }, centre, [20, 20], along)).every(Number.isFinite)).toBe(true);
});
