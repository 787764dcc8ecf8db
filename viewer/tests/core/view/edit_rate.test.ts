import { expect, test } from "vitest";
import { EditRate } from "../../../src/core/view/edit_rate";

function after(milliseconds: number, pace = new EditRate()): EditRate {
  for (let i = 0; i < 40; ++i) {
    pace.learn(milliseconds);
  }
  return pace;
}

test.each([
  [1000 / 60, 1],
  [24, 1],
  [34, 2],
  [60, 4],
  [270, 4],
])("where a frame with an edit takes %d ms, every %d. frame follows", (milliseconds, every) => {
  expect(after(milliseconds).every).toBe(every);
});

test("a page that is about as quick as one pace allows does not change to and fro", () => {
  const pace = after(30);
  const found = new Set<number>();
  for (let i = 0; i < 60; ++i) {
    pace.learn(i % 2 === 0 ? 22 : 28);
    found.add(pace.every);
  }
  expect(found).toEqual(new Set([2]));
  // but a quick one is taken at its word
  expect(after(17, pace).every).toBe(1);
});

test("one slow frame does not make a machine slow", () => {
  const pace = after(17);
  pace.learn(600);
  expect(pace.every).toBe(1);
});

test("what a page in the background took tells nothing", () => {
  expect(after(30_000).every).toBe(1);
  expect(after(0).every).toBe(1);
});
