/** Actions that are found by typing. */
import { expect, test } from "vitest";
import { searchActions } from "../../../src/core/base/action_search";

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
