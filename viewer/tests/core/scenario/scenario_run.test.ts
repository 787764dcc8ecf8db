/** Runs of scenarios: what is read from a file, and what is refused. */
import { expect, test } from "vitest";
import { endOf, forceBefore, momentAt, parseRun, RunError } from "../../../src/core/scenario/scenario_run";

/** Two presses along y, 2 mm in and out each, with 1 N/mm. */
function file(change: (told: Record<string, unknown>) => void = () => undefined): string {
  const tip = [0, 1, 2, 1, 0];
  const twice = <T>(values: readonly T[]): T[] => [...values, ...values];
  const told: Record<string, unknown> = {
    format: "palpate-scenario-1",
    scenario: "palpation",
    scan: "block",
    layers: ["soft tissue", "bone"],
    radius: 4,
    phase: twice(["in", "in", "rest", "out", "out"]),
    samples: {
      time: Array.from({ length: 10 }, (_, i) => i / 10),
      x: [...tip.map(() => 0), ...tip.map(() => 5)],
      y: twice(tip),
      z: twice(tip.map(() => 7)),
      tip: twice(tip),
      force: twice(tip),
      segment: twice([0, 1, 2, 1, 0]),
      press: [...tip.map(() => 0), ...tip.map(() => 1)],
    },
    events: [{ kind: "contact", segment: "bone", time: 0.2, depth: 2, force: 2 }],
    presses: [
      { place: [0, 0, 7], along: 0, thickness: null, depth: 2, force: 2, stiffness: 1 },
      { place: [5, 0, 7], along: 5, thickness: 3, depth: 2, force: 2, stiffness: 1 },
    ],
  };
  change(told);
  return JSON.stringify(told);
}

test("a moment has the last sample that is not after it, and the force against the way in", () => {
  const run = parseRun(file());
  expect(endOf(run)).toBeCloseTo(0.9);
  const moment = momentAt(run, 0.79);
  expect(moment.tool).toEqual([5, 2, 7]);
  expect(moment.way).toEqual([0, 1, 0]);
  expect(moment.force).toEqual([-0, -2, -0]);
  expect(moment).toMatchObject({ phase: "rest", layer: "bone", press: 1, depth: 2 });
  expect(momentAt(run, -1).tool).toEqual([0, 0, 7]);
  expect(momentAt(run, 9).phase).toBe("out");
  expect(momentAt(run, 0).layer).toBe("");
});

test("the force of the last seconds is told as the live one is: the oldest first, before now", () => {
  const [times, magnitudes] = forceBefore(parseRun(file()), 0.35, 0.26);
  expect(times.map((time) => Number(time.toFixed(3)))).toEqual([-0.25, -0.15, -0.05]);
  expect(magnitudes).toEqual([1, 2, 1]);
});

type Samples = Record<string, unknown[]>;

test.each([
  ["no JSON", () => "{"],
  ["a list", () => "[]"],
  ["another format", () => file((told) => (told["format"] = "other"))],
  ["no samples", () => file((told) => delete told["samples"])],
  ["a column that is missing", () => file((told) => delete (told["samples"] as Samples)["force"])],
  ["a short column", () => file((told) => (told["samples"] as Samples)["x"]?.pop())],
  ["a word for a number", () => file((told) => (told["samples"] as Samples)["y"]?.splice(0, 1, "1"))],
  ["times that fall", () => file((told) => (told["samples"] as Samples)["time"]?.splice(0, 1, 5))],
  ["an unknown phase", () => file((told) => (told["phase"] as unknown[]).splice(0, 1, "up"))],
  ["a press that is not there", () => file((told) => (told["presses"] as unknown[]).pop())],
  ["an event without a time", () => file((told) => (told["events"] = [{ kind: "contact" }]))],
])("%s is refused", (_, text) => {
  expect(() => parseRun(text())).toThrow(RunError);
});
