/** Keys as the browser tells them, and actions that are found by typing. */
import { expect, test } from "vitest";
import { searchActions } from "../../../src/core/base/action_search";
import { shortcutsOf, shownShortcut } from "../../../src/core/base/shortcuts";

const press = (key: string, held: Partial<Record<"ctrlKey" | "metaKey" | "shiftKey", boolean>> = {}) =>
  shortcutsOf({ key, ctrlKey: false, metaKey: false, shiftKey: false, ...held });

test("letters mean the same in both cases, and Shift means something only where nothing else does", () => {
  expect(press("f")).toEqual(["F"]);
  expect(press("G", { shiftKey: true })).toEqual(["Shift+G", "G"]);
  expect(press("?", { shiftKey: true })).toEqual(["Shift+?", "?"]);
  expect(press("Escape")).toEqual(["Esc"]);
  expect(press("Enter")).toEqual(["Enter"]);
});

test("with Ctrl or Command a key means that alone", () => {
  expect(press("z", { ctrlKey: true })).toEqual(["Ctrl+Z"]);
  expect(press("Z", { metaKey: true, shiftKey: true })).toEqual(["Ctrl+Shift+Z"]);
});

test("keys are written to be read", () => {
  expect(["Ctrl+Shift+Z", "+", "-", "F"].map(shownShortcut)).toEqual(["Ctrl + Shift + Z", "+", "\u2212", "F"]);
});

const actions = [
  { group: "Look", name: "Show all" },
  { group: "Marks", name: "Measure a distance" },
  { group: "Work", name: "Undo" },
  { group: "Touch", name: "Show the contact normal" },
  { group: "Look", name: "Preset CT-Bone" },
];
const found = (typed: string) => searchActions(actions, typed).map(({ name }) => name);

test("all actions stand in their order where nothing is typed", () => {
  expect(found("  ")).toEqual(actions.map(({ name }) => name));
});

test("every word must be found, in the name or the group", () => {
  expect(found("dist")).toEqual(["Measure a distance"]);
  expect(found("touch show")).toEqual(["Show the contact normal"]);
  expect(found("bone ct")).toEqual(["Preset CT-Bone"]);
  expect(found("nothing like it")).toEqual([]);
});

test("names that begin with it come before words that do, and those before the rest", () => {
  const named = ["A distant show", "Shown", "Overshow"].map((name) => ({ group: "", name }));
  expect(searchActions(named, "show").map(({ name }) => name)).toEqual(["Shown", "A distant show", "Overshow"]);
});
