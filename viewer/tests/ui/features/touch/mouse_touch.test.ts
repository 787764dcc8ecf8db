/** How the mouse touches: its pressure stays within what can be pressed, and is remembered. */
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { MouseTouch, strongest, weakest } from "../../../../src/ui/features/touch/mouse_touch.svelte";

let kept: Record<string, string> = {};

beforeEach(() => {
  kept = {};
  vi.useFakeTimers();
  vi.stubGlobal("localStorage", {
    getItem: (name: string) => kept[name] ?? null,
    setItem: (name: string, value: string) => (kept[name] = value),
  });
});

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

test("a notch of the wheel changes the pressure by a tenth, rolled forward to more", () => {
  const mouse = new MouseTouch(() => false);
  mouse.turn(-100, 5, 6);
  expect(mouse.pressure).toBe(1.1);
  mouse.turn(-1e5, 5, 6);
  expect(mouse.pressure).toBe(strongest);
  mouse.turn(1e5, 5, 6);
  expect(mouse.pressure).toBe(weakest);
});

test("way and pressure are remembered, and nonsense is not", () => {
  const mouse = new MouseTouch(() => false);
  mouse.choose("plane");
  mouse.turn(-200, 0, 0);
  const again = new MouseTouch(() => false);
  expect([again.way, again.pressure]).toEqual(["plane", mouse.pressure]);
  kept["palpate.mouse"] = '{"way": 3, "pressures": {"feel": "much"}}';
  const sane = new MouseTouch(() => false);
  expect([sane.way, sane.pressure]).toEqual(["surface", 1]);
});

test("the ring goes some time after the wheel was turned, and stays while the button is pressed", () => {
  const mouse = new MouseTouch(() => false);
  mouse.turn(-100, 5, 6);
  expect(mouse.finger).toEqual({ x: 5, y: 6, presses: false });
  vi.advanceTimersByTime(2000);
  expect(mouse.finger).toBeNull();
  mouse.show({ x: 1, y: 2, presses: true });
  mouse.turn(-100, 1, 2);
  vi.advanceTimersByTime(5000);
  expect(mouse.finger).toEqual({ x: 1, y: 2, presses: true });
});

test("a drill is pressed with more than a probe that feels, and each pressure is changed on its own", () => {
  let drills = false;
  const mouse = new MouseTouch(() => drills);
  mouse.turn(-100, 0, 0);
  drills = true;
  expect(mouse.pressure).toBe(strongest);
  mouse.turn(300, 0, 0);
  const again = new MouseTouch(() => drills);
  expect(again.pressure).toBe(mouse.pressure);
  expect(again.pressure).toBeLessThan(strongest);
  drills = false;
  expect(again.pressure).toBe(1.1);
});
