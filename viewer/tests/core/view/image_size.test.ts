import { expect, test } from "vitest";
import { extentOf, firstView } from "../../../src/core/geometry/camera";
import { fitsIntoCanvas, imageSize, magnifications, mostEdge, tilesOf } from "../../../src/core/view/image_size";
import { turntable } from "../../../src/core/view/turntable";
import { distance, dot } from "../../../src/core/geometry/vector";

test("tiles cover a picture once and do not leave it", () => {
  const size = { width: 53, height: 38 };
  const hits = new Uint8Array(size.width * size.height);
  for (const { x, y, width, height } of tilesOf(size, 16)) {
    expect(Math.max(width, height)).toBeLessThanOrEqual(16);
    for (let row = y; row < y + height; ++row) {
      for (let place = x; place < x + width; ++place) {
        hits[place + row * size.width] = (hits[place + row * size.width] ?? 0) + 1;
      }
    }
  }
  expect(hits.every((count) => count === 1)).toBe(true);
});

test("a picture is as large as the screen's pixels times its magnification, up to what a canvas holds", () => {
  expect(imageSize({ width: 801, height: 600 }, 1.5, 2)).toEqual({ width: 2403, height: 1800 });
  expect(magnifications.every((factor) => fitsIntoCanvas(imageSize({ width: 1100, height: 700 }, 1, factor)))).toBe(
    true,
  );
  expect(fitsIntoCanvas({ width: mostEdge + 1, height: 10 })).toBe(false);
  expect(fitsIntoCanvas({ width: 15000, height: 15000 })).toBe(false);
});

test("a turntable goes round evenly and ends before it begins again", () => {
  const start = firstView(extentOf([[0, 0, 0], [100, 80, 60]]), { width: 300, height: 200 });
  const views = turntable(start, { seconds: 2, turns: 3, framesPerSecond: 12 });
  expect(views).toHaveLength(24);
  expect(distance(views[0]?.back ?? [0, 0, 0], start.back)).toBeLessThan(1e-12);
  // three turns in 24 frames: the eighth of them is the first again
  expect(distance(views[8]?.back ?? [0, 0, 0], start.back)).toBeLessThan(1e-9);
  for (const view of views) {
    expect(view.back[2]).toBeCloseTo(start.back[2], 12);
    expect(dot(view.right, [0, 0, 1])).toBeCloseTo(0, 12);
  }
});
