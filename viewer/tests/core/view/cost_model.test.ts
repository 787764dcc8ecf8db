import { describe, expect, test } from "vitest";
import { CostModel, type Workload } from "../../../src/core/view/cost_model";
import { Random } from "../../support/random";

const guess: Workload = { waits: 3, samples: 1e-2, triangles: 2e-4 };
/** Of a renderer on two cores, about [ms each]. */
const real: Workload = { waits: 8, samples: 4e-3, triangles: 1e-4 };

function timeOf({ waits, samples, triangles }: Workload, costs = real): number {
  return waits * costs.waits + samples * costs.samples + triangles * costs.triangles;
}

/** Pictures of several sizes, with all triangles, with few and without any. */
const pictures: readonly Workload[] = [1000, 4000, 12_000].flatMap((samples) =>
  [0, 100_000, 500_000].map((triangles) => ({ waits: 1, samples, triangles })),
);

function learned(times: (picture: Workload) => number): CostModel {
  const model = new CostModel(guess);
  for (let turn = 0; turn < 10; ++turn) {
    for (const picture of pictures) {
      model.learn(picture, times(picture));
    }
  }
  return model;
}

test("what is not known yet is as it was guessed", () => {
  expect(new CostModel(guess).expected({ waits: 1, samples: 1000, triangles: 10_000 })).toBeCloseTo(3 + 10 + 2, 12);
});

describe("pictures of several sizes", () => {
  test("tell the three costs apart", () => {
    const model = learned(timeOf);
    for (const part of ["waits", "samples", "triangles"] as const) {
      expect(model.expected({ [part]: 1 }) / real[part]).toBeCloseTo(1, 1);
    }
  });

  test("do so where times scatter by a tenth", () => {
    const random = new Random(3);
    const model = learned((picture) => timeOf(picture) * (1 + random.between(-0.15, 0.15)));
    for (const picture of pictures) {
      // a wandering cost follows some of the scatter
      expect(model.expected(picture) / timeOf(picture)).toBeGreaterThan(0.75);
      expect(model.expected(picture) / timeOf(picture)).toBeLessThan(1.25);
    }
  });
});

test.each([0.2, 5])(
  "pictures of one size that take %d times as long as before are expected so after twenty",
  (factor) => {
    const model = learned(timeOf);
    const picture: Workload = { waits: 1, samples: 2000, triangles: 100_000 };
    for (let i = 0; i < 20; ++i) {
      model.learn(picture, factor * timeOf(picture));
    }
    expect(model.expected(picture) / (factor * timeOf(picture))).toBeCloseTo(1, 1);
  },
);

test("no cost falls below zero, and one that fell there comes back", () => {
  const model = learned(timeOf);
  for (let i = 0; i < 30; ++i) {
    // the larger ones are the quicker ones
    model.learn({ waits: 1, samples: 1000, triangles: 0 }, 30);
    model.learn({ waits: 1, samples: 9000, triangles: 0 }, 5);
    for (const part of ["waits", "samples", "triangles"] as const) {
      expect(model.expected({ [part]: 1 })).toBeGreaterThanOrEqual(0);
    }
  }
  for (let i = 0; i < 30; ++i) {
    model.learn({ waits: 1, samples: 1000, triangles: 0 }, 12);
    model.learn({ waits: 1, samples: 9000, triangles: 0 }, 44);
  }
  expect(model.expected({ samples: 1 }) / 4e-3).toBeCloseTo(1, 1);
});
