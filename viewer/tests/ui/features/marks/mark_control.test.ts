/** Marks in a person's hand: set point by point, dragged as one step, taken back, remembered. */
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { Scan } from "../../../../src/core/protocol";
import { MarkControl } from "../../../../src/ui/features/marks/mark_control.svelte";
import { PageSteps } from "../../../../src/ui/state/page_steps.svelte";

const scan = { name: "head" } as Scan;
let steps = new PageSteps(() => 0);
let kept = new Map<string, string>();

beforeEach(() => {
  steps = new PageSteps(() => 0);
  kept = new Map();
  vi.stubGlobal("localStorage", {
    getItem: (key: string) => kept.get(key) ?? null,
    setItem: (key: string, value: string) => kept.set(key, value),
  });
});

afterEach(() => {
  vi.unstubAllGlobals();
});

function opened(): MarkControl {
  const marks = new MarkControl(steps);
  marks.open(scan);
  return marks;
}

test("an angle is set by three points, and only then is there a mark", () => {
  const marks = opened();
  marks.put([9, 9, 9]);
  expect(marks.all).toEqual([]);
  marks.start("angle");
  marks.put([1, 0, 0]);
  marks.put([0, 0, 0]);
  expect(marks.all).toEqual([]);
  marks.put([0, 1, 0]);
  expect(marks.all).toMatchObject([{ kind: "angle", points: [[1, 0, 0], [0, 0, 0], [0, 1, 0]] }]);
  expect(marks.placing).toBeNull();

  marks.start("distance");
  marks.put([1, 0, 0]);
  marks.cancel();
  marks.put([2, 0, 0]);
  expect(marks.all).toHaveLength(1);
});

test("a drag is one step, and every step can be taken back and made again", () => {
  const marks = opened();
  marks.add("distance", [[0, 0, 0], [1, 0, 0]]);
  marks.drag(1, 1, [2, 0, 0]);
  marks.drag(1, 1, [3, 0, 0]);
  marks.rename(1, "gap");
  // nothing has changed: no step
  marks.rename(1, " ");
  marks.remove(1);
  const states = [marks.all];
  while (steps.canUndo) {
    steps.undo();
    states.push(marks.all);
  }
  expect(states.map((all) => all.map(({ name, points }) => [name, points[1]?.[0]]))).toEqual([
    [],
    [["gap", 3]],
    [["Distance 1", 3]],
    [["Distance 1", 1]],
    [],
  ]);
  while (steps.canRedo) {
    steps.redo();
  }
  expect(marks.all).toEqual([]);
});

test("marks are remembered with their scan, and what was kept may be anything", () => {
  const marks = opened();
  marks.add("point", [[1, 2, 3]]);
  expect(opened().all).toEqual(marks.all);
  const other = new MarkControl(steps);
  other.open({ name: "foot" } as Scan);
  expect(other.all).toEqual([]);
  for (const text of ['{"list": 3}', '{"list": [null, {"kind": "angle"}]}', "[]", "no JSON"]) {
    kept.set("palpate.marks.head", text);
    expect(opened().all).toEqual([]);
  }
});
