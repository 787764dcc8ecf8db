/** Numbers of slices, their positions, and the way from one to the next. */
import { describe, expect, it, test } from "vitest";
import { sliceNumber, slicePosition, slicesBehind, stepSlices } from "../../../src/core/slices/slice_stack";
import { sliceAxes } from "../../../src/core/slices/slice_plane";
import { frameOf } from "../../../src/core/scan/scan_volume";
import { rotateAbout, type Vec3 } from "../../../src/core/geometry/vector";
import type { Camera } from "../../../src/core/geometry/camera";
import type { Scan } from "../../../src/core/protocol";
import { transformPoint } from "../../../src/core/geometry/affine";

const camera = {} as Camera;

/** A scan of 20 × 30 × 11 voxels of 0.8 × 0.9 × 5 mm, turned about an axis. */
function scanAt(angle: number, mirrored = false) {
  const edges = ([[0.8, 0, 0], [0, 0.9, 0], [0, 0, mirrored ? -5 : 5]] as const).map((edge) =>
    rotateAbout(edge, [0.6, 0, 0.8], angle),
  );
  const rows = [0, 1, 2].flatMap((row) => [...edges.map((edge) => edge[row as 0 | 1 | 2]), [7, -3, 40][row] ?? 0]);
  return frameOf({ dimensions: [20, 30, 11], patient_from_grid: [...rows, 0, 0, 0, 1], slope: 1, intercept: 0 } as unknown as Scan);
}

describe.each([0, 0.2])("of a scan turned by %d", (angle) => {
  it.each([false, true])("every slice is passed, once each, from end to end (mirrored: %s)", (mirrored) => {
    const frame = scanAt(angle, mirrored);
    const axes = sliceAxes("axial", frame.axes, camera);
    let point: Vec3 = transformPoint(frame.sceneFromGrid, [10, 12, 6]);
    point = stepSlices(point, axes, frame, -100);
    expect(slicesBehind(point, axes, frame)).toEqual({ number: 0, count: 10 });
    const numbers = [sliceNumber(point, axes, frame)?.number];
    for (let i = 0; i < 12; ++i) {
      point = stepSlices(point, axes, frame, 1);
      numbers.push(sliceNumber(point, axes, frame)?.number);
      // in the middle of voxels
      expect((transformPoint(frame.gridFromScene, point)[2] + 100.5) % 1).toBeCloseTo(0, 9);
    }
    const all = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11];
    const upward = numbers[0] === 1;
    expect(numbers).toEqual(upward ? [...all, 11, 11] : [...all.reverse(), 1, 1]);
  });
});

test("an oblique slice has no number, and steps by the size of a voxel along its normal", () => {
  const frame = scanAt(0);
  const axes = { right: [1, 0, 0], up: [0, 0.8, 0.6], toward: [0, -0.6, 0.8] } as const;
  expect(sliceNumber([0, 0, 0], axes, frame)).toBeNull();
  expect(slicesBehind([0, 0, 0], axes, frame)).toBeNull();
  const [, y, z] = stepSlices([0, 0, 0], axes, frame, 2);
  expect(Math.hypot(y, z)).toBeCloseTo(2 / Math.hypot(0.6 / 0.9, 0.8 / 5), 9);
});

test("a position is named by the side of the body, or by the scan's axis where sides are not known", () => {
  const axial = { right: [1, 0, 0], up: [0, -1, 0], toward: [0, 0, -1] } as const;
  expect(slicePosition([3, 4, 806.04], axial, true)).toBe("S 806.0\u202fmm");
  expect(slicePosition([3, 4, -2], axial, true)).toBe("I 2.0\u202fmm");
  expect(slicePosition([3, 4, -2], axial, false)).toBe("z −2.0\u202fmm");
  expect(slicePosition([-12.5, 0, 0], { ...axial, toward: [1, 0, 0] }, true)).toBe("R 12.5\u202fmm");
});
