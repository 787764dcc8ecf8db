/**
 * What can be chosen of a deformation model, as the page offers it: what is usual, what
 * a slider stands for, and how it is written.
 */
import { oddEdge } from "./tissue";
import type { Calibration, DeformationModel, ModelOptions, Motion, Prony, Range } from "../protocol";

/** Nothing chosen. */
export const usualOptions: ModelOptions = {
  edge: null,
  binding: null,
  walls: false,
  prony: null,
  yield_strain: null,
  layers: null,
  calibration: null,
  motion: null,
  whole_segment: false,
};

/** What sliders offer of a force that fades: shares from 0, which is not at all; times [s]. */
export const offeredFading = { share: { max: 0.9, step: 0.05 }, time: { min: 0.1, max: 10, step: 0.1 } } as const;

/** What a slider offers of tissue that stays as it is pressed: strains from 0, where none does. */
export const offeredYielding = { max: 0.2, step: 0.01 } as const;

/** Of a force that begins to fade [s]. */
export const usualFadingTime = 1;

/** One of few, the usual one first. */
export interface Choice<Value> {
  readonly value: Value;
  readonly name: string;
  readonly title: string;
}
type Choices<Value> = readonly [Choice<Value>, ...Choice<Value>[]];

/** How the stiffness of particles follows from the material. */
export const calibrations: Choices<Calibration> = [
  { value: "young", name: "E", title: "Compressed along an axis, tissue is as stiff as its E; usual" },
  {
    value: "wave-speed",
    name: "Waves",
    title:
      "Longitudinal waves are as fast as in the material (thesis 5.14): soft tissue becomes stiffer than its E, up " +
      "to some five times",
  },
];

/** How particles come to rest. */
export const motions: Choices<Motion> = [
  {
    value: "scaled-time",
    name: "Friction",
    title: "Particles swing in scaled time until friction has stopped them (thesis 5.17); usual",
  },
  {
    value: "fire",
    name: "FIRE",
    title: "Particles go downhill and are stopped where they would climb: the fast inertial relaxation engine",
  },
];

/** What a choice comes to among the options: null for the usual one. */
export function unlessUsual<Value>(chosen: Value, [usual]: Choices<Value>): Value | null {
  return chosen === usual.value ? null : chosen;
}

/** Whether nothing is chosen. */
export function areUsual(options: ModelOptions): boolean {
  return (Object.keys(usualOptions) as (keyof ModelOptions)[]).every((name) => options[name] === usualOptions[name]);
}

/** What fades with this share of the force; null where none does. The time stays as it is. */
export function fadingBy(share: number, prony: Prony | null): Prony | null {
  return share > 0 ? { share, time: prony?.time ?? usualFadingTime } : null;
}

/** Reads options that were kept, for a model; what it does not offer is left out. */
export function recalledOptions(kept: unknown, model: DeformationModel): ModelOptions {
  const { edge, binding, walls, prony, yield_strain: strain, layers, calibration, motion, whole_segment: whole } =
    asMap(kept);
  const { boxes, binding: shares, fades, yields } = model;
  const { share, time } = asMap(prony);
  return {
    edge: typeof edge === "number" && boxes !== null && edge === oddEdge(edge, boxes) ? edge : null,
    binding: shares !== null && within(binding, shares) ? binding : null,
    walls: model.walls && walls === true,
    prony: fades !== null && within(share, fades.shares) && within(time, fades.times) ? { share, time } : null,
    yield_strain: yields !== null && within(strain, yields) ? strain : null,
    layers:
      model.layers !== null && within(layers, { least: 1, most: model.layers }) && Number.isInteger(layers)
        ? layers
        : null,
    calibration: model.calibration ? known(calibration, calibrations) : null,
    motion: model.motion ? known(motion, motions) : null,
    whole_segment: model.whole_segment && whole === true,
  };
}

function within(given: unknown, { least, most }: Range): given is number {
  return typeof given === "number" && given >= least && given <= most;
}

function known<Value>(given: unknown, choices: readonly Choice<Value>[]): Value | null {
  return choices.find(({ value }) => value === given)?.value ?? null;
}

function asMap(value: unknown): Readonly<Record<string, unknown>> {
  return typeof value === "object" && value !== null && !Array.isArray(value) ? { ...value } : {};
}
