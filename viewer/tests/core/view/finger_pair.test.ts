import { expect, test } from "vitest";
import { FingerPair } from "../../../src/core/view/finger_pair";

function pairAt(first: readonly [number, number], second: readonly [number, number]): FingerPair {
  const pair = new FingerPair();
  pair.put(1, first);
  pair.put(2, second);
  return pair;
}

test("fingers that go apart spread, about the point midway between them", () => {
  const pair = pairAt([100, 100], [200, 100]);
  expect(pair.move(2, [300, 100])).toEqual({ x: 50, y: 0, spread: 2, middle: [200, 100] });
  expect(pair.move(1, [100, 100])).toEqual({ x: 0, y: 0, spread: 1, middle: [200, 100] });
});

test("fingers that go the same way move the middle in the end as far as each of them", () => {
  const pair = pairAt([100, 100], [200, 100]);
  const moves = [pair.move(1, [110, 120]), pair.move(2, [210, 120])];
  expect(moves.reduce((sum, move) => sum + (move?.x ?? NaN), 0)).toBe(10);
  expect(moves.reduce((sum, move) => sum + (move?.y ?? NaN), 0)).toBe(20);
  expect(moves.reduce((product, move) => product * (move?.spread ?? NaN), 1)).toBeCloseTo(1);
});

test("fingertips that touch each other do not make the picture jump", () => {
  expect(pairAt([100, 100], [100, 100]).move(2, [108, 100])?.spread).toBe(1);
});

test("one finger, a third one and one that is not down are no pair", () => {
  const one = new FingerPair();
  one.put(1, [0, 0]);
  expect(one.move(1, [5, 5])).toBeNull();
  expect(one.move(7, [5, 5])).toBeNull();
  const three = pairAt([0, 0], [50, 0]);
  three.put(3, [90, 0]);
  expect(three.move(3, [95, 0])).toBeNull();
  three.lift(3);
  expect(three.count).toBe(2);
  expect(three.move(2, [100, 0])?.spread).toBe(2);
});
