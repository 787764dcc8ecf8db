import { expect, test } from "vitest";
import { isDone, since, stepNames, tourSteps, type StepName, type TourMoment } from "../../../src/core/tour/tour_steps";

const start: TourMoment = { back: [0, -1, 0], contact: false, ranges: "[[300,3000]]", tool: null, canRedo: false };
const acts: Readonly<Partial<Record<StepName, Partial<TourMoment>>>> = {
  turn: { back: [Math.sin(0.2), -Math.cos(0.2), 0] },
  touch: { contact: true },
  threshold: { ranges: "[[200,3000]]" },
  drill: { tool: { kind: "drill", on: true, voxels: 3 } },
  undo: { canRedo: true },
};

test("each step is done by its own act and by no other one", () => {
  for (const step of stepNames) {
    for (const [done, act] of Object.entries(acts)) {
      expect(isDone(step, start, { ...start, ...act }), `${step} by ${done}`).toBe(step === done);
    }
    expect(isDone(step, start, start)).toBe(false);
  }
});

test("what was so before the step counts once it has ended and comes again", () => {
  const before = { ...start, contact: true, canRedo: true };
  expect(isDone("touch", since(before, before), before)).toBe(false);
  const lifted = since(before, start);
  expect(isDone("touch", lifted, before)).toBe(true);
  expect(isDone("undo", lifted, before)).toBe(true);
});

test("a trembling hand turns nothing, and an eraser drills nothing", () => {
  expect(isDone("turn", start, { ...start, back: [Math.sin(0.05), -Math.cos(0.05), 0] })).toBe(false);
  expect(isDone("drill", start, { ...start, tool: { kind: "eraser", on: true, voxels: 3 } })).toBe(false);
});

test("each step says in one or two short sentences what to do", () => {
  for (const { title, places } of Object.values(tourSteps)) {
    expect(title.length).toBeLessThan(24);
    for (const { says } of places) {
      expect(says.match(/[.](\s|$)/g)?.length ?? 0).toBeLessThanOrEqual(2);
      expect(says.length).toBeLessThan(120);
    }
  }
});
