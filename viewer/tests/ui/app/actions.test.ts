/** The table of actions: no key means two things, and the keyboard does what the table says. */
import { afterEach, expect, test, vi } from "vitest";
import { actionsOf, type ActionTargets } from "../../../src/ui/app/actions";
import { windowPresets } from "../../../src/core/appearance/window_level";
import type { HandControl } from "../../../src/ui/features/touch/hand_control.svelte";
import { KeyboardInput } from "../../../src/ui/app/input/keyboard_input";
import type { Session } from "../../../src/ui/state/session.svelte";
import type { ViewControl } from "../../../src/ui/features/view/view_control.svelte";

afterEach(() => {
  vi.unstubAllGlobals();
});

// what actions do is their targets' business: the table only names them
const actions = actionsOf({
  session: {},
  stage: { slices: { presets: windowPresets } },
  hand: {},
  tool: {},
  undo: {},
  exporter: {},
  theme: {},
  page: {},
} as unknown as ActionTargets);

test("no two actions have the same name or key", () => {
  const names = actions.map(({ group, name }) => `${group} ${name}`);
  const keys = actions.filter(({ overSlice }) => overSlice !== true).flatMap((action) => action.keys);
  const inSlices = actions.filter(({ overSlice }) => overSlice === true).flatMap((action) => action.keys);
  expect(new Set(names).size).toBe(names.length);
  expect(new Set(keys).size).toBe(keys.length);
  expect(new Set(inSlices).size).toBe(inSlices.length);
  expect(keys.length).toBeGreaterThan(30);
});

const signs = (by: readonly number[]): string => by.map(Math.sign).join(" ");

/** A page's keyboard, the keys of which can be pressed here. */
function keyboard() {
  const listeners: Record<string, (event: object) => void> = {};
  const done: string[] = [];
  vi.stubGlobal("HTMLElement", Map);
  vi.stubGlobal("window", {
    addEventListener: (type: string, listener: (event: object) => void) => (listeners[type] = listener),
  });
  const told = (what: string) => () => {
    done.push(what);
  };
  let ready = false;
  let over = false;
  const table = [
    { group: "Work", name: "save", keys: ["Ctrl+S"], run: told("save") },
    { group: "Work", name: "sound", keys: ["S"], run: told("sound") },
    { group: "Work", name: "seal", keys: ["Shift+G"], run: told("seal") },
    { group: "Work", name: "grab", keys: ["G"], run: told("grab"), end: told("let go") },
    { group: "Look", name: "look", keys: ["1"], run: told("look") },
    { group: "Slices", name: "window", keys: ["1"], overSlice: true, run: told("window") },
    { group: "Work", name: "cut", keys: ["Enter"], ready: () => ready, run: told("cut") },
  ] as const;
  vi.stubGlobal("requestAnimationFrame", () => 0);
  const hand = { move: (...by: number[]) => done.push(`hand ${signs(by)}`) } as unknown as HandControl;
  const view = {
    turn: (...by: number[]) => done.push(`turn ${signs(by)}`),
    move: (...by: number[]) => done.push(`picture ${signs(by)}`),
    approach: (factor: number) => done.push(...(factor === 1 ? [] : [factor < 1 ? "nearer" : "farther"])),
  } as unknown as ViewControl;
  const stop = new KeyboardInput({ offer: null } as Session, hand, view, table, () => over).listen();
  const send = (type: string, key: string, held: object = {}): boolean => {
    let taken = false;
    const none = { code: "", ctrlKey: false, metaKey: false, shiftKey: false, altKey: false, target: null };
    const event = { key, ...none, ...held };
    listeners[type]?.({ ...event, getModifierState: () => false, preventDefault: () => (taken = true) });
    return taken;
  };
  return { send, done, stop, makeReady: () => (ready = true), goOver: (slice: boolean) => (over = slice) };
}

test("a key does its action, and is the browser's where it means nothing", () => {
  const { send, done, makeReady } = keyboard();
  expect(send("keydown", "s")).toBe(true);
  expect(send("keydown", "S", { shiftKey: true })).toBe(true);
  expect(send("keydown", "s", { ctrlKey: true })).toBe(true);
  expect(send("keydown", "G", { shiftKey: true })).toBe(true);
  expect(send("keydown", "s", { ctrlKey: true, shiftKey: true })).toBe(false);
  expect(send("keydown", "Enter")).toBe(false);
  makeReady();
  expect(send("keydown", "Enter")).toBe(true);
  expect(done).toEqual(["sound", "sound", "save", "seal", "cut"]);
});

test("Enter is of the button or field that has the focus; a slider has no use for it", () => {
  class Focused {
    constructor(private readonly kind: string) {}
    matches(selector: string): boolean {
      return selector.split(", ").includes(this.kind);
    }
  }
  const { send, done, makeReady } = keyboard();
  vi.stubGlobal("HTMLElement", Focused);
  makeReady();
  for (const kind of ["button", "summary", "[role=button]"]) {
    expect(send("keydown", "Enter", { target: new Focused(kind) }), kind).toBe(false);
  }
  expect(done).toEqual([]);
  expect(send("keydown", "Enter", { target: new Focused("div") })).toBe(true);
  expect(send("keydown", "Enter", { target: new Focused("input[type=range]") })).toBe(true);
  expect(done).toEqual(["cut", "cut"]);
});

test("a digit means a window over a slice, and a side elsewhere", () => {
  const { send, done, goOver } = keyboard();
  send("keydown", "1", { code: "Digit1" });
  goOver(true);
  send("keydown", "1", { code: "Digit1" });
  send("keydown", "s");
  goOver(false);
  send("keydown", "1", { code: "Digit1" });
  expect(done).toEqual(["look", "window", "sound", "look"]);
});

test("what lasts while a key is held ends with it, once, also where Shift comes between or the page is left", () => {
  const { send, done, stop } = keyboard();
  send("keyup", "g");
  send("keydown", "g");
  send("keyup", "G", { shiftKey: true });
  send("keyup", "g");
  expect(done).toEqual(["grab", "let go"]);
  send("keydown", "g");
  send("blur", "");
  stop();
  expect(done).toEqual(["grab", "let go", "grab", "let go"]);
});

test("arrows move the hand, with Shift turn the view, with Ctrl move the picture; page keys go along the view", () => {
  const { send, done } = keyboard();
  for (const [key, held] of [
    ["ArrowRight", {}],
    ["ArrowRight", { shiftKey: true }],
    ["PageUp", { shiftKey: true }],
    ["ArrowDown", { ctrlKey: true }],
    ["ArrowLeft", { metaKey: true }],
    ["PageDown", {}],
  ] as const) {
    expect(send("keydown", key, held)).toBe(true);
    send("keyup", key, held);
  }
  expect(done).toEqual(["hand 1 0 0", "turn 1 0", "turn 0 0", "nearer", "picture 0 1", "picture -1 0", "hand 0 0 -1"]);
});
