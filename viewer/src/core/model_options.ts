/**
 * What can be chosen of a model by which matter gives way, as the page offers it: what is usual, what
 * a slider stands for, and how it is written.
 */
import { oddEdge } from "./matter";
import type { DeformationModel, ModelOptions, Prony, Range } from "./protocol";

/** Nothing chosen. */
export const usualOptions: ModelOptions = { edge: null, binding: null, walls: false, prony: null, yield_strain: null };

/** What sliders offer of a force that fades: shares from 0, which is not at all; times [s]. */
export const offeredFading = { share: { max: 0.9, step: 0.05 }, time: { min: 0.1, max: 10, step: 0.1 } } as const;

/** What a slider offers of matter that stays as it is pressed: strains from 0, where none does. */
export const offeredYielding = { max: 0.2, step: 0.01 } as const;

/** Of a force that begins to fade [s]. */
export const usualFadingTime = 1;

/** Whether nothing is chosen. */
export function areUsual(options: ModelOptions): boolean {
  const { edge, binding, walls, prony, yield_strain } = options;
  return edge === null && binding === null && !walls && prony === null && yield_strain === null;
}

/** What fades with this share of the force; null where none does. The time stays as it is. */
export function fadingBy(share: number, prony: Prony | null): Prony | null {
  return share > 0 ? { share, time: prony?.time ?? usualFadingTime } : null;
}

/** "30 %" */
export function formatShare(share: number): string {
  return `${(100 * share).toFixed(0)} %`;
}

/** Reads options that were kept, for a model; what it does not offer is left out. */
export function recalledOptions(kept: unknown, model: DeformationModel): ModelOptions {
  const { edge, binding, walls, prony, yield_strain: strain } = asMap(kept);
  const { boxes, binding: shares, fades, yields } = model;
  const { share, time } = asMap(prony);
  return {
    edge: typeof edge === "number" && boxes !== null && edge === oddEdge(edge, boxes) ? edge : null,
    binding: shares !== null && within(binding, shares) ? binding : null,
    walls: model.walls && walls === true,
    prony: fades !== null && within(share, fades.shares) && within(time, fades.times) ? { share, time } : null,
    yield_strain: yields !== null && within(strain, yields) ? strain : null,
  };
}

function within(given: unknown, { least, most }: Range): given is number {
  return typeof given === "number" && given >= least && given <= most;
}

function asMap(value: unknown): Readonly<Record<string, unknown>> {
  return typeof value === "object" && value !== null && !Array.isArray(value) ? { ...value } : {};
}
