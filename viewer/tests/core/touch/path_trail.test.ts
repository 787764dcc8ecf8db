import { expect, test } from "vitest";
import { PathTrail, pieceNumbers } from "../../../src/core/touch/path_trail";

function written(trail: PathTrail, most = 100): number[][] {
  const pieces = new Float32Array(most * pieceNumbers);
  const count = trail.write(pieces);
  return Array.from({ length: count }, (_, i) => [...pieces.slice(i * pieceNumbers, (i + 1) * pieceNumbers)]);
}

test("the way of the probe is a chain of pieces that fade with age", () => {
  const trail = new PathTrail(2, 100, 0.1);
  for (let i = 0; i <= 10; ++i) {
    trail.add(i / 10, [i, 0, 5]);
  }
  const pieces = written(trail);
  expect(pieces).toHaveLength(10);
  pieces.forEach((piece, i) => {
    expect(piece.slice(0, 6)).toEqual([i, 0, 5, i + 1, 0, 5]);
    // one second of two has passed since the first point
    expect(piece[6]).toBeCloseTo(0.5 + 0.05 * i);
    expect(piece[7]).toBeCloseTo(0.5 + 0.05 * (i + 1));
  });
});

test("a probe at rest leaves no line once the seconds have passed", () => {
  const trail = new PathTrail(2, 100, 0.1);
  trail.add(0, [0, 0, 0]);
  trail.add(0.1, [5, 0, 0]);
  expect(trail.alive).toBe(true);
  trail.add(1, [5, 0, 0]);
  expect(trail.alive).toBe(true);
  trail.add(2.2, [5, 0, 0]);
  expect(trail.alive).toBe(false);
  expect(written(trail)).toEqual([]);
  expect(trail.points).toEqual([]);
});

test("no line leads to where the probe was placed", () => {
  const trail = new PathTrail(2, 100, 0.1);
  trail.add(0, [0, 0, 0]);
  trail.add(0.016, [1, 0, 0]);
  trail.add(0.032, [200, 0, 0]);
  trail.add(0.048, [201, 0, 0]);
  expect(written(trail).map((piece) => [piece[0], piece[3]])).toEqual([[0, 1], [200, 201]]);
});

test("a piece that can be seen has both its ends among the points", () => {
  const trail = new PathTrail(2, 100, 0.1);
  trail.add(0, [0, 0, 0]);
  trail.add(1, [5, 0, 0]);
  trail.add(2.5, [5, 0, 0]);
  expect(written(trail).map((piece) => [piece[0], piece[3]])).toEqual([[0, 5]]);
  expect(trail.points).toEqual([[0, 0, 0], [5, 0, 0]]);
});

test("trembling less than the spacing adds nothing, and a full ring keeps the newest", () => {
  const trail = new PathTrail(100, 4, 1);
  for (let i = 0; i < 50; ++i) {
    trail.add(i, [0.5 * (i % 2), 0, 0]);
  }
  expect(written(trail)).toEqual([]);
  for (let i = 0; i < 10; ++i) {
    trail.add(50 + i, [2 * i, 0, 0]);
  }
  expect(trail.points.map((point) => point[0])).toEqual([12, 14, 16, 18]);
  expect(written(trail, 2)).toHaveLength(2);
});

test("a new session begins a new line", () => {
  const trail = new PathTrail(2, 100, 0.1);
  trail.add(100, [0, 0, 0]);
  trail.add(100.1, [1, 0, 0]);
  trail.add(0.1, [1, 0, 0]);
  expect(written(trail)).toEqual([]);
  expect(trail.points).toHaveLength(1);
});
