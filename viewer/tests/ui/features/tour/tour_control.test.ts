/** When the tour comes, how it goes on, and that it is remembered. */
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { TourControl } from "../../../../src/ui/features/tour/tour_control.svelte";
import type { TourMoment } from "../../../../src/core/tour/tour_steps";

const quiet: TourMoment = { back: [0, -1, 0], contact: false, ranges: "[]", tool: null, canRedo: false };
let kept: Record<string, string> = {};

beforeEach(() => {
  kept = {};
  vi.useFakeTimers();
  vi.stubGlobal("navigator", { webdriver: false });
  vi.stubGlobal("localStorage", {
    getItem: (name: string) => kept[name] ?? null,
    setItem: (name: string, value: string) => (kept[name] = value),
  });
});

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

test("it comes at the first visit only, and again when it is asked for", () => {
  const first = new TourControl();
  first.offer("turn");
  expect(first.step).toBe("turn");
  first.leave();
  first.offer("turn");
  expect(first.step).toBeNull();

  const later = new TourControl();
  later.offer("turn");
  expect(later.step).toBeNull();
  later.start("turn");
  expect(later.step).toBe("turn");
});

test("to leave it before it came means nothing", () => {
  const tour = new TourControl();
  tour.leave();
  tour.offer("open");
  expect(tour.step).toBe("open");
});

test("a program that drives the page sees no tour, unless it asks", () => {
  vi.stubGlobal("navigator", { webdriver: true });
  const driven = new TourControl();
  driven.offer("turn");
  expect(driven.step).toBeNull();
  kept["palpate.tour"] = '{"seen":false}';
  const asking = new TourControl();
  asking.offer("turn");
  expect(asking.step).toBe("turn");
});

test("a step that was done says so, and the next one comes; the last one ends the tour", () => {
  const tour = new TourControl();
  tour.offer("drill");
  tour.follow(quiet);
  tour.follow({ ...quiet, tool: { kind: "drill", on: true, voxels: 9 } });
  expect([tour.step, tour.done]).toEqual(["drill", true]);
  vi.runAllTimers();
  expect([tour.step, tour.done]).toEqual(["undo", false]);
  tour.next();
  expect(tour.step).toBeNull();
  expect(kept["palpate.tour"]).toBe('{"seen":true}');
});

test("who leaves while a step is done is left alone", () => {
  const tour = new TourControl();
  tour.offer("undo");
  tour.follow(quiet);
  tour.follow({ ...quiet, canRedo: true });
  tour.leave();
  vi.runAllTimers();
  expect(tour.step).toBeNull();
});
