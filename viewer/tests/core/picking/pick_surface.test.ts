import { expect, test } from "vitest";
import { defaultSoftTissueAndBone, transferFunctionOf } from "../../../src/core/appearance/soft_tissue_and_bone";
import { firstLighting, type Appearance } from "../../../src/core/appearance/appearance";
import { shadedOptics } from "../../../src/core/appearance/optics";
import { pickSurface } from "../../../src/core/picking/pick_surface";
import { shownRanges } from "../../../src/core/segments/shown_segments";
import { distance, normalize, subtract, type Vec3 } from "../../../src/core/geometry/vector";
import { Random } from "../../support/random";
import { scanOf, segment, volumeOf } from "../../support/volumes";

// a ball of bone, radius 12 mm, in air, its edge blurred over 2 mm
const scan = scanOf([48, 48, 24], [1, 1, 2], [10, -30, 500]);
const centre: Vec3 = [34, -6, 524];
const radius = 12;
const volume = volumeOf(scan, ([x, y, z]) => {
  const point: Vec3 = [10 + x, -30 + y, 500 + 2 * z];
  return Math.min(1000, Math.max(-1000, -1000 * (distance(point, centre) - radius)));
});

function appearance(visible: boolean): Appearance {
  return {
    transferFunction: transferFunctionOf({ ...defaultSoftTissueAndBone({ softTissue: 40, bone: 250 }), softTissue: 0 }),
    ranges: shownRanges([{ ...segment, visible }], scan),
    edgeGradient: 40,
    lighting: firstLighting,
    optics: shadedOptics,
  };
}

test("a visible segment is met where its surface is, from every side", () => {
  const random = new Random(31);
  for (let i = 0; i < 100; ++i) {
    const direction = normalize(random.vector(1));
    const origin: Vec3 = [centre[0] - 60 * direction[0], centre[1] - 60 * direction[1], centre[2] - 60 * direction[2]];
    const picked = pickSurface(volume, appearance(true), { origin, direction });
    expect(picked?.segment).toBe(1);
    // trilinear interpolation over slices of 2 mm moves the surface by up to half a slice
    expect(Math.abs(distance(picked?.point ?? origin, centre) - radius)).toBeLessThan(1);
    expect(distance(picked?.point ?? origin, origin)).toBeLessThan(60);
  }
});

test("a hidden segment is seen through, and so is air", () => {
  const ray = { origin: subtract(centre, [0, 100, 0]), direction: [0, 1, 0] as const };
  expect(pickSurface(volume, appearance(false), ray)).toBeNull();
  expect(pickSurface(volume, appearance(true), { ...ray, direction: normalize([1, 1, 0]) })).toBeNull();
});

test("without a segment, bone is met by its opacity", () => {
  const ray = { origin: subtract(centre, [0, 100, 0]), direction: [0, 1, 0] as const };
  const picked = pickSurface(volume, { ...appearance(true), ranges: [] }, ray);
  expect(picked?.segment).toBeNull();
  // opacity 0.5 is reached within the blurred edge
  expect(Math.abs(distance(picked?.point ?? ray.origin, centre) - radius)).toBeLessThan(1.5);
  expect(picked?.value).toBeGreaterThan(0);
});
