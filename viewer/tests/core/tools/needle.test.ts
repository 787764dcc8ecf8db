import { expect, test } from "vitest";
import { likelyLayer, tellEvent } from "../../../src/core/tools/needle";
import type { NeedleEvent } from "../../../src/core/protocol";

test("bone and thresholds are hard for a needle, and tissue is what its name says", () => {
  expect(likelyLayer({ name: "Liver", made_by: null })).toBe("liver");
  expect(likelyLayer({ name: "skin of the head", made_by: null })).toBe("skin");
  expect(likelyLayer({ name: "kidneys", made_by: null })).toBe("muscle");
  // a rib is no muscle, and nobody knows what a threshold is
  expect(likelyLayer({ name: "ribs", made_by: null })).toBe("hard");
  expect(likelyLayer({ name: "above 300", made_by: [300, 3000] })).toBe("hard");
});

test("what happened is told with the segment's name, force and depth", () => {
  const segments = [{ id: 3, name: "liver" }];
  const event: NeedleEvent = { kind: "punctured", segment: 3, time: 1.5, depth: 12.34, force: 1.612 };
  expect(tellEvent(event, segments)).toBe("punctured liver, 1.61\u202fN at 12.3\u202fmm");
  expect(tellEvent({ ...event, kind: "crossed", segment: 0 }, segments)).toBe("out of all at 12.3\u202fmm");
  expect(tellEvent({ ...event, kind: "stopped" }, segments)).toBe("stopped by liver at 12.3\u202fmm");
  expect(tellEvent({ ...event, kind: "withdrawn", segment: 0 }, segments)).toBe("withdrawn");
});
