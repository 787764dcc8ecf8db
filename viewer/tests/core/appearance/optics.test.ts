import { expect, test } from "vitest";
import { DrawnValues, drawnBy } from "../../../src/core/appearance/drawn_values";
import { valueAbove } from "../../../src/core/scan/histogram";
import { firstLighting, type Appearance } from "../../../src/core/appearance/appearance";
import {
  firstChoice, greyOf, hasDepth, opticsOf, shadedOptics, type Optics,
} from "../../../src/core/appearance/optics";
import { pickSurface } from "../../../src/core/picking/pick_surface";
import { scanOf, volumeOf } from "../../support/volumes";

const anchors = { softTissue: 40, bone: 250 };
const rescale = { slope: 1, intercept: 0 };
const clear = { value: 0, colour: [1, 1, 1], extinction: 0 } as const;

function appearanceOf(optics: Partial<Optics>): Appearance {
  const transferFunction = { points: [clear, { ...clear, value: 100 }] };
  return {
    transferFunction,
    ranges: [],
    edgeGradient: 40,
    lighting: firstLighting,
    optics: { ...shadedOptics, ...optics },
  };
}

test("each mode keeps its own window, slab and density", () => {
  const first = firstChoice(anchors, 1500);
  const mip = opticsOf({ ...first, blend: "mip", slabs: { ...first.slabs, mip: 12 } }, anchors);
  expect([mip.slab, mip.density]).toEqual([12, 1]);
  expect(greyOf(1500, mip.window)).toBeCloseTo(1);
  expect(opticsOf({ ...first, blend: "average", slabs: { ...first.slabs, average: 0 } }, anchors).slab).toBeNull();
  expect(opticsOf({ ...first, blend: "absorption" }, anchors).density).toBe(first.densities.absorption);
});

test("in a MIP values above black are drawn, of an iso-surface those that it encloses, else all", () => {
  const window = { window: 400, level: 40 };
  const any = (optics: Partial<Optics>, low: number, high: number): boolean =>
    drawnBy(appearanceOf({ window, ...optics }), rescale).any(32768 + low, 32768 + high);
  expect([any({ blend: "mip" }, -900, -161), any({ blend: "mip" }, -900, -159)]).toEqual([false, true]);
  expect([any({ blend: "iso", isoValue: 300 }, 0, 299), any({ blend: "iso", isoValue: 300 }, 301, 900)]).toEqual([
    false,
    true,
  ]);
  expect([any({ blend: "minip" }, 900, 901), any({ blend: "average" }, -1000, -999)]).toEqual([true, true]);
  expect(drawnBy(appearanceOf({}), rescale)).toBeInstanceOf(DrawnValues);
});

test("a falling rescale is drawn by its physical values", () => {
  const falling = drawnBy(appearanceOf({ blend: "mip", window: { window: 400, level: 40 } }), {
    slope: -1,
    intercept: 0,
  });
  expect([falling.any(32768 + 200, 32768 + 900), falling.any(32768 - 900, 32768 + 900)]).toEqual([false, true]);
});

test("the value that hardly any voxel exceeds is told to a bin", () => {
  const histogram = { low: 0, high: 100, counts: [900, 90, 8, 1, 1, 0, 0, 0, 0, 0] };
  expect(valueAbove(histogram, 0)).toBe(50);
  expect(valueAbove(histogram, 0.002)).toBe(30);
  expect(valueAbove({ ...histogram, counts: [] }, 0.1)).toBe(0);
});

test("a MIP is picked where its value is, an iso-surface where it begins", () => {
  const brightness = [0, 100, 300, 800, 300, 100, 0, 0];
  const volume = volumeOf(scanOf([8, 8, 8], [1, 1, 1]), ([, y]) => brightness[Math.floor(y)] ?? 0);
  const ray = { origin: [4, -10, 4], direction: [0, 1, 0] } as const;
  const at = (optics: Partial<Optics>): number | undefined => pickSurface(volume, appearanceOf(optics), ray)?.point[1];
  expect(at({ blend: "mip", window: { window: 1000, level: 500 } })).toBeCloseTo(3.5, 0);
  expect(at({ blend: "iso", isoValue: 200 })).toBeCloseTo(2, 0);
  expect(at({ blend: "mip", window: { window: 100, level: 5000 } })).toBeUndefined();
});

test("a picture can be turned by its depth but where a slab turns with the view", () => {
  expect(hasDepth({ blend: "shaded", slab: null })).toBe(true);
  expect(hasDepth({ blend: "absorption", slab: null })).toBe(true);
  expect(hasDepth({ blend: "average", slab: null })).toBe(true);
  expect(hasDepth({ blend: "average", slab: 30 })).toBe(false);
});
