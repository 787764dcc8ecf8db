/** Marks in a person's hand: set point by point, dragged as one step, taken back, remembered. */
import { beforeEach, expect, test } from "vitest";
import { MarkControl } from "../../../../src/ui/features/marks/mark_control.svelte";
import { ScanMemory } from "../../../../src/ui/state/scan_memory";
import { PageSteps } from "../../../../src/ui/state/page_steps.svelte";

let steps = new PageSteps(() => 0);
let memory = new ScanMemory(() => undefined);

beforeEach(() => {
  steps = new PageSteps(() => 0);
  memory = new ScanMemory(() => undefined);
});

function opened(): MarkControl {
  const marks = new MarkControl(steps, memory);
  marks.open();
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
  const id = marks.all[0]?.id ?? NaN;
  marks.drag(id, 1, [2, 0, 0]);
  marks.drag(id, 1, [3, 0, 0]);
  marks.rename(id, "gap");
  // nothing has changed: no step
  marks.rename(id, " ");
  marks.remove(id);
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

test("marks are kept with their scan, and what was kept may be anything", () => {
  const marks = opened();
  marks.add("point", [[1, 2, 3]]);
  expect(opened().all).toEqual(marks.all);
  memory = new ScanMemory(() => undefined);
  expect(opened().all).toEqual([]);
  for (const bad of [{ list: 3 }, { kind: "angle" }, []]) {
    memory.keep("mark.1", bad);
    expect(opened().all).toEqual([]);
  }
});

test("marks of another page stand beside those of this one, and undo leaves them", () => {
  const marks = opened();
  marks.add("point", [[1, 2, 3]]);
  const theirs = { kind: "point", name: "Theirs", points: [[4, 5, 6]], visible: true };
  const report = (value: object | null, version: number, answers = false): void => {
    const part = { name: "mark.7", version, value: value === null ? null : JSON.stringify(value) };
    memory.take({ type: "kept", part, answers });
  };
  report(theirs, 1);
  expect(marks.all.map(({ name }) => name)).toEqual(["Point 1", "Theirs"]);
  marks.removeAll();
  steps.undo();
  report(null, 2, true);
  report(marks.all.find(({ id }) => id === 7) ?? null, 3, true);
  expect(marks.all).toHaveLength(2);
  steps.undo();
  expect(marks.all.map(({ name }) => name)).toEqual(["Theirs"]);
  report({ ...theirs, name: "Renamed" }, 9);
  expect(marks.all.map(({ id, name }) => [id, name])).toEqual([[7, "Renamed"]]);
  report(null, 10);
  expect(marks.all).toEqual([]);
  steps.redo();
  expect(marks.all.map(({ name }) => name)).toEqual(["Point 1"]);
});
