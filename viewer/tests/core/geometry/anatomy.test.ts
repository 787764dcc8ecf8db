import { expect, test } from "vitest";
import { edgeLetters, lettersOf, sideName } from "../../../src/core/geometry/anatomy";
import { cubeFaces } from "../../../src/core/view/orientation_cube";
import { normalize } from "../../../src/core/geometry/vector";

test("directions along an axis have one letter, oblique ones two, the stronger first", () => {
  expect(lettersOf([1, 0, 0])).toBe("L");
  expect(lettersOf([0, 0, -1])).toBe("I");
  expect(lettersOf(normalize([-2, -1.2, 0]))).toBe("RA");
  expect(lettersOf(normalize([1, 0.2, 0]))).toBe("L");
});

test("letters at the edges of a view from before are those of a radiograph", () => {
  expect(edgeLetters([1, 0, 0], [0, 0, 1], true)).toEqual({ right: "L", left: "R", top: "S", bottom: "I" });
});

test("the cube shows one face from before and three from a corner, the nearest last", () => {
  const before = cubeFaces([1, 0, 0], [0, 0, 1], [0, -1, 0]);
  expect(before.map(({ letter }) => letter)).toEqual(["A"]);
  // the letter stands upright and unmirrored: right is right, down is down
  expect(before[0]?.matrix.map((m) => Math.round(m) + 0)).toEqual([1, 0, 0, 1, 0, 0]);

  const back = normalize([0.5, -1, 0.4]);
  const right = normalize([1, 0.5, 0]);
  const corner = cubeFaces(right, [-0.2, 0.4, 0.9], back);
  expect(corner.map(({ letter }) => letter)).toEqual(["S", "L", "A"]);
});

test("sides that no file tells are axes of the scan", () => {
  expect(edgeLetters([1, 0, 0], [0, 0, 1], false)).toEqual({ right: "+x", left: "−x", top: "+z", bottom: "−z" });
  expect(lettersOf(normalize([-2, -1.2, 0]), false)).toBe("−x −y");
  expect(sideName("A", false)).toBe("−y");
  expect(sideName("A", true)).toBe("anterior");
});
