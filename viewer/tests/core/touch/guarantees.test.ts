import { expect, test } from "vitest";
import { lightOf, pendingLines, whyNoForce } from "../../../src/core/touch/guarantees";
import { safety, segment } from "../../support/volumes";

test("the light is green while nothing was broken and nothing is held back", () => {
  const light = lightOf({ ...safety, slewed: 40, ramped: 3 }, "exact");
  expect(light.colour).toBe("green");
  expect(light.short).toBe("Force checks passed");
});

test.each([
  [1, "1 failed check", "once"],
  [12345, "12\u2009345 failed checks", "12\u2009345 times"],
] as const)("%d violations turn it red, with the number and what it means", (violations, short, times) => {
  const light = lightOf({ ...safety, violations }, "exact");
  expect(light.colour).toBe("red");
  expect(light.short).toBe(short);
  expect(light.meaning).toContain(times);
  expect(light.meaning).toContain("inside");
});

test.each(["waiting", "ramping", "easing", "off"] as const)(
  "a force that is %s makes it amber and says why",
  (force) => {
    const light = lightOf({ ...safety, force }, "exact");
    expect(light.colour).toBe("amber");
    expect(light.short).toContain("force");
    expect(light.meaning.length).toBeGreaterThan(20);
  },
);

test.each([
  ["servo-late", "late"],
  ["stopped", "ended"],
  ["not-finite", "no number"],
  ["waiting", "come out"],
  ["not-started", "yet"],
] as const)("why no force is sent is told: %s", (off, word) => {
  expect(whyNoForce({ ...safety, off })).toContain(word);
});

test("while forces are sent there is no reason why not", () => {
  expect(whyNoForce(safety)).toBeNull();
});

test("a violation is never hidden behind an intervention", () => {
  expect(lightOf({ ...safety, force: "off", violations: 1 }, "exact").colour).toBe("red");
});

test("a thesis model is not praised for what it does not promise", () => {
  expect(lightOf(safety, "thesis-original").meaning).toContain("promise nothing");
  expect(lightOf(safety, "exact").meaning).not.toContain("promise nothing");
});

test("every counter of the engine stands in the list", () => {
  const names = Object.entries(safety).filter(([, value]) => typeof value === "number").map(([name]) => name);
  const counted = names.map((_, i) => i + 1);
  const numbers = Object.fromEntries(names.map((name, i) => [name, i + 1]));
  const { counts } = lightOf({ ...safety, ...numbers }, "exact");
  expect(counts.map(({ count }) => count).sort((a, b) => a - b)).toEqual(counted);
  expect(new Set(counts.map(({ name }) => name)).size).toBe(counts.length);
});

test("what waits is named where it has a name, and counted where it has none", () => {
  const waiting = { ...segment, name: "Skull", pending: true };
  expect(pendingLines([segment], 0)).toEqual([]);
  expect(pendingLines([waiting, segment], 1)).toEqual(["A change of Skull"]);
  expect(pendingLines([waiting], 3)).toEqual(["A change of Skull", "2 more changes"]);
  expect(pendingLines([segment], 1)).toEqual(["1 change"]);
});
