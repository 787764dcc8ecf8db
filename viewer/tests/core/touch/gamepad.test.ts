import { expect, test } from "vitest";
import { button, moveOf, pressed, rumbleOf, stick, type Felt, type Pad } from "../../../src/core/touch/gamepad";
import { Random } from "../../support/random";

const still: Pad = { axes: [0, 0, 0, 0], buttons: Array.from({ length: 17 }, () => ({ pressed: false, value: 0 })) };

function held(index: number, value = 1): Pad {
  return { ...still, buttons: still.buttons.map((up, i) => (i === index ? { pressed: true, value } : up)) };
}

test("sticks near their middle do nothing, and reach full speed at their end in every direction", () => {
  for (let angle = 0; angle < 6.3; angle += 0.1) {
    const along = (size: number): readonly [number, number] => stick(size * Math.cos(angle), size * Math.sin(angle));
    expect(Math.hypot(...along(0.14))).toBe(0);
    expect(Math.hypot(...along(1))).toBeCloseTo(1);
    // worn sticks go over their end
    expect(Math.hypot(...along(1.3))).toBeCloseTo(1);
    expect(Math.hypot(...along(0.2))).toBeLessThan(0.02);
  }
  expect(stick(NaN, 0)).toEqual([0, 0]);
});

test("the left stick moves the hand as the screen's axes go, triggers away and back", () => {
  const right = moveOf({ ...still, axes: [1, 0, 0, 0] }, true);
  expect(right.right).toBeGreaterThan(100);
  expect([right.down, right.away]).toEqual([0, 0]);
  expect(moveOf({ ...still, axes: [0, 1, 0, 0] }, true).down).toBeGreaterThan(100);
  expect(moveOf(held(button.rightTrigger), true).away).toBeGreaterThan(100);
  expect(moveOf(held(button.leftTrigger), true).away).toBeLessThan(-100);
});

test("the left shoulder makes the hand fine", () => {
  const fine = moveOf({ ...held(button.leftShoulder), axes: [1, 0, 0, 0] }, true);
  expect(fine.right).toBeCloseTo(0.2 * moveOf({ ...still, axes: [1, 0, 0, 0] }, true).right);
});

test("with touch off the sticks turn the picture and the hand stays", () => {
  const { right, down, away, turn } = moveOf({ ...held(button.rightTrigger), axes: [1, 0.5, 0, 0] }, false);
  expect([right, down, away]).toEqual([0, 0, 0]);
  expect(turn[0]).not.toBe(0);
});

test("a pad without sticks or buttons moves nothing", () => {
  const { right, down, away, turn } = moveOf({ axes: [], buttons: [] }, true);
  expect([right, down, away, ...turn].every((value) => Math.abs(value) === 0)).toBe(true);
});

test("a button counts once for as long as it is held", () => {
  const down = held(button.south);
  expect(pressed(null, still)).toEqual([]);
  expect(pressed(still, down)).toEqual([button.south]);
  expect(pressed(down, down)).toEqual([]);
});

test("a pad is still in free space and while nothing touches", () => {
  const free: Felt = { force: [0, 0, 0], contact: false };
  expect(rumbleOf(free, free, 4)).toEqual({ strong: 0, weak: 0 });
  expect(rumbleOf(null, free, 4)).toEqual({ strong: 0, weak: 0 });
});

test("contact is felt at once, and force as a hum that grows with it", () => {
  const free: Felt = { force: [0, 0, 0], contact: false };
  const at = (newtons: number): Felt => ({ force: [0, newtons, 0], contact: true });
  expect(rumbleOf(free, at(0.1), 4).weak).toBeGreaterThan(0.5);
  expect(rumbleOf(at(1), at(1), 4).weak).toBe(0);
  expect(rumbleOf(at(3), at(3), 4).strong).toBeGreaterThan(rumbleOf(at(1), at(1), 4).strong);
  expect(rumbleOf(at(1), at(2), 4).weak).toBeGreaterThan(rumbleOf(at(1), at(1.3), 4).weak);
});

test("whatever the force does, both motors stay within 0 and 1", () => {
  const random = new Random(83);
  let before: Felt | null = null;
  for (let i = 0; i < 1000; ++i) {
    const now: Felt = {
      force: [random.between(-99, 99), random.between(-99, 99), NaN * Number(i % 50 === 0)],
      contact: i % 3 > 0,
    };
    const { strong, weak } = rumbleOf(before, now, 4);
    for (const motor of [strong, weak]) {
      expect(motor).toBeGreaterThanOrEqual(0);
      expect(motor).toBeLessThanOrEqual(1);
    }
    before = now;
  }
});
