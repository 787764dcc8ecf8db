/** Where gestures end: at a press of the mouse or a key, or when a control was let go; not while a key is held. */
import { afterEach, expect, test, vi } from "vitest";
import { PageState } from "../../../src/ui/state/page_state.svelte";
import { PageSteps } from "../../../src/ui/state/page_steps.svelte";
import { followGestures } from "../../../src/ui/app/input/step_gestures";

afterEach(() => {
  vi.unstubAllGlobals();
});

test.each([
  ["a drag of the mouse", ["pointerdown", 1, 2, 3, "change"], 1],
  ["two drags", ["pointerdown", 1, 2, "change", "pointerdown", 3, 4, "change"], 2],
  ["two drags in the picture, which is no control", ["pointerdown", 1, 2, "pointerdown", 3, 4], 2],
  ["two presses of a key", ["keydown", 1, "change", "keydown", 2, "change"], 2],
  ["a key that is held", ["keydown", 1, "change", "held", 2, "change", "held", 3, "change"], 1],
  ["a control that is moved by neither", [1, 2, "change", 3, "change"], 2],
] as const)("%s", (_, events, count) => {
  const listeners: Record<string, (event: object) => void> = {};
  vi.stubGlobal("window", {
    addEventListener: (type: string, listener: (event: object) => void) => (listeners[type] = listener),
  });
  const steps = new PageSteps(() => 0);
  const value = new PageState(0, steps, () => undefined);
  followGestures(steps);
  for (const event of events) {
    if (typeof event === "number") value.change("slider", event, true);
    else listeners[event === "held" ? "keydown" : event]?.({ repeat: event === "held" });
  }
  let made = 0;
  for (; steps.canUndo; made += 1) steps.undo();
  expect([made, value.now]).toEqual([count, 0]);
});
