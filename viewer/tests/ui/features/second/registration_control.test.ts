/** Registration in a person's hand: pairs set by two clicks each, kept with the scan, undo of the page. */
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { FromPage, Registration, SecondScan } from "../../../../src/core/protocol";
import { PageSteps } from "../../../../src/ui/state/page_steps.svelte";
import { RegistrationControl } from "../../../../src/ui/features/second/registration_control.svelte";
import type { SecondControl } from "../../../../src/ui/features/second/second_control.svelte";
import { ScanMemory } from "../../../../src/ui/state/scan_memory";
import type { Session } from "../../../../src/ui/state/session.svelte";

const shifted = [1, 0, 0, 10, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
const idle: Registration = {
  type: "registration",
  doing: null,
  share: null,
  curve: [],
  failure: null,
  found: null,
  shown: "after",
  steps: 0,
  undone: 0,
};
let sent: FromPage[] = [];
let second = {} as SecondControl;
let steps = new PageSteps(() => 0);
let memory = new ScanMemory(() => undefined);

beforeEach(() => {
  const kept = new Map<string, string>();
  vi.stubGlobal("localStorage", {
    getItem: (key: string) => kept.get(key) ?? null,
    setItem: (key: string, value: string) => kept.set(key, value),
  });
  sent = [];
  memory = new ScanMemory(() => undefined);
  steps = new PageSteps(() => 0);
  second = {
    reported: { scan: { identity: "a1" }, second_from_first: shifted, version: 0 } as unknown as SecondScan,
    only: null,
  } as SecondControl;
});

afterEach(() => {
  vi.unstubAllGlobals();
});

function control(): RegistrationControl {
  const session = { send: (message: FromPage) => sent.push(message), memory } as unknown as Session;
  const made = new RegistrationControl(session, second, { steps });
  made.follow("a1");
  made.take(idle);
  return made;
}

test("a pair is a click on the first scan, shown alone, then one on the second", () => {
  const registration = control();
  registration.change({ start: "landmarks" });
  registration.put([1, 1, 1]);
  expect(registration.shownPairs).toEqual([]);
  registration.startPair();
  expect(second.only).toBe("first");
  registration.put([1, 2, 3]);
  expect(second.only).toBe("second");
  registration.put([4, 2, 3]);
  expect(registration.shownPairs).toEqual([{ first: [1, 2, 3], second: [4, 2, 3], apart: 3 }]);
  // fewer than three begin nothing: the next one is asked for
  expect(registration.placing).toEqual({ first: null });
  expect(registration.ready).toBe(false);
  for (const x of [5, 6]) {
    registration.put([x, 0, 0]);
    registration.put([x, x * x, 0]);
  }
  expect(registration.placing).toBeNull();
  expect(second.only).toBeNull();
  registration.run();
  const asked = sent.at(-1);
  expect(asked).toMatchObject({ type: "register", start: "landmarks" });
  // points of the second scan are its own
  expect(asked?.type === "register" && asked.pairs[0]).toEqual([[1, 2, 3], [14, 2, 3]]);
});

test("pairs are kept with the second scan, and are not those of another one", () => {
  const registration = control();
  registration.addDistances([{ id: 1, kind: "distance", name: "", visible: true, points: [[0, 0, 0], [1, 0, 0]] }]);
  registration.follow("b2");
  expect(registration.shownPairs).toEqual([]);
  registration.follow("a1");
  expect(registration.shownPairs).toHaveLength(1);
  registration.remove(0);
  expect(control().shownPairs).toEqual([]);
});

test("a registration that ends well is a step of undo; one that fails is none", () => {
  const registration = control();
  registration.run();
  registration.take({ ...idle, doing: "Rigid" });
  expect(registration.ready).toBe(false);
  registration.take({ ...idle, failure: "the scans do not overlap" });
  expect(steps.canUndo).toBe(false);
  registration.take({ ...idle, doing: "Rigid" });
  registration.take({ ...idle, steps: 1 });
  expect(steps.canUndo).toBe(true);
  steps.undo();
  expect(sent.at(-1)).toEqual({ type: "undo_registration" });
  registration.take({ ...idle, undone: 1 });
  steps.redo();
  expect(sent.at(-1)).toEqual({ type: "redo_registration" });
  registration.take({ ...idle, steps: 1 });
  steps.undo();
  expect(steps.canUndo).toBe(false);
});
