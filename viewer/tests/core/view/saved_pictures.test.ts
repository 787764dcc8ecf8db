/** Strips of pictures that the engine draws for files: put together whatever pieces they arrive in. */
import { encode } from "@msgpack/msgpack";
import { expect, test } from "vitest";
import { savedSamples, Strips } from "../../../src/core/view/saved_pictures";

function packed(number: number, width: number): Uint8Array {
  const message = encode({
    type: "drawn_picture",
    number,
    size: [width, 2],
    eyes: 1,
    part: null,
    over: null,
    state: 0,
    divisor: 1,
    samples: 1,
    finished: true,
    milliseconds: 3,
    coding: "raw",
    colours: new Uint8Array(16 * width).fill(number),
    brightest: 1,
    depths: new Uint8Array(4 * width).fill(number),
    depth_every: 1,
    nearest: 0,
    farthest: 1,
  });
  const part = new Uint8Array(4 + message.length);
  new DataView(part.buffer).setUint32(0, message.length, true);
  part.set(message, 4);
  return part;
}

test.each([1, 3, 100, 1000])("strips are whole in pieces of %i bytes", (piece) => {
  const parts = [packed(0, 8), packed(1, 3), packed(2, 5)];
  const all = new Uint8Array(parts.flatMap((part) => [...part]));
  const strips = new Strips();
  const taken = [];
  for (let i = 0; i < all.length; i += piece) {
    taken.push(...strips.take(all.subarray(i, i + piece)));
  }
  expect(taken.map(({ number, size, colours, depths }) => [number, size[0], colours.length, depths.length])).toEqual([
    [0, 8, 128, 32],
    [1, 3, 48, 12],
    [2, 5, 80, 20],
  ]);
  expect(taken.every(({ number, colours }) => colours.every((byte) => byte === number))).toBe(true);
});

test("what is no picture is told", () => {
  const message = encode({ type: "matter_parts" });
  const part = new Uint8Array([message.length, 0, 0, 0, ...message]);
  expect(() => new Strips().take(part)).toThrow("expected");
});

test("a picture that is saved has as many rays for each pixel of the screen as its quality says", () => {
  const screen = { width: 100, height: 80 };
  const times = (factor: number): typeof screen => ({ width: 100 * factor, height: 80 * factor });
  expect([1, 2, 3, 8].map((factor) => savedSamples(1, times(factor), screen))).toEqual([4, 1, 1, 1]);
  expect([1, 2, 4, 8].map((factor) => savedSamples(24, times(factor), screen))).toEqual([24, 6, 2, 1]);
});
