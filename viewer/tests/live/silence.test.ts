import { expect, test } from "vitest";
import { lookEvery, SilenceWatch, type Silence } from "../../src/live/silence";

/** What it tells while it looks on time, from one time to another [ms]. */
function told(watch: SilenceWatch, from: number, to: number): (readonly [number, Silence])[] {
  const all: (readonly [number, Silence])[] = [];
  for (let now = from; now <= to; now += lookEvery) {
    const silence = watch.look(now);
    if (silence !== null) {
      all.push([now, silence]);
    }
  }
  return all;
}

test("a silence is told when it begins, when it is long, and when it ends", () => {
  const watch = new SilenceWatch();
  watch.look(1000);
  expect(watch.heard(1000)).toBeNull();
  expect(told(watch, 1100, 6000)).toEqual([
    [1400, "short"],
    [5100, "long"],
  ]);
  expect(watch.heard(6010)).toBe("none");
  expect(watch.heard(6020)).toBeNull();
});

test("who looks late may not have read yet what has come", () => {
  const watch = new SilenceWatch();
  watch.look(1000);
  watch.heard(1000);
  expect(watch.look(2000)).toBeNull();
  expect(watch.look(2100)).toBe("short");
});

test("nothing is waited for before the first word and after the end", () => {
  const watch = new SilenceWatch();
  expect(told(watch, 0, 5000)).toEqual([]);
  watch.heard(5000);
  expect(told(watch, 5100, 6000)).toEqual([[5400, "short"]]);
  expect(watch.forget()).toBe("none");
  expect(told(watch, 6000, 9000)).toEqual([]);
});
