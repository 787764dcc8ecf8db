import { expect, test } from "vitest";
import { NeedleTrack } from "../../../src/core/tools/needle_track";
import { addScaled, distance, dot, normalize, type Vec3 } from "../../../src/core/geometry/vector";
import { Random } from "../../support/random";

type Taken = Parameters<NeedleTrack["take"]>[0];

function at(depth: number | null, proxy: Vec3): Taken {
  return {
    needle: { inside: depth !== null, depth: depth ?? 0, segment: 1, tip: 0, friction: 0, wall: 0, events: 0 },
    tool: {
      ...{ kind: "needle", radius: 0.455, on: true, voxels: 0, volume: 0, time: 0, energy: 0, load: 0 },
      ...{ undo_bytes: 0, undo_budget: 1 },
    },
    proxy,
  };
}

test("the line of a needle is found from its depths, through the sway of a hand", () => {
  const random = new Random(3);
  const entry: Vec3 = [10, 20, 30];
  const direction = normalize([1, 2, -0.5]);
  const track = new NeedleTrack();
  track.take(at(null, entry));
  for (let depth = 0.3; depth < 40; depth += 0.4) {
    // a tenth of a millimetre aside, as tissue lets a shaft give way
    const aside: Vec3 = [random.between(-0.1, 0.1), random.between(-0.1, 0.1), random.between(-0.1, 0.1)];
    track.take(at(depth, addScaled(addScaled(entry, direction, depth), aside, 1)));
  }
  const { line } = track;
  // the mean of a hundred places is a tenth as far off as one
  expect(distance(line?.entry ?? [0, 0, 0], entry)).toBeLessThan(0.1);
  expect(dot(line?.direction ?? [0, 0, 0], direction)).toBeGreaterThan(1 - 1e-4);
});

test("just behind the surface the line leads from where the needle was seen last", () => {
  const track = new NeedleTrack();
  track.take(at(null, [0, 0, 0]));
  track.take(at(0.2, [0, 0, 0.2]));
  expect(track.line).toBeNull();
  track.take(at(1, [0, 0, 1]));
  expect(track.line).toEqual({ entry: [0, 0, 0], direction: [0, 0, 1] });
});

test("a needle that is in before the page has seen it touch has a line too", () => {
  const track = new NeedleTrack();
  track.take(at(null, [0, 0, -2]));
  track.take(at(8, [0, 0, 8]));
  expect(track.line).toEqual({ entry: [0, 0, 0], direction: [0, 0, 1] });
});

test("a page that is opened while a needle is in knows its line once it moves", () => {
  const track = new NeedleTrack();
  track.take(at(20, [0, 0, 20]));
  expect(track.line).toBeNull();
  track.take(at(24, [0, 0, 24]));
  expect(track.line?.entry[2]).toBeCloseTo(0, 9);
  expect(track.line?.direction).toEqual([0, 0, 1]);
});

test("withdrawn it has no line, and the next one begins anew", () => {
  const track = new NeedleTrack();
  track.take(at(1, [0, 0, 1]));
  track.take(at(9, [0, 0, 9]));
  track.take(at(null, [5, 0, 0]));
  expect(track.line).toBeNull();
  track.take(at(2, [7, 0, 0]));
  expect(track.line).toEqual({ entry: [5, 0, 0], direction: [1, 0, 0] });
});
