import { expect, test } from "vitest";
import type { FromPage } from "../../../../src/core/protocol";
import { EditRateControl } from "../../../../src/ui/features/scan/edit_rate_control.svelte";
import type { Session } from "../../../../src/ui/state/session.svelte";

function setUp(): { control: EditRateControl; sent: FromPage[]; engine: { greetings: number } } {
  const sent: FromPage[] = [];
  const engine = { greetings: 1, send: (message: FromPage) => sent.push(message) };
  return { control: new EditRateControl(engine as unknown as Session), sent, engine };
}

/** Frames that are so far apart, each with an edit. */
function frames(control: EditRateControl, apart: number, first = 0): void {
  for (let i = 1; i <= 30; ++i) {
    control.begin((first + i) * apart, first + i);
  }
}

test("a slow page asks for every fourth frame, once", () => {
  const { control, sent } = setUp();
  frames(control, 17);
  expect(sent).toEqual([]);
  frames(control, 200, 1000);
  expect(sent.at(-1)).toEqual({ type: "follow_edits", every: 4 });
  const count = sent.length;
  frames(control, 200, 2000);
  expect(sent).toHaveLength(count);
});

test("frames without edits say nothing of how long edits take", () => {
  const { control, sent } = setUp();
  for (let i = 1; i <= 100; ++i) {
    control.begin(200 * i, 7);
  }
  expect(sent).toEqual([]);
});

test("what a person chooses holds, and a new engine is told again", () => {
  const { control, sent, engine } = setUp();
  control.choose(2);
  frames(control, 300);
  expect(sent).toEqual([{ type: "follow_edits", every: 2 }]);
  expect(control.every).toBe(2);
  engine.greetings += 1;
  control.begin(10_000, 31);
  expect(sent).toHaveLength(2);
  control.choose(1);
  control.begin(10_017, 31);
  expect(sent.at(-1)).toEqual({ type: "follow_edits", every: 1 });
});
