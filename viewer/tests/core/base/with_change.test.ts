/** What was changed elsewhere meanwhile stays where a step is taken back. */
import { expect, test } from "vitest";
import { withChange } from "../../../src/core/base/with_change";

test("parts of an object change by their names", () => {
  expect(withChange({ a: 1, b: 9 }, { a: 1, b: 2 }, { a: 5, b: 2 })).toEqual({ a: 5, b: 9 });
});

test("things of a list change by their numbers", () => {
  const [one, two, three] = [{ id: 1, at: 0 }, { id: 2, at: 0 }, { id: 3, at: 0 }];
  const moved = { id: 1, at: 7 };
  expect(withChange([one, three], [one], [])).toEqual([three]);
  expect(withChange([moved, three], [one], [one, two])).toEqual([moved, three, two]);
  expect(withChange([three, one], [one], [moved])).toEqual([three, moved]);
});

test("where nothing has changed elsewhere the change is taken as it is", () => {
  const after = [{ id: 2 }, { id: 1 }];
  expect(withChange<unknown>([{ id: 1 }], [{ id: 1 }], after)).toBe(after);
  expect(withChange<unknown>(1, 2, 3)).toBe(3);
});
