import { expect, test } from "vitest";
import {
  areUsual,
  calibrations,
  fadingBy,
  motions,
  recalledOptions,
  unlessUsual,
  usualOptions,
} from "../../../src/core/tissue/model_options";
import type { DeformationModel } from "../../../src/core/protocol";

test("what is as usual is told from what is chosen", () => {
  expect(areUsual(usualOptions)).toBe(true);
  const chosen = [
    { edge: 11 },
    { binding: 0 },
    { walls: true },
    { prony: { share: 0.5, time: 1 } },
    { yield_strain: 0.1 },
    { layers: 3 },
    { calibration: "wave-speed" },
    { motion: "fire" },
    { whole_segment: true },
  ] as const;
  expect(chosen.map((change) => areUsual({ ...usualOptions, ...change }))).toEqual(chosen.map(() => false));
});

test("where no share fades nothing does", () => {
  expect(fadingBy(0, { share: 0.4, time: 3 })).toBeNull();
  expect(fadingBy(0.5, null)).toEqual({ share: 0.5, time: 1 });
});

test("the time of what fades stays where its share is moved", () => {
  expect(fadingBy(0.5, { share: 0.4, time: 3 })).toEqual({ share: 0.5, time: 3 });
});

test("the usual one of few is no choice", () => {
  expect([unlessUsual("young", calibrations), unlessUsual("wave-speed", calibrations)]).toEqual([null, "wave-speed"]);
  expect([unlessUsual("scaled-time", motions), unlessUsual("fire", motions)]).toEqual([null, "fire"]);
});

test("layers, calibration and motion come back where a model offers them", () => {
  const cuboid: DeformationModel = {
    name: "cuboid-lj",
    title: "Particles",
    bonded: false,
    boxes: null,
    binding: null,
    walls: false,
    fades: null,
    yields: null,
    layers: 8,
    calibration: true,
    motion: false,
    whole_segment: false,
  };
  const chosen = { layers: 3, calibration: "wave-speed", motion: "fire" } as const;
  expect(recalledOptions(chosen, { ...cuboid, motion: true })).toEqual({ ...usualOptions, ...chosen });
  expect(recalledOptions(chosen, cuboid)).toEqual({ ...usualOptions, ...chosen, motion: null });
  expect(recalledOptions(chosen, { ...cuboid, layers: null, calibration: false })).toEqual(usualOptions);
  const whole = { whole_segment: true };
  expect(recalledOptions(whole, { ...cuboid, ...whole })).toEqual({ ...usualOptions, ...whole });
  expect(recalledOptions(whole, cuboid)).toEqual(usualOptions);
  // kept by a version before, or by nobody that knows them
  expect(recalledOptions({}, cuboid)).toEqual(usualOptions);
  const damaged = [{ layers: 9 }, { layers: 2.5 }, { layers: "3" }, { calibration: "cheese" }, { motion: 1 }];
  expect(damaged.map((kept) => recalledOptions(kept, { ...cuboid, motion: true }))).toEqual(
    damaged.map(() => usualOptions),
  );
});
