import { expect, test } from "vitest";
import { levelsAfter, movingPictures, DrawBudget } from "../../../src/core/view/draw_budget";
import { firstQuality } from "../../../src/core/view/quality";

const { frameBudget } = firstQuality(false);
const coarsest = movingPictures.at(-1);
const guess = { waits: 1, samples: 1e-3, triangles: 1e-4 };

/** A renderer with a fixed latency and a cost per sample [ms]. */
function learned(latency: number, perSample: number, budget = frameBudget): DrawBudget {
  const pace = new DrawBudget(budget, guess);
  for (let i = 0; i < 60; ++i) {
    const samples = i % 3 === 0 ? 2000 : 50000;
    pace.learnMoving({ waits: 1, samples, triangles: 0 }, latency + samples * perSample);
  }
  return pace;
}

/** Time of a frame while the view moves [ms], of `samples` at their finest. */
function frameTime(pace: DrawBudget, latency: number, perSample: number, samples: number): number {
  const { divisor, step } = pace.picture(samples);
  return latency + (samples * step * perSample) / divisor ** 2;
}

test("where nobody has chosen a picture that moves takes 33 ms on a GPU, and an eighth of a second on the CPU", () => {
  expect(firstQuality(false).frameBudget).toBe(33);
  expect(firstQuality(true).frameBudget).toBeLessThanOrEqual(125);
  // what is put together for the screen comes to that
  expect(firstQuality(true).frameBudget).toBeGreaterThanOrEqual(100);
});

test("the CPU draws a quarter of the resolution where it can eight times a second, and no less than an eighth", () => {
  // SwiftShader on two cores: a view of 806×735
  const pace = learned(15, 4.5e-3, firstQuality(true).frameBudget);
  expect(pace.picture(806 * 735).divisor).toBe(4);
  expect(learned(15, 1, firstQuality(true).frameBudget).picture(806 * 735)).toEqual({ divisor: 8, step: 0.25 });
});

test("a quick renderer draws every picture in full", () => {
  const pace = learned(4, 5e-6);
  expect(pace.picture(2e6)).toEqual({ divisor: 1, step: 1 });
});

test.each([8, 33, 100])("a budget of %i ms is kept by resolution and step, and used", (budget) => {
  for (const perSample of [1e-6, 1e-5, 1e-4, 4e-4]) {
    const samples = 600_000;
    const pace = learned(3, perSample, budget);
    const time = frameTime(pace, 3, perSample, samples);
    const chosen = movingPictures.indexOf(pace.picture(samples));
    // a tenth is left for screens, which show nothing between their refreshes
    const meant = 0.9 * budget;
    expect(time).toBeLessThanOrEqual(1.05 * meant);
    const finer = movingPictures[chosen - 1];
    if (finer !== undefined) {
      expect(3 + (samples * finer.step * perSample) / finer.divisor ** 2).toBeGreaterThan(0.95 * meant);
    }
  }
});

test("steps are coarser only once a quarter of the resolution is too slow, and both to a limit", () => {
  const chosen = [1e-6, 1e-4, 5e-4, 1.3e-3, 2e-3, 1].map((perSample) => learned(1, perSample).picture(600_000));
  expect(chosen.map(({ step }) => step)).toEqual([1, 1, 1, 0.5, 0.5, 0.25]);
  expect(chosen.at(-1)).toEqual(coarsest);
  expect(coarsest).toEqual({ divisor: 8, step: 0.25 });
  const costs = movingPictures.map(({ divisor, step }) => step / divisor ** 2);
  expect(costs).toEqual([...costs].sort((a, b) => b - a));
});

test("large pictures that were quicker than small ones do not make samples free", () => {
  const pace = new DrawBudget(frameBudget, { ...guess, samples: 5e-3 });
  // a skull that turns, and the same view of air
  for (let i = 0; i < 10; ++i) {
    pace.learnMoving({ waits: 1, samples: 4400, triangles: 0 }, 57);
    pace.learnMoving({ waits: 1, samples: 17_700, triangles: 0 }, 10);
    // at 20 to 35 ms for 10 000 samples a quarter of the resolution would take 70 at least
    expect(pace.picture(560_000).divisor).toBeGreaterThan(4);
  }
});

test("pictures that move become finer one by one, and coarser at once", () => {
  const pace = learned(1, 1);
  expect(pace.picture(600_000)).toEqual(coarsest);
  for (let i = 0; i < 120; ++i) {
    pace.learnMoving({ waits: 1, samples: i % 2 === 0 ? 2000 : 50_000, triangles: 0 }, 1);
  }
  const finer = movingPictures.map(() => pace.picture(600_000));
  expect(finer).toEqual([...movingPictures.slice(0, -1).reverse(), movingPictures[0]]);
  pace.learnMoving({ waits: 1, samples: 600_000, triangles: 0 }, 40_000);
  expect(pace.picture(600_000)).toEqual(coarsest);
});

test("a picture is no coarser where that would save next to nothing", () => {
  // the coarsest one takes 60 ms too
  const pace = learned(60, 1e-4);
  expect(pace.picture(5e4)).toEqual({ divisor: 1, step: 1 });
  expect(pace.picture(2e5)).toEqual({ divisor: 2, step: 1 });
});

/** Draws so many pictures, of `samples` at their finest, with what they really cost [ms]. */
function turnedFor(pace: DrawBudget, pictures: number, samples: number, latency: number, perSample: number): number[] {
  return Array.from({ length: pictures }, () => {
    const { divisor, step } = pace.picture(samples);
    const taken = (samples * step) / divisor ** 2;
    pace.learnMoving({ waits: 1, samples: taken, triangles: 0 }, latency + perSample * taken);
    return latency + perSample * taken;
  });
}

test.each([
  ["all of their time to samples", { waits: 0, samples: 0.04 }],
  ["all of their time to waits", { waits: 22, samples: 0 }],
])("pictures of one size are found out that laid %s", (_, believed) => {
  const pace = new DrawBudget(frameBudget, guess);
  const [latency, perSample] = [14, 0.011];
  for (let i = 0; i < 60; ++i) {
    pace.learnMoving({ waits: 1, samples: 540, triangles: 0 }, believed.waits + believed.samples * 540);
  }
  const times = turnedFor(pace, 200, 307_200, latency, perSample);
  // an eighth of the resolution takes 27 ms, a twelfth 20; what is tried meanwhile is late at times
  expect(times.at(-1)).toBeCloseTo(latency + (perSample * 307_200 * 0.25) / 64, 6);
  expect(times.filter((time) => time > frameBudget).length).toBeLessThan(10);
});

test("what is tried in vain is tried ever more rarely, and never takes many times as long", () => {
  const pace = learned(2, 0.02);
  const times = turnedFor(pace, 1000, 307_200, 2, 0.02);
  const late = times.filter((time) => time > frameBudget);
  // the coarsest takes 26 ms, the next one 50: tried after 24 pictures, 48, 96, 192, 384 and 768
  expect(late.length).toBeGreaterThan(2);
  expect(late.length).toBeLessThan(10);
  expect(Math.max(...late)).toBeLessThan(2 * frameBudget);
});

/** Draws pictures at rest of 900×700 pixels, of rows that cost as told [ms each]; what each piece took. */
function pieces(pace: DrawBudget, rowCost: (row: number) => number, count = 1): number[] {
  const taken: number[] = [];
  for (let i = 0; i < count; ++i) {
    for (let row = 0; row < 700;) {
      const rows = Math.min(700 - row, pace.pieceRows(900, 700, 1));
      const time = Array.from({ length: rows }, (_, k) => rowCost(row + k)).reduce((sum, cost) => sum + cost, 0);
      pace.learnPiece(900 * rows, time);
      taken.push(time);
      row += rows;
    }
  }
  return taken;
}

test("pieces take the time that is meant for them, also where air is followed by a skull", () => {
  const pace = new DrawBudget(firstQuality(true).frameBudget, guess);
  pace.learnMoving({ waits: 1, samples: 18_000, triangles: 0 }, 110);
  const taken = pieces(pace, (row) => (row < 300 ? 0.5 : 6), 2);
  const { pieceBudget } = pace;
  // of each picture the one that reaches from air into the skull, and the next
  expect(taken.filter((time) => time > 2.1 * pieceBudget).length).toBeLessThanOrEqual(2 * 2);
  expect(taken.reduce((sum, time) => sum + time, 0) / taken.length).toBeGreaterThan(0.5 * pieceBudget);
});

test("where each piece is waited for long, none is smaller than a picture that moves", () => {
  const pace = new DrawBudget(firstQuality(true).frameBudget, guess);
  pace.learnMoving({ waits: 1, samples: 2300, triangles: 0 }, 150);
  for (let i = 0; i < 20; ++i) {
    pace.learnPiece(100, 150);
  }
  // half of all steps in a quarter of a view
  expect(pace.pieceRows(202, 184, 0.5)).toBe(Math.floor(2300 / 101));
});

test("the last rows of a picture do not make the pieces of the next one small", () => {
  const pace = new DrawBudget(33, guess);
  pace.learnPiece(900 * 300, 33);
  const rows = pace.pieceRows(900, 700, 1);
  pace.learnPiece(900, 1);
  expect(pace.pieceRows(900, 700, 1)).toBe(rows);
});

test("a picture is never cut into more than 32 pieces for each step", () => {
  const pace = new DrawBudget(33, guess);
  pace.learnPiece(1000, 10_000);
  expect(pace.pieceRows(1000, 640, 1)).toBe(20);
  expect(pace.pieceRows(1000, 640, 2)).toBe(10);
});

test("every picture ends at full resolution and all steps, by few that are each finer than the one before", () => {
  for (const { divisor } of movingPictures) {
    const levels = levelsAfter(divisor);
    expect(levels.at(-1)).toEqual({ divisor: 1, step: 1 });
    const divisors = [divisor, ...levels.slice(0, -1).map((level) => level.divisor)];
    expect(divisors).toEqual([...divisors].sort((a, b) => b - a));
    // each costs four times as much at most as the one before: it is soon seen
    divisors.slice(1).forEach((finer, i) => expect((divisors[i] ?? 0) / finer).toBeLessThanOrEqual(2));
  }
  expect(levelsAfter(8).map(({ divisor }) => divisor)).toEqual([4, 2, 1]);
});

/** Has drawn pictures that move, with all triangles and with few by turns, and strips at rest without any. */
function learnedTriangles(perTriangle: number): DrawBudget {
  const pace = new DrawBudget(frameBudget, { waits: 1, samples: 1e-4, triangles: 1e-5 });
  for (let i = 0; i < 300; ++i) {
    const [samples, triangles] = [i % 3 === 0 ? 10_000 : 40_000, [600_000, 0, 80_000, 0][i % 4] ?? 0];
    pace.learnMoving({ waits: 1, samples, triangles }, 2 + 1e-4 * samples + perTriangle * triangles);
  }
  return pace;
}

test("surfaces that are drawn in time are drawn with all their triangles", () => {
  const pace = learnedTriangles(1e-6);
  expect(pace.detail(100_000, 600_000)).toBe("all");
  // 10 ms of samples and 12 ms of triangles fit; 12 million take 120 ms
  expect(learnedTriangles(1e-5).detail(100_000, 1_200_000)).toBe("all");
  expect(learnedTriangles(1e-5).detail(100_000, 12_000_000)).toBe("few");
});

test("where a coarser picture makes room for them surfaces keep all triangles in up to half of a frame", () => {
  // 16.5 ms are half of it; what is learned may be a tenth off
  expect(learnedTriangles(1e-4).detail(1e6, 148_000)).toBe("all");
  expect(learnedTriangles(1e-4).detail(1e6, 182_000)).toBe("few");
});

test("what takes about half of a frame does not come and go", () => {
  const pace = learnedTriangles(1e-4);
  expect(pace.detail(1e6, 300_000)).toBe("few");
  expect(pace.detail(1e6, 148_000)).toBe("few");
  expect(pace.detail(1e6, 110_000)).toBe("all");
  expect(pace.detail(1e6, 148_000)).toBe("all");
});

test("triangles leave samples the rest of a frame, and take nothing from them where that would save nothing", () => {
  const pace = learnedTriangles(1e-4);
  const samples = 250_000;
  expect(pace.picture(samples)).toEqual({ divisor: 1, step: 1 });
  // 10 ms of triangles leave 18 ms for 25 ms of samples
  expect(pace.picture(samples, 100_000)).toEqual({ divisor: 2, step: 1 });
  expect(pace.picture(samples, 1e9)).toEqual({ divisor: 1, step: 1 });
});

test("first pictures that were slow, with programs to be made, leave nothing behind", () => {
  const pace = new DrawBudget(frameBudget, { waits: 3, samples: 1e-2, triangles: 2e-4 });
  pace.learnMoving({ waits: 1, samples: 5300, triangles: 0 }, 145);
  pace.learnMoving({ waits: 1, samples: 1800, triangles: 590_000 }, 490);
  const [samples, triangles] = [300_000, 106_000];
  const drawn = Array.from({ length: 60 }, () => {
    const { divisor, step } = pace.picture(samples, triangles);
    const taken = (samples * step) / divisor ** 2;
    pace.learnMoving({ waits: 1, samples: taken, triangles }, 5 + 0.01 * taken + 2e-4 * triangles);
    return taken;
  });
  // 26 ms are not the samples'; and the coarsest picture takes 32, not much less than one with 10 of samples
  expect(Math.max(...drawn.slice(10)) * 0.01).toBeLessThan(0.5 * frameBudget);
});
