/** What is kept with a scan, between two pages that change it at once and an engine that numbers the changes. */
import { expect, test } from "vitest";
import type { FromPage, Keep } from "../../../src/core/protocol";
import { ScanMemory } from "../../../src/ui/state/scan_memory";

function page() {
  const sent: Keep[] = [];
  const changed: [string, object | null][] = [];
  const memory = new ScanMemory((message: FromPage) => {
    if (message.type === "keep") sent.push(message);
  });
  memory.onChange((name, value) => changed.push([name, value]));
  const report = (name: string, version: number, value: object | null, answers = false): void => {
    const part = { name, version, value: value === null ? null : JSON.stringify(value) };
    memory.take({ type: "kept", part, answers });
  };
  return { memory, sent, changed, report };
}

test("what is sent says what it was changed after, and the same is not sent again", () => {
  const { memory, sent } = page();
  memory.greet([{ name: "clip", version: 4, value: '{"on":true}' }]);
  memory.keep("clip", { on: true });
  memory.keep("clip", { on: false });
  memory.keep("window", null);
  expect(sent).toEqual([{ type: "keep", name: "clip", value: '{"on":false}', after: 4 }]);
});

test("an old answer does not undo what was dragged further since", () => {
  const { memory, changed, report } = page();
  for (const at of [1, 2, 3]) memory.keep("clip", { at });
  report("clip", 1, { at: 1 }, true);
  report("clip", 2, { at: 2 }, true);
  expect(memory.recall("clip", { at: 0 })).toEqual({ at: 3 });
  report("clip", 3, { at: 3 }, true);
  expect(changed).toEqual([]);
});

test("where another page was first, its change is what holds in the end", () => {
  const { memory, changed, report } = page();
  memory.keep("clip", { at: 1 });
  report("clip", 1, { at: 9 });
  expect(memory.recall("clip", { at: 0 })).toEqual({ at: 1 });
  // the engine has refused it
  report("clip", 1, { at: 9 }, true);
  expect(memory.recall("clip", { at: 0 })).toEqual({ at: 9 });
  expect(changed).toEqual([["clip", { at: 9 }]]);
});

test("a new greeting brings what has changed while the connection was lost", () => {
  const { memory, changed } = page();
  memory.greet([{ name: "mark.1", version: 1, value: '{"name":"a"}' }, { name: "clip", version: 1, value: "{}" }]);
  changed.length = 0;
  memory.greet([{ name: "mark.2", version: 1, value: '{"name":"b"}' }, { name: "clip", version: 1, value: "{}" }]);
  expect(changed).toEqual([["mark.1", null], ["mark.2", { name: "b" }]]);
  expect(memory.all("mark")).toEqual([["2", { name: "b" }]]);
});
