/** Looks of segments, which the engine holds for all pages: steps take back what nobody has changed since. */
import { beforeEach, expect, test } from "vitest";
import type { FromPage, Segment, SegmentProperties, ShowSegments } from "../../../../src/core/protocol";
import { PageSteps } from "../../../../src/ui/state/page_steps.svelte";
import { SegmentAppearanceControl } from "../../../../src/ui/features/segments/segment_appearance_control";
import type { Session } from "../../../../src/ui/state/session.svelte";

let segments: Segment[] = [];
let sent: FromPage[] = [];
let waiters: (() => void)[] = [];
let steps = new PageSteps(() => 0);
let control = {} as SegmentAppearanceControl;

const one = (id: number): Segment => segments.find((segment) => segment.id === id) ?? ({ name: "gone" } as Segment);
const seen = (): readonly boolean[] => segments.map(({ visible }) => visible);

beforeEach(() => {
  const first = {
    id: 1,
    name: "Bone",
    colour: [1, 0, 0],
    visible: true,
    touchable: true,
    locked: false,
    shown_as: "volume",
    opacity: 1,
    smoothing: 3,
  } as unknown as Segment;
  segments = [first, { ...first, id: 2, name: "Skin", visible: false }, { ...first, id: 3, name: "Fat" }];
  sent = [];
  waiters = [];
  steps = new PageSteps(() => 0);
  const session = {
    get segments() {
      return segments;
    },
    send: (message: FromPage) => sent.push(message),
    whenAnswered: (told: () => void) => waiters.push(told),
  } as unknown as Session;
  control = new SegmentAppearanceControl(session, steps);
});

/** The engine does what it was asked for, and tells of it. */
function answer(): void {
  for (const asked of sent.splice(0) as (SegmentProperties | ShowSegments)[]) {
    const changes = asked.type === "show_segments" ? asked.changes : [{ ...asked, ids: [asked.id] }];
    for (const { ids, ...part } of changes) {
      const given = Object.fromEntries(Object.entries(part).filter(([, value]) => value !== null));
      segments = segments.map((segment) => (ids.includes(segment.id) ? { ...segment, ...given } : segment));
    }
  }
  for (const told of waiters.splice(0)) told();
}

test.each([
  ["each is answered", true],
  ["none is answered", false],
])("what was changed comes back in turn where %s before the next", (_, answers) => {
  const next = (act: () => void): void => {
    act();
    if (answers) answer();
  };
  next(() => {
    control.change(one(1), { colour: [0, 1, 0] });
  });
  next(() => {
    control.change(one(1), { name: "Skull" });
  });
  next(() => {
    control.change(one(1), { opacity: 0.5 });
  });
  expect(steps.toUndo).toMatch(/^opacity of /);
  const changed = { colour: [0, 1, 0], name: "Skull", opacity: 0.5 };
  for (const expected of [
    { ...changed, opacity: 1 },
    { ...changed, opacity: 1, name: "Bone" },
    { colour: [1, 0, 0], name: "Bone", opacity: 1 },
  ]) {
    next(() => {
      steps.undo();
    });
    if (answers) expect(one(1)).toMatchObject(expected);
  }
  answer();
  expect(one(1)).toMatchObject({ colour: [1, 0, 0], name: "Bone", opacity: 1 });
  while (steps.canRedo)
    next(() => {
      steps.redo();
    });
  answer();
  expect(one(1)).toMatchObject(changed);
});

test("all at once, and one alone, are one step each and touch only what differs", () => {
  control.changeAll(segments, { visible: true });
  expect(sent).toHaveLength(1);
  answer();
  control.showAlone(2);
  answer();
  expect(seen()).toEqual([false, true, false]);
  steps.undo();
  answer();
  expect(seen()).toEqual([true, true, true]);
  steps.undo();
  answer();
  expect(seen()).toEqual([true, false, true]);
  expect(steps.canUndo).toBe(false);
});

test("what another page has changed since stays as it is", () => {
  control.change(one(3), { wireframe: true });
  answer();
  control.changeAll(segments, { shown_as: "both" });
  answer();
  segments = segments.map((segment) =>
    segment.id === 3 ? { ...segment, shown_as: "surface", wireframe: false } : segment,
  );
  steps.undo();
  answer();
  expect(segments.map(({ shown_as }) => shown_as)).toEqual(["volume", "volume", "surface"]);
  // nothing is left of the step before: it is left out
  steps.forgetLost();
  expect(steps.canUndo).toBe(false);
});

test("a lock is a step of its own, which leaves the appearance as it is", () => {
  control.change(one(1), { colour: [0, 1, 0] });
  answer();
  control.change(one(1), { locked: true });
  expect([steps.toUndo, sent]).toMatchObject(["lock of Bone", [{ id: 1, locked: true, colour: [0, 1, 0] }]]);
  answer();
  steps.undo();
  answer();
  expect(one(1)).toMatchObject({ locked: false, colour: [0, 1, 0] });
});

test("of a segment that is gone nothing is asked", () => {
  control.change(one(2), { visible: true });
  answer();
  segments = segments.filter(({ id }) => id !== 2);
  steps.undo();
  expect(sent).toEqual([]);
});

test("what the engine has refused is not taken back", () => {
  control.change(one(1), { colour: [0, 0, 1] });
  sent = [];
  answer();
  steps.forgetLost();
  expect(steps.canUndo).toBe(false);
});
