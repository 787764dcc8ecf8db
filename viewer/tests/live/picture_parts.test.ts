import { expect, test } from "vitest";
import { PictureParts } from "../../src/live/picture_parts";

function part(serial: number, values: readonly number[], last = false) {
  return { type: "picture_part", serial, last, packed: Uint8Array.from(values) } as const;
}

test("parts make a picture with the last one", () => {
  const parts = new PictureParts();
  expect(parts.take(part(1, [1, 2]))).toBeNull();
  const joined = parts.take(part(1, [3], true));
  expect([...new Uint8Array(joined ?? new ArrayBuffer())]).toEqual([1, 2, 3]);
});

test("a picture that was given up on its way is forgotten", () => {
  const parts = new PictureParts();
  parts.take(part(1, [1, 2]));
  parts.take(part(2, [7]));
  const joined = parts.take(part(2, [8], true));
  expect([...new Uint8Array(joined ?? new ArrayBuffer())]).toEqual([7, 8]);
});
