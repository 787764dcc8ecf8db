import { expect, test } from "vitest";
import { contentHull } from "../../../src/core/scan/content_hull";
import { firstView, extentOf } from "../../../src/core/geometry/camera";
import {
  asSentence,
  formatBytes,
  formatFixed,
  formatPercent,
  formatPlace,
  plainPoint,
  plainText,
  plural,
  formatCount,
  formatVolume,
  formatPoint,
  formatSeconds,
  formatSpacing,
  formatValue,
  formatWithin,
} from "../../../src/core/base/format";
import { splitShortcut } from "../../../src/core/base/shortcuts";
import { farthestAhead, moveInDepth, moveInView } from "../../../src/core/touch/hand";
import { histogramPath, shareWithin } from "../../../src/core/scan/histogram";
import { scaleBar } from "../../../src/core/view/scale_bar";
import { rangeHolding, shownRanges } from "../../../src/core/segments/shown_segments";
import { subsamplingStep } from "../../../src/core/scan/subsampling";
import { distance, dot, subtract, type Vec3 } from "../../../src/core/geometry/vector";
import { Random } from "../../support/random";
import { scanOf, segment, volumeOf } from "../../support/volumes";

test("a text for other programs has numbers that they read: a hyphen, no groups, usual spaces", () => {
  const told = `${formatValue(-743.5, "HU")}, ${formatCount(1_234_567)} voxels, ${formatVolume(2_500_000)}`;
  expect(told).not.toBe(plainText(told));
  expect(plainText(told)).toBe("-743.5 HU, 1234567 voxels, 2500 ml");
});

test("the scale bar is round, fits, and uses its room", () => {
  const random = new Random(41);
  for (let i = 0; i < 300; ++i) {
    const mmPerPixel = 10 ** random.between(-3, 2);
    const { pixels, label } = scaleBar(mmPerPixel, 120);
    expect(pixels).toBeLessThanOrEqual(120 * (1 + 1e-12));
    // between two round lengths lies a factor of 2.5 at most
    expect(pixels).toBeGreaterThan(120 / 2.5 - 1e-9);
    expect(label).toMatch(/^(1|2|5)0*\u202fcm$|^(1|2|5)0*\u202fmm$|^0\.0*(1|2|5)\u202fmm$/);
  }
  expect(scaleBar(0.5, 120)).toEqual({ pixels: 100, label: "5\u202fcm" });
});

test("a scan is subsampled only as far as the GPU needs it", () => {
  const limits = { edge: 2048, values: 2 ** 29 };
  expect(subsamplingStep([512, 512, 512], limits)).toBe(1);
  expect(subsamplingStep([3000, 100, 100], limits)).toBe(2);
  expect(subsamplingStep([1024, 1024, 1024], limits)).toBe(2);
});

test("the histogram's drawing stays inside its frame and closes at the bottom", () => {
  const path = histogramPath({ low: 0, high: 100, counts: [5, 0, 100000, 7] }, [0, 100], { width: 200, height: 50 });
  const numbers = [...path.matchAll(/-?[\d.]+/g)].map(Number);
  expect(Math.max(...numbers)).toBeLessThanOrEqual(200);
  expect(Math.min(...numbers)).toBeGreaterThanOrEqual(0);
  expect(path).toMatch(/^M0,50\.0L.*L200\.0,50\.0Z$/);
});

test("shares of values are counted inside the bins too", () => {
  const histogram = { low: 0, high: 4, counts: [10, 10, 10, 10] };
  expect(shareWithin(histogram, 1, 3)).toBeCloseTo(0.5);
  expect(shareWithin(histogram, 0.5, 1)).toBeCloseTo(0.125);
});

test("where segments share a value the visible one wins", () => {
  const scan = scanOf([8, 8, 8], [1, 1, 1]);
  const ranges = shownRanges(
    [
      { ...segment, id: 1, visible: false, range: [0, 100] },
      { ...segment, id: 2, visible: true, range: [50, 200] },
      { ...segment, id: 3, visible: true, range: null },
    ],
    scan,
  );
  expect(ranges.map(({ id }) => id)).toEqual([1, 2]);
  expect(rangeHolding(ranges, 32768 + 75)?.id).toBe(2);
  expect(rangeHolding(ranges, 32768 + 25)?.id).toBe(1);
  expect(rangeHolding(ranges, 32768 + 250)).toBeUndefined();
});

test("content is framed by its own outline, not by the air around it", () => {
  const scan = scanOf([64, 64, 64], [1, 1, 1]);
  const volume = volumeOf(scan, (p) => (distance(p, [20, 40, 30]) < 10 ? 500 : -1000));
  const hull = contentHull(volume.bricks, 1, [1, 1, 1], (_low, high) => high > 32768);
  const { centre, radius } = extentOf(hull);
  // bricks of 8 voxels blur the outline by one brick
  expect(distance(centre, [20, 40, 30])).toBeLessThan(8);
  expect(radius).toBeLessThan(24);
  expect(contentHull(volume.bricks, 1, [1, 1, 1], () => false)).toHaveLength(8);
});

test("the hand follows the view's axes and stays within reach of the probe", () => {
  const outline: Vec3[] = [[0, 0, 0], [100, 100, 100]];
  const viewport = { width: 800, height: 600 };
  const camera = firstView(extentOf(outline), viewport);
  const probe: Vec3 = [50, 50, 50];
  const right = subtract(moveInView(probe, probe, 10, 0, camera, viewport), probe);
  expect(dot(right, camera.right)).toBeGreaterThan(0);
  expect(Math.abs(dot(right, camera.up)) + Math.abs(dot(right, camera.back))).toBeLessThan(1e-9);
  const away = subtract(moveInDepth(probe, probe, 10, camera, viewport), probe);
  expect(dot(away, camera.back)).toBeLessThan(0);
  expect(distance(moveInDepth(probe, probe, 1e6, camera, viewport), probe)).toBeCloseTo(farthestAhead);
});

test("numbers are written with units and a fixed number of digits", () => {
  expect(formatPoint([-12.345, 4, 806.06])).toBe("−12.3 4.0 806.1");
  expect(formatCount(1234567)).toBe("1\u2009234\u2009567");
  expect([0, 0.0125, 1, 36.24, 999.4, 999.7, 1000, 12_345, 99_960, 2_054_400].map(formatVolume)).toEqual([
    "0\u202fmm³", "0.0125\u202fmm³", "1\u202fmm³", "36.2\u202fmm³", "999\u202fmm³",
    "1.00\u202fml", "1.00\u202fml", "12.3\u202fml", "100\u202fml", "2\u2009054\u202fml",
  ]);
  expect(formatSpacing([0.703, 0.703, 2.5])).toBe("0.703 × 0.703 × 2.5\u202fmm");
  expect(formatValue(3071)).toBe("3071");
  expect(formatValue(1288.3400000001)).toBe("1288.34");
  expect(formatValue(-1024, "HU")).toBe("−1024\u202fHU");
  expect(formatFixed(-0.4, 1)).toBe("−0.4");
  expect(formatPercent(0.05)).toBe("5\u202f%");
  expect(formatPlace([1, -2, -3], false)).toBe("x 1.0  y −2.0  z −3.0\u202fmm");
  expect([plainPoint([-1, 0, 2])]).toEqual(["-1.0 0.0 2.0"]);
  // a 500th of the span shows
  expect(formatWithin(-512.4, 4000)).toBe("−512");
  expect(formatWithin(4.4, 14.68)).toBe("4.40");
  expect(formatWithin(0.00071, 0.003)).toBe("0.000710");
  expect([0, 7.99, 61, 754].map(formatSeconds)).toEqual(["0:00", "0:07", "1:01", "12:34"]);
  expect(formatBytes(15 * 2 ** 20)).toBe("15\u202fMiB");
  expect(formatBytes(3 * 2 ** 30)).toBe("3.0\u202fGiB");
});

test("a sentence of the engine begins large and ends with a point, but for a file's name", () => {
  const told = ["no scan is open. Open one first", "bone is locked.", "ct.mha is empty", "Saving …"];
  expect(told.map(asSentence)).toEqual([
    "No scan is open. Open one first.", "Bone is locked.", "ct.mha is empty.", "Saving …",
  ]);
});

test("one of a thing is told in the singular", () => {
  expect([0, 1, 2, 1234].map((count) => plural(count, ["seed", "seeds"]))).toEqual([
    "0 seeds", "1 seed", "2 seeds", "1\u2009234 seeds",
  ]);
  expect([1, 2].map((count) => plural(count, ["change waits", "changes wait"]))).toEqual([
    "1 change waits", "2 changes wait",
  ]);
});

test("the key at the end of a control's words is told apart, and no other word in brackets", () => {
  expect(splitShortcut("Show all (F)")).toEqual({ text: "Show all", key: "F" });
  expect(splitShortcut("Redo (Ctrl+Shift+Z)").key).toBe("Ctrl+Shift+Z");
  expect(splitShortcut("No cut (Esc)").key).toBe("Esc");
  expect(splitShortcut("Delete (Ctrl+Z brings it back)")).toEqual({ text: "Delete (Ctrl+Z brings it back)", key: "" });
});
