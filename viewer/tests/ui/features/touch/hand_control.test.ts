/**
 * The hand on a page or a machine that is slow: no move is lost, and none begins where the hand is not.
 */
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { Camera } from "../../../../src/core/geometry/camera";
import type { FromPage } from "../../../../src/core/protocol";
import type { Vec3 } from "../../../../src/core/geometry/vector";
import { HandControl } from "../../../../src/ui/features/touch/hand_control.svelte";
import type { Session } from "../../../../src/ui/state/session.svelte";

/** Looks along y from before; a pixel of the picture is 1 mm at the target. */
const camera: Camera = {
  target: [0, 0, 0],
  distance: 100,
  right: [1, 0, 0],
  up: [0, 0, 1],
  back: [0, -1, 0],
  field: Math.PI / 2,
  parallel: null,
};
const viewport = { width: 200, height: 200 };

let now = 0;
let frames: (() => void)[] = [];

beforeEach(() => {
  now = 1000;
  frames = [];
  vi.stubGlobal("performance", { now: () => now });
  vi.stubGlobal("requestAnimationFrame", (callback: () => void) => frames.push(callback));
});

afterEach(() => {
  vi.unstubAllGlobals();
});

/** An engine that tells only when it is asked to, and the page's hand. */
function setUp() {
  const asked: Vec3[] = [];
  const touched: FromPage[] = [];
  let waiting: (() => void)[] = [];
  const session = {
    latest: { hand: [0, 0, 0] as Vec3, proxy: [0, 0, 0] as Vec3, clutched: false },
    send: (message: FromPage) => {
      if (message.type === "hand") {
        asked.push(message.target);
      } else {
        touched.push(message);
      }
    },
    whenAnswered: (told: () => void) => waiting.push(told),
  };
  const hand = new HandControl(session as unknown as Session, { camera, viewport }, () => undefined, () => false);
  return {
    hand,
    asked,
    touched,
    session,
    frame: () => {
      const run = frames;
      frames = [];
      run.forEach((callback) => {
        callback();
      });
    },
    tell: (at: Vec3) => {
      session.latest = { ...session.latest, hand: at };
      const told = waiting;
      waiting = [];
      told.forEach((callback) => {
        callback();
      });
    },
  };
}

test("moves add up while the engine has not told of them, however long a frame takes", () => {
  const { hand, asked, frame } = setUp();
  for (let i = 0; i < 5; ++i) {
    hand.move(2, 0, 0);
    frame();
    now += 5000;
  }
  expect(asked.map(([x]) => Math.round(x))).toEqual([2, 4, 6, 8, 10]);
});

test("after a rest the hand begins where the engine has it, once it knows all moves", () => {
  const { hand, asked, frame, tell } = setUp();
  hand.move(2, 0, 0);
  frame();
  hand.move(2, 0, 0);
  frame();
  // of the first move only
  tell([2, 0, 0]);
  now += 5000;
  hand.move(1, 0, 0);
  frame();
  expect(Math.round(asked[2]?.[0] ?? 0)).toBe(5);

  // somebody else moved it
  tell([5, 0, 0]);
  tell([20, 0, 0]);
  now += 5000;
  hand.move(1, 0, 0);
  frame();
  expect(Math.round(asked[3]?.[0] ?? 0)).toBe(21);
});

test("no move begins at the place that the probe was taken away from", () => {
  const { hand, asked, frame, tell } = setUp();
  hand.place([30, 0, 0]);
  hand.move(1, 0, 0);
  frame();
  expect(asked).toEqual([]);
  tell([30, 0, 0]);
  hand.move(1, 0, 0);
  frame();
  expect(Math.round(asked[0]?.[0] ?? 0)).toBe(31);
});

test("a press goes once a frame, the latest one, and a lift takes back what was not sent yet", () => {
  const { hand, touched, frame } = setUp();
  const ray = (x: number) => ({ origin: [x, 0, 0] as Vec3, direction: [0, 1, 0] as Vec3 });
  hand.press(ray(1), 1);
  hand.press(ray(2), 1.5);
  expect(touched).toEqual([]);
  frame();
  expect(touched).toEqual([{ type: "press", origin: [2, 0, 0], direction: [0, 1, 0], pressure: 1.5 }]);
  hand.press(ray(3), 1);
  hand.lift();
  frame();
  expect(touched.slice(1)).toEqual([{ type: "lift" }]);
});
