/** Undo of the whole page: steps of the engine and of the page come back in the order in which they were made. */
import { expect, test } from "vitest";
import type { FromPage, State } from "../../../src/core/protocol";
import { EngineSteps } from "../../../src/ui/state/engine_steps.svelte";
import { PageState } from "../../../src/ui/state/page_state.svelte";
import { PageSteps } from "../../../src/ui/state/page_steps.svelte";
import type { Session } from "../../../src/ui/state/session.svelte";
import { UndoControl } from "../../../src/ui/app/undo_control";

/** An engine that does what it is asked for when it is let to, and tells of it later; and a page with one value. */
class Bench {
  done: string[] = [];
  undone: string[] = [];
  latest: State | null = null;
  greetings = 1;
  readonly kept: string[] = [];
  private made = 0;
  private asked: string[] = [];
  private waiters: (() => void)[] = [];
  private listener: (state: State) => void = () => undefined;

  readonly steps: PageSteps = new PageSteps(() => this.engine.count);
  private readonly engine = new EngineSteps(this as unknown as Session, this.steps);
  readonly value = new PageState("red", this.steps, (value) => this.kept.push(value));
  readonly undo = new UndoControl(this as unknown as Session, this.engine, this.steps);

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

  whenSettled(settled: () => void): void {
    if (this.asked.length === 0) settled();
    else this.waiters.push(settled);
  }

  /** The engine makes a step, as by a stroke, or another page has it made. */
  edit(name: string): void {
    this.make(name);
    this.tell();
  }

  /** The page asks the engine for a step. */
  ask(name: string): void {
    this.asked.push(name);
  }

  /** Another page takes the engine's last step back. */
  takeBackElsewhere(): void {
    this.undone.push(this.done.pop() ?? "");
    this.tell();
  }

  /** The engine does all that the page has asked for, and tells of it. */
  answer(): void {
    do {
      for (const asked of this.asked.splice(0)) this.obey(asked);
      this.tell();
      for (const told of this.waiters.splice(0)) told();
    } while (this.asked.length > 0);
  }

  private obey(asked: string): void {
    if (asked === "undo") move(this.done, this.undone);
    else if (asked === "redo") move(this.undone, this.done);
    else this.make(asked);
  }

  private make(name: string): void {
    this.done.push(name);
    this.undone = [];
    this.made += 1;
  }

  private tell(): void {
    const [can_undo, can_redo] = [this.done.length > 0, this.undone.length > 0];
    this.latest = { step: this.done.length, steps_made: this.made, can_undo, can_redo } as State;
    this.listener(this.latest);
  }

  get now(): readonly [string, string] {
    return [this.value.now, this.done.join(" ")];
  }
}

function move(from: string[], to: string[]): void {
  const step = from.pop();
  if (step !== undefined) to.push(step);
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

test.each([
  ["as each is done", true],
  ["before the engine has answered", false],
])("steps come back in their order: %s", (_, answers) => {
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

test("an edit after one that another page took back is newer than the page's own step", () => {
  const bench = mixed();
  bench.takeBackElsewhere();
  bench.edit("dent");
  bench.undo.undo();
  bench.answer();
  expect(bench.now).toEqual(["white", "cut hole"]);
});

test("another page's edit ends what was taken back, also where one came back between", () => {
  const bench = mixed();
  bench.undo.undo();
  bench.takeBackElsewhere();
  bench.edit("dent");
  expect([bench.undo.canRedo, bench.now]).toEqual([false, ["blue", "cut hole dent"]]);
});

test("undo that is asked for before the engine has told of a step takes back that one", () => {
  const bench = mixed();
  bench.ask("dent");
  bench.undo.undo();
  bench.undo.undo();
  expect(bench.now).toEqual(["white", "cut hole scratch"]);
  bench.answer();
  expect(bench.now).toEqual(["blue", "cut hole scratch"]);
  bench.undo.redo();
  bench.undo.redo();
  bench.answer();
  expect(bench.now).toEqual(["white", "cut hole scratch dent"]);
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
