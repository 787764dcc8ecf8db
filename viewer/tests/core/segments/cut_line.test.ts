import { expect, test } from "vitest";
import { lookFrom, project } from "../../../src/core/geometry/camera";
import { freehandLine, simplified, underLine, type Place } from "../../../src/core/segments/cut_line";
import { dot, subtract } from "../../../src/core/geometry/vector";
import { Random } from "../../support/random";

const arc = (from: number, to: number, steps = 80): Place[] =>
  Array.from({ length: steps }, (_, i) => {
    const angle = from + ((to - from) * i) / (steps - 1);
    return [200 + 100 * Math.cos(angle), 150 + 100 * Math.sin(angle)];
  });

test("a click is no line, and what is painted keeps its ends", () => {
  expect(freehandLine([])).toBeNull();
  expect(freehandLine([[10, 10]])).toBeNull();
  expect(freehandLine([[10, 10], [13, 14]])).toBeNull();
  const line = freehandLine(arc(0, 2));
  expect(line?.closed).toBe(false);
  expect(line?.places[0]).toEqual([300, 150]);
  expect(line?.places.at(-1)).toEqual(arc(0, 2).at(-1));
  // a tolerance of a pixel needs few pieces for a third of a circle
  expect(line?.places.length).toBeLessThan(12);
});

test("a line whose ends come near one another is closed, a short one there and back is not", () => {
  expect(freehandLine(arc(0, 6.2))?.closed).toBe(true);
  expect(freehandLine([[10, 10], [40, 10], [12, 12]])?.closed).toBe(false);
});

test("no point that is left out was farther from the line than allowed", () => {
  const random = new Random(3);
  for (let round = 0; round < 50; ++round) {
    const places: Place[] = Array.from({ length: 60 }, (_, i) => [5 * i, random.between(-20, 20)]);
    const kept = simplified(places, 4);
    for (const place of places) {
      const near = kept.slice(1).some((to, i) => {
        const from = kept[i] ?? to;
        const share = Math.min(1, Math.max(0, along(place, from, to)));
        return (
          Math.hypot(place[0] - from[0] - share * (to[0] - from[0]), place[1] - from[1] - share * (to[1] - from[1])) <=
          4 + 1e-9
        );
      });
      expect(near).toBe(true);
    }
  }
});

function along(place: Place, from: Place, to: Place): number {
  const [x, y] = [to[0] - from[0], to[1] - from[1]];
  return ((place[0] - from[0]) * x + (place[1] - from[1]) * y) / (x * x + y * y);
}

test("a line of very many points is told in as many as the engine takes", () => {
  const random = new Random(8);
  const scribble: Place[] = Array.from({ length: 5000 }, () => [random.between(0, 900), random.between(0, 600)]);
  expect(freehandLine(scribble)?.places.length).toBeLessThanOrEqual(1000);
});

test("points under a line are seen where it was painted, before the eye", () => {
  const viewport = { width: 800, height: 600 };
  const outline = [[0, 0, 0], [100, 80, 120]] as const;
  const camera = lookFrom("L", { outline, centre: [50, 40, 60], radius: 90 }, viewport);
  const places: Place[] = [[0, 0], [400, 300], [799, 20]];
  const points = underLine(places, camera, viewport);
  points.forEach((point, i) => {
    const seen = project(camera, point, viewport);
    expect(seen?.[0]).toBeCloseTo(places[i]?.[0] ?? NaN, 6);
    expect(seen?.[1]).toBeCloseTo(places[i]?.[1] ?? NaN, 6);
    expect(dot(subtract(point, camera.target), camera.back)).toBeLessThan(camera.distance);
  });
});
