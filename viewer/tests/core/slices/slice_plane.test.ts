import { describe, expect, it } from "vitest";
import { edgeLetters } from "../../../src/core/geometry/anatomy";
import type { Camera } from "../../../src/core/geometry/camera";
import {
  fitSlice,
  panSlice,
  placeOnSlice,
  planeThrough,
  pointOnSlice,
  sliceAxes,
  sliceNames,
  sliceStep,
  zoomSlice,
} from "../../../src/core/slices/slice_plane";
import { cross, dot, normalize, type Vec3 } from "../../../src/core/geometry/vector";

const upright: readonly [Vec3, Vec3, Vec3] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
const camera: Camera = {
  target: [0, 0, 0],
  distance: 100,
  right: [0.6, 0.8, 0],
  up: [0, 0, 1],
  back: [0.8, -0.6, 0],
  field: 0.4,
  parallel: null,
};
const viewport = { width: 400, height: 300 };
const cube: Vec3[] = [[0, 0, 0], [200, 0, 0], [0, 100, 0], [0, 0, 50], [200, 100, 50]];

describe("axes", () => {
  it.each([
    ["axial", { right: "L", left: "R", top: "A", bottom: "P" }],
    ["coronal", { right: "L", left: "R", top: "S", bottom: "I" }],
    ["sagittal", { right: "P", left: "A", top: "S", bottom: "I" }],
  ] as const)("shows %s slices as radiologists see them, whichever way the scan's axes run", (name, letters) => {
    const flipped = upright.map((axis) => axis.map((c) => -c)) as unknown as typeof upright;
    const turned = [upright[2], upright[0], upright[1]] as const;
    for (const axes of [upright, flipped, turned]) {
      const { right, up } = sliceAxes(name, axes, camera);
      expect(edgeLetters(right, up, true)).toEqual(letters);
    }
  });

  it("follows the axes of a scan that lies obliquely", () => {
    const tilted: readonly [Vec3, Vec3, Vec3] = [[1, 0, 0], [0, 0.8, 0.6], [0, -0.6, 0.8]];
    const axes = sliceAxes("axial", tilted, camera);
    expect(Math.abs(dot(axes.toward, tilted[2]))).toBeCloseTo(1, 9);
    expect(dot(axes.up, tilted[1])).toBeCloseTo(-1, 9);
  });

  it.each(sliceNames)("are a right-handed frame in %s slices", (name) => {
    const { right, up, toward } = sliceAxes(name, upright, camera);
    expect(dot(cross(right, up), toward)).toBeCloseTo(1, 9);
  });
});

describe("a plane", () => {
  const axes = sliceAxes("axial", upright, camera);
  const view = fitSlice(axes, cube, viewport);

  it("shows all of the scan", () => {
    for (const corner of cube) {
      const { x, y } = placeOnSlice(planeThrough([100, 50, 10], axes, view), corner, viewport);
      expect(x).toBeGreaterThan(0);
      expect(x).toBeLessThan(viewport.width);
      expect(y).toBeGreaterThan(0);
      expect(y).toBeLessThan(viewport.height);
    }
  });

  it("goes through the point that was asked for, and gives places back", () => {
    const plane = planeThrough([30, 40, 12.5], axes, view);
    const place = placeOnSlice(plane, [30, 40, 12.5], viewport);
    expect(place.before).toBeCloseTo(0, 9);
    const point = pointOnSlice(plane, place.x, place.y, viewport);
    expect(point[0]).toBeCloseTo(30, 9);
    expect(point[1]).toBeCloseTo(40, 9);
    expect(point[2]).toBeCloseTo(12.5, 9);
  });

  it("moves with the mouse, and zooms about it", () => {
    const plane = planeThrough([30, 40, 12.5], axes, view);
    const held = pointOnSlice(plane, 120, 80, viewport);
    const panned = { ...plane, ...panSlice(plane, 10, -5) };
    expect(placeOnSlice(panned, held, viewport)).toMatchObject({ x: expect.closeTo(130, 6), y: expect.closeTo(75, 6) });
    const zoomed = { ...plane, ...zoomSlice(plane, 0.5, 120, 80, viewport) };
    expect(zoomed.pixel).toBeCloseTo(plane.pixel / 2, 9);
    expect(placeOnSlice(zoomed, held, viewport)).toMatchObject({ x: expect.closeTo(120, 6), y: expect.closeTo(80, 6) });
  });

  it("does not zoom beyond what can be seen, nor to what is no number", () => {
    const plane = planeThrough([30, 40, 12.5], axes, view);
    expect(zoomSlice(plane, 1e-9, 0, 0, viewport).pixel).toBeGreaterThan(0);
    expect(zoomSlice(plane, 1e9, 0, 0, viewport).pixel).toBeLessThan(100);
    expect(zoomSlice(plane, Number.NaN, 0, 0, viewport).pixel).toBeGreaterThan(0);
  });
});

it("steps by a voxel along the slice's normal", () => {
  const frame = { axes: upright, spacing: [0.7, 0.7, 2.5] } as unknown as Parameters<typeof sliceStep>[1];
  expect(sliceStep(sliceAxes("axial", upright, camera), frame)).toBeCloseTo(2.5, 9);
  expect(sliceStep(sliceAxes("coronal", upright, camera), frame)).toBeCloseTo(0.7, 9);
  const toward = normalize([1, 0, 1]);
  const between = sliceStep({ ...sliceAxes("axial", upright, camera), toward }, frame);
  expect(between).toBeGreaterThan(0.7);
  expect(between).toBeLessThan(2.5);
});
