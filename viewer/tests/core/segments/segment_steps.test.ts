import { describe, expect, it } from "vitest";
import type { SegmentStep } from "../../../src/core/protocol";
import {
  followingWords,
  movedUp,
  wantedSteps,
  withChange,
  withoutStep,
  wordsOf,
} from "../../../src/core/segments/segment_steps";

const step = (part: Partial<SegmentStep>): SegmentStep => ({ kind: "grow", amount: 2, other: null, on: true, ...part });
const steps = [
  step({ kind: "keep-largest", amount: 1 }),
  step({ kind: "smooth", amount: 1.5, on: false }),
  step({ kind: "by-hand", amount: 0 }),
];

describe("a list of steps", () => {
  it("is asked for with where each step stands now", () => {
    expect(wantedSteps(steps).map(({ index, kind }) => [index, kind])).toEqual([
      [0, "keep-largest"],
      [1, "smooth"],
      [2, "by-hand"],
    ]);
    expect(withChange(steps, 1, { on: true, amount: 3 })[1]).toEqual({ index: 1, kind: "smooth", amount: 3, on: true });
    expect(withoutStep(steps, 0).map(({ index }) => index)).toEqual([1, 2]);
    expect(movedUp(steps, 2).map(({ index }) => index)).toEqual([0, 2, 1]);
    expect(movedUp(steps, 0).map(({ index }) => index)).toEqual([0, 1, 2]);
  });

  it("names what is joined, and leaves out of the line below the slider what is off", () => {
    expect(wordsOf(step({ kind: "subtract", other: "Liver" })).name).toBe("Subtract Liver");
    expect(wordsOf(step({ kind: "by-hand" })).amount).toBeNull();
    expect(followingWords(steps)).toBe("keep largest islands, what was edited by hand");
    expect(followingWords([step({ kind: "subtract", other: "Liver" })])).toBe("subtract Liver");
    expect(followingWords([])).toBe("");
  });
});
