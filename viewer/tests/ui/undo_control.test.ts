/** Undo of the whole page: steps of the engine and of the page come back in the order in which they were made. */
import { expect, test } from "vitest";
import type { FromPage, State } from "../../src/core/protocol";
import { EngineSteps } from "../../src/ui/engine_steps.svelte";
import { PageState } from "../../src/ui/page_state.svelte";
import { PageSteps } from "../../src/ui/page_steps.svelte";
import type { Session } from "../../src/ui/session.svelte";
import { UndoControl } from "../../src/ui/undo_control";

/** An engine that does what it is asked for when it is let to, and tells of it; and a page with one value. */
class Bench {
  done: string[] = [];
  undone: string[] = [];
  latest: State | null = null;
  greetings = 1;
  readonly kept: string[] = [];
  private bytes = 0;
  private asked: string[] = [];
  private waiters: (() => void)[] = [];
  private listener: (state: State) => void = () => undefined;

  private readonly engine = new EngineSteps(this as unknown as Session, () => {
    this.steps.forgetUndone();
  });
  readonly steps: PageSteps = new PageSteps(() => this.engine.count);
  readonly value = new PageState("red", this.steps, (value) => this.kept.push(value));
  readonly undo = new UndoControl(this.engine, this.steps);

  constructor() {
    this.tell();
  }

  get live(): State | null {
    return this.latest;
  }

  onState(listener: (state: State) => void): void {
    this.listener = listener;
  }

  send({ type }: FromPage): void {
    this.asked.push(type);
  }

  whenTold(told: () => void): void {
    this.waiters.push(told);
  }

  /** The engine makes a step, as by a stroke, or another page has it made. */
  edit(name: string): void {
    this.done.push(name);
    this.undone = [];
    this.bytes += 100;
    this.tell();
  }

  /** Another page takes the engine's last step back. */
  takeBackElsewhere(): void {
    this.undone.push(this.done.pop() ?? "");
    this.tell();
  }

  /** The engine does what the page has asked for, and tells of it. */
  answer(): void {
    for (const type of this.asked.splice(0)) {
      const [from, to] = type === "undo" ? [this.done, this.undone] : [this.undone, this.done];
      const step = from.pop();
      if (step !== undefined) to.push(step);
      // the inverse of a step weighs something else
      this.bytes += 7;
    }
    this.tell();
    for (const told of this.waiters.splice(0)) told();
  }

  private tell(): void {
    this.latest = { tool: { undo_bytes: this.bytes }, can_undo: this.done.length > 0, can_redo: this.undone.length > 0 } as State;
    this.listener(this.latest);
  }

  get now(): readonly [string, string] {
    return [this.value.now, this.done.join(" ")];
  }
}

function mixed(): Bench {
  const bench = new Bench();
  bench.value.change("colour", "green");
  bench.edit("cut");
  bench.edit("hole");
  bench.value.change("colour", "blue");
  bench.edit("scratch");
  bench.value.change("colour", "white");
  return bench;
}

const order: readonly (readonly [string, string])[] = [
  ["white", "cut hole scratch"],
  ["blue", "cut hole scratch"],
  ["blue", "cut hole"],
  ["green", "cut hole"],
  ["green", "cut"],
  ["green", ""],
  ["red", ""],
];

test.each([["as each is done", true], ["before the engine has answered", false]])("steps come back in their order: %s", (_, answers) => {
  const bench = mixed();
  const seen = [bench.now];
  for (let i = 1; i < order.length; i += 1) {
    bench.undo.undo();
    if (answers) bench.answer();
    seen.push(bench.now);
  }
  bench.answer();
  if (answers) expect(seen).toEqual(order);
  expect(bench.now).toEqual(order.at(-1));
  expect(bench.steps.canUndo).toBe(false);
  const again = [bench.now];
  for (let i = 1; i < order.length; i += 1) {
    bench.undo.redo();
    if (answers) bench.answer();
    again.push(bench.now);
  }
  bench.answer();
  if (answers) expect(again).toEqual([...order].reverse());
  expect(bench.now).toEqual(order[0]);
  expect([bench.undo.canUndo, bench.undo.canRedo]).toEqual([true, false]);
});

test("what comes next is called by its name where the page knows it", () => {
  const bench = mixed();
  expect([bench.undo.toUndo, bench.undo.toRedo]).toEqual(["colour", null]);
  bench.undo.undo();
  expect([bench.undo.toUndo, bench.undo.toRedo]).toEqual([null, "colour"]);
});

test("another step of the engine ends what of the page was taken back", () => {
  const bench = mixed();
  bench.undo.undo();
  bench.edit("dent");
  expect(bench.undo.canRedo).toBe(false);
  bench.undo.undo();
  bench.answer();
  expect(bench.now).toEqual(["blue", "cut hole scratch"]);
});

test("an edit that was taken back can be made again after the look was changed", () => {
  const bench = mixed();
  bench.undo.undo();
  bench.undo.undo();
  bench.answer();
  bench.value.change("colour", "grey");
  bench.undo.redo();
  bench.answer();
  expect(bench.now).toEqual(["grey", "cut hole scratch"]);
  bench.undo.undo();
  bench.answer();
  bench.undo.undo();
  expect(bench.now).toEqual(["blue", "cut hole"]);
});

test("where another page has taken an edit back, the page's own steps go on", () => {
  const bench = mixed();
  bench.takeBackElsewhere();
  bench.undo.undo();
  bench.undo.undo();
  expect(bench.now).toEqual(["green", "cut hole"]);
  bench.undo.undo();
  bench.answer();
  expect(bench.now).toEqual(["green", "cut"]);
});

test("changes of one name in one gesture are one step, others and those after it are not", () => {
  const { steps, value, kept } = new Bench();
  for (const next of ["a", "b", "c"]) value.change("slider", next, true);
  value.change("list", "d");
  value.change("list", "e");
  value.change("slider", "f", true);
  steps.endGesture();
  value.change("slider", "g", true);
  // a held key goes on
  steps.endGesture();
  steps.resumeGesture();
  value.change("slider", "h", true);
  // what is as it was is no step
  value.change("list", "h");
  const seen: string[] = [];
  while (steps.canUndo) {
    steps.undo();
    seen.push(value.now);
  }
  expect(seen).toEqual(["f", "e", "d", "c", "red"]);
  expect(kept.at(-1)).toBe("red");
  // undo ends a gesture
  steps.redo();
  value.change("slider", "z", true);
  steps.undo();
  expect(value.now).toBe("c");
});

test("with another scan the steps before are gone, those of others stay", () => {
  const { steps, value } = new Bench();
  const other = new PageState(0, steps, () => undefined);
  value.change("colour", "green");
  other.change("number", 1);
  value.open("black");
  steps.undo();
  expect([value.now, other.now, steps.canUndo]).toEqual(["black", 0, false]);
});
