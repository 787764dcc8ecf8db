import { expect, test } from "vitest";
import { LoadingScan, StandIn, type Planes } from "../../../src/core/scan/loading_scan";
import { brickRanges } from "../../../src/core/scan/bricks";
import { bias } from "../../../src/core/scan/stored_values";
import type { Vec3 } from "../../../src/core/geometry/vector";
import { Random } from "../../support/random";

// planes of 512 KiB: four of them are handed on at once
const dimensions: Vec3 = [512, 512, 11];
const plane = 512 * 512;

/** Stored values, as the engine sends them. */
function stored(): Int16Array<ArrayBuffer> {
  const random = new Random(41);
  return Int16Array.from({ length: plane * dimensions[2] }, () => random.whole(-1000, 3000));
}

/** Gives the bytes in pieces that end anywhere. */
function* pieces(bytes: Uint8Array): Generator<Uint8Array> {
  const random = new Random(42);
  let from = 0;
  while (from < bytes.length) {
    const to = Math.min(bytes.length, from + random.whole(1, 700_000));
    yield bytes.subarray(from, to);
    from = to;
  }
}

/** A coarse scan of which each value is the same. */
function coarse(value: number): ConstructorParameters<typeof StandIn>[0] {
  return { dimensions: [171, 171, 4], step: 3, values: new Uint16Array(171 * 171 * 4).fill(value) };
}

test("bytes that come in pieces become whole planes once, with their values and the ranges of their bricks", () => {
  const sent = stored();
  const scan = new LoadingScan(dimensions);
  const values = new Uint16Array(sent.length);
  const firsts: number[] = [];
  for (const piece of pieces(new Uint8Array(sent.buffer))) {
    for (const planes of scan.take(piece)) {
      firsts.push(planes.first);
      values.set(planes.values, planes.first * plane);
    }
  }
  // the last ones are fewer
  expect(firsts).toEqual([0, 4, 8]);
  expect(scan.arrived).toBe(11);
  expect(values.every((value, i) => value === (sent[i] ?? 0) + bias)).toBe(true);
  expect(scan.bricks).toEqual(brickRanges({ dimensions, values }));
});

test("what stands in for planes on their way is made from the last one on until it meets what has arrived", () => {
  const standIn = new StandIn(coarse(700), dimensions, 1, 4);
  const made: Planes[] = [];
  for (let planes = standIn.make(4); planes !== null; planes = standIn.make(4)) {
    made.push(planes);
  }
  expect(made.map(({ first, values }) => [first, values.length / plane])).toEqual([[7, 4], [4, 3]]);
  expect(made.every(({ values }) => values.every((value) => value === 700))).toBe(true);
});

test("a part is shown once no plane is missing, then where enough has arrived since, and never the whole", () => {
  const scan = new LoadingScan(dimensions);
  const standIn = new StandIn(coarse(700), dimensions, 1, 2);
  const bytes = new Uint8Array(stored().buffer);
  scan.take(bytes.subarray(0, 2 * plane * 4));
  expect(standIn.next(scan)).toBeNull();
  while (standIn.make(scan.arrived) !== null);
  const shown = standIn.next(scan);
  expect(shown?.arrived).toBe(4);
  // their ranges hold what has arrived and what stands in for the rest
  expect(shown?.bricks.low[0]).toBeLessThanOrEqual(700);
  expect(shown?.bricks.high[0]).toBeGreaterThan(bias + 2900);
  // two parts of 11 planes: 4 more are too few
  scan.take(bytes.subarray(2 * plane * 4, 2 * plane * 8));
  expect(standIn.next(scan)).toBeNull();
  scan.take(bytes.subarray(2 * plane * 8));
  expect(standIn.next(scan)).toBeNull();
});

test("a part is shown again where enough has arrived since the last one", () => {
  const standIn = new StandIn(coarse(700), dimensions, 1, 4);
  const { bricks } = new LoadingScan(dimensions);
  while (standIn.make(0) !== null);
  const parts = Array.from({ length: 12 }, (_, arrived) => standIn.next({ arrived, bricks })?.arrived);
  expect(parts.filter((arrived) => arrived !== undefined)).toEqual([0, 3, 6, 9]);
});
