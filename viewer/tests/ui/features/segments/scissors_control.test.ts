/** Scissors: what is asked for a loop, what is hidden again, and what removes. */
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { Camera } from "../../../../src/core/geometry/camera";
import type { FromPage } from "../../../../src/core/protocol";
import { CutControl } from "../../../../src/ui/features/segments/cut_control.svelte";
import { armedLine } from "../../../../src/ui/features/segments/painted_line.svelte";
import { ScissorsControl } from "../../../../src/ui/features/segments/scissors_control.svelte";
import type { Session } from "../../../../src/ui/state/session.svelte";

const viewport = { width: 200, height: 100 };
const camera: Camera = {
  target: [0, 0, 0],
  distance: 100,
  right: [1, 0, 0],
  up: [0, 0, 1],
  back: [0, -1, 0],
  field: 0.6,
  parallel: null,
};
let sent: FromPage[] = [];
let session: Session;

beforeEach(() => {
  sent = [];
  vi.stubGlobal("localStorage", { getItem: () => null, setItem: () => undefined });
  session = {
    segments: [{ id: 1 }, { id: 9 }],
    scissors: null,
    islands: null,
    cutPreview: null,
    send: (message: FromPage) => sent.push(message),
  } as unknown as Session;
});

afterEach(() => {
  vi.unstubAllGlobals();
});

function paint(scissors: ScissorsControl, places: readonly (readonly [number, number])[]): void {
  const [first, ...others] = places;
  scissors.begin(first ?? [0, 0]);
  for (const place of others) scissors.paint(place);
  scissors.finish(camera, viewport);
}

const bend = [[60, 20], [140, 20], [140, 80]] as const;

test("a line closes by itself, and is asked for with the eye that saw it", () => {
  const scissors = new ScissorsControl(session);
  scissors.start();
  paint(scissors, bend);
  expect(scissors.line?.closed).toBe(true);
  expect(sent).toMatchObject([
    { type: "show_scissors", id: null, eye: [0, -100, 0], view: [-0, 1, -0], outside: false, depth: null },
  ]);
});

test("a click and a straight line are no loop", () => {
  const scissors = new ScissorsControl(session);
  scissors.start();
  paint(scissors, [[60, 20], [61, 20]]);
  paint(scissors, [[60, 20], [140, 20]]);
  expect(sent).toEqual([]);
});

test("another choice hides what was shown and asks again; a cancelled one removes nothing", () => {
  const scissors = new ScissorsControl(session);
  scissors.start();
  paint(scissors, bend);
  session.scissors = { type: "scissors", preview: 9, goes_ml: 1 };
  expect(scissors.ready).toBe(true);
  scissors.choose({ surface: true, depth: 4 });
  expect(sent.slice(1)).toMatchObject([
    { type: "end_going", removes: false },
    { type: "show_scissors", depth: 4 },
  ]);
  session.scissors = { type: "scissors", preview: 9, goes_ml: 1 };
  scissors.cancel();
  expect(sent.at(-1)).toEqual({ type: "end_going", removes: false });
  expect(scissors.armed).toBe(false);
});

test("it removes what is shown, and nothing whose preview is gone", () => {
  const scissors = new ScissorsControl(session);
  scissors.start();
  paint(scissors, bend);
  session.scissors = { type: "scissors", preview: 77, goes_ml: 1 };
  scissors.remove();
  expect(sent).toHaveLength(1);
  session.scissors = { type: "scissors", preview: 9, goes_ml: 1 };
  scissors.remove();
  expect(sent.slice(1)).toEqual([{ type: "end_going", removes: true }]);
});

test("what was cut before the page was loaded can go, or stay", () => {
  for (const removes of [true, false]) {
    const scissors = new ScissorsControl(session);
    sent.length = 0;
    session.scissors = { type: "scissors", preview: 9, goes_ml: 1 };
    expect(scissors.armed).toBe(false);
    expect(scissors.ready).toBe(true);
    if (removes) scissors.remove();
    else scissors.cancel();
    expect(sent).toEqual([{ type: "end_going", removes }]);
    expect(scissors.ready).toBe(false);
  }
});

test("one line is painted at a time: a cut puts the scissors away", () => {
  const scissors = new ScissorsControl(session);
  const cutting = new CutControl(session, () => { scissors.cancel(); });
  scissors.start();
  expect(armedLine({ cutting, scissors })).toBe(scissors);
  cutting.start(1);
  expect(armedLine({ cutting, scissors })).toBe(cutting);
  expect(scissors.armed).toBe(false);
});
