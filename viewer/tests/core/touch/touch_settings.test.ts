import { expect, test } from "vitest";
import {
  frictionOf,
  frictionWithoutOwn,
  heldRadiusNote,
  larger,
  memoryVersion,
  modelChoices,
  offered,
  offeredBy,
  recalled,
  remembered,
  sameSettings,
  stiffer,
  withFriction,
  withStiffness,
} from "../../../src/core/touch/touch_settings";
import { Random } from "../../support/random";
import { segment, settings } from "../../support/volumes";

test("one friction slider sets both coefficients, the kinetic one at four fifths", () => {
  expect(frictionOf(0.5)).toEqual({ friction_static: 0.5, friction_kinetic: 0.4 });
  expect(frictionOf(0)).toEqual({ friction_static: 0, friction_kinetic: 0 });
});

test("only what a person has changed is kept, and comes back", () => {
  const changed = { ...settings, stiffness: 2.5, smoothing: "bits" as const, model: "thesis-improved" as const };
  const memory = remembered(changed, settings);
  expect(Object.keys(memory.settings).sort()).toEqual(["model", "smoothing", "stiffness"]);
  expect(recalled(JSON.parse(JSON.stringify(memory)), settings)).toEqual(changed);
  // a default that a later build changes is followed where nobody has touched it
  expect(recalled(memory, { ...settings, damping: 0.003 }).damping).toBe(0.003);
});

test("settings kept in another form are not read", () => {
  const memory = { version: memoryVersion + 1, settings: { stiffness: 3 } };
  expect(recalled(memory, settings)).toEqual(settings);
});

test("whatever stands in the browser's memory, settings come out that the engine takes", () => {
  const random = new Random(61);
  const junk: unknown[] = [null, undefined, "", "NaN", [], {}, -1, 0, 1e9, NaN, Infinity, true, "exact", { min: 1 }];
  const names = [...Object.keys(settings), "__proto__", "toString"];
  for (let i = 0; i < 500; ++i) {
    const kept = Object.fromEntries(names.map((name) => [name, junk[Math.floor(random.between(0, junk.length))]]));
    const read = recalled({ version: memoryVersion, settings: kept }, settings);
    expect(Object.keys(read).sort()).toEqual(Object.keys(settings).sort());
    expect(modelChoices.map(({ model }) => model)).toContain(read.model);
    expect(["intensities", "bits", "off"]).toContain(read.smoothing);
    expect(read.stiffness).toBeGreaterThan(0);
    expect(read.stiffness).toBeLessThanOrEqual(10);
    expect(read.friction_kinetic).toBeLessThanOrEqual(read.friction_static);
    expect(read.probe_radius).toBeGreaterThanOrEqual(0);
    expect(read.probe_radius).toBeLessThanOrEqual(20);
    expect(read.force_limit).toBeGreaterThan(0);
    expect(read.force_limit).toBeLessThanOrEqual(40);
  }
  for (const memory of junk) {
    expect(recalled(memory, settings)).toEqual(settings);
  }
});

test("kept sliding friction never exceeds kept or default resting friction", () => {
  const memory = { version: memoryVersion, settings: { friction_kinetic: 1.5 } };
  expect(recalled(memory, { ...settings, friction_static: 0.2 }).friction_kinetic).toBe(0.2);
});

test("settings are compared by all their values", () => {
  expect(sameSettings(settings, { ...settings })).toBe(true);
  expect(sameSettings(settings, { ...settings, smoothing: "off" })).toBe(false);
});

test("keys step through stiffness and radius and stop at their ends", () => {
  const weak = { stiffness: 2, force: 3.3, reach: 80 };
  expect(stiffer(1, 1, weak)).toBe(1.25);
  expect(stiffer(1.25, -1, weak)).toBe(1);
  expect(stiffer(1.9, 1, weak)).toBe(2);
  expect(stiffer(4.9, 3, null)).toBe(offered.stiffness.max);
  expect(stiffer(0.05, -1, weak)).toBe(offered.stiffness.min);
  expect(larger(0, 1)).toBe(0.5);
  expect(larger(0.3, 1)).toBe(1);
  expect(larger(0, -1)).toBe(0);
  expect(larger(10, 4)).toBe(offered.probe_radius.max);
});

test("controls end where the device does, and never offer more than makes sense", () => {
  expect(offeredBy({ stiffness: 2, force: 3.3, reach: 80 })).toEqual({
    stiffness: { min: 0.05, max: 2 },
    force_limit: { min: 0.5, max: 3.3 },
  });
  expect(offeredBy({ stiffness: 10, force: 40, reach: 80 }).stiffness.max).toBe(offered.stiffness.max);
  expect(offeredBy(null).force_limit.max).toBe(offered.force_limit.max);
});

test("a radius that has no room is said to be held, in the millimetres that it has", () => {
  expect(heldRadiusNote(5, 2, false)).toBe("held at 2.0\u202fmm: no room here");
  expect(heldRadiusNote(5, 5, false)).toBeNull();
  expect(heldRadiusNote(0, 0, false)).toBeNull();
  // what a step of rounding leaves is no difference
  expect(heldRadiusNote(0.3, 0.1 + 0.2 - 1e-9, false)).toBeNull();
  expect(heldRadiusNote(0, 3, true)).toBe("3.0\u202fmm, to press soft tissue");
  // a ball that is not smaller yet is no ball without room
  expect(heldRadiusNote(1, 3, false)).toBeNull();
});

test("every thesis model warns and exact does not", () => {
  for (const { model, warning } of modelChoices) {
    expect(warning === null).toBe(model === "exact");
  }
});

test("without friction of its own a segment has that of its material, and without one that of touch", () => {
  const constants = { young: 5500, poisson: 0.45, density: 1060, fracture_energy: null, friction: 0.2, stiffening: 0 };
  const material = { preset: null, low: constants, high: { ...constants, friction: 0.4 } };
  const rough = { ...settings, friction_static: 0.7 };
  expect(frictionWithoutOwn({ material: null }, rough)).toBe(0.7);
  expect(frictionWithoutOwn({ material }, rough)).toBeCloseTo(0.3, 12);
  const glue = { ...constants, friction: 9 };
  expect(frictionWithoutOwn({ material: { preset: null, low: glue, high: glue } }, rough)).toBe(2);
});

test("a segment's own feel is set and given back without touching the rest", () => {
  const own = withFriction(withStiffness(segment.feel, 2), 0.5);
  expect(own).toEqual({ stiffness: 2, friction_static: 0.5, friction_kinetic: 0.4 });
  expect(withFriction(own, null)).toEqual({ stiffness: 2, friction_static: null, friction_kinetic: null });
  expect(withStiffness(own, null).friction_static).toBe(0.5);
});
