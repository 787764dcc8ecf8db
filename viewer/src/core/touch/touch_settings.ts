/**
 * What a person can set about touch: the ranges of the controls, what the choices mean, and
 * what of it outlives a visit. Stiffness [N/mm], damping [N·s/mm], radius [mm], force [N].
 */
import { formatFixed } from "../base/format";
import type { DeviceLimits, Feel, Segment, Settings } from "../protocol";

type NumberSetting =
  "stiffness" | "damping" | "friction_static" | "friction_kinetic" | "probe_radius" | "force_limit" | "gain";

interface Range {
  readonly min: number;
  readonly max: number;
}

/** What the engine takes at most. */
const taken: Readonly<Record<NumberSetting, Range>> = {
  stiffness: { min: 1e-6, max: 10 },
  damping: { min: 0, max: 0.1 },
  friction_static: { min: 0, max: 2 },
  friction_kinetic: { min: 0, max: 2 },
  probe_radius: { min: 0, max: 20 },
  force_limit: { min: 1e-6, max: 40 },
  gain: { min: 0.1, max: 10 },
};

/** What the controls offer, where the device bears it. */
export const offered = {
  stiffness: { min: 0.05, max: 5 },
  damping: { min: 0, max: 0.02 },
  friction: { min: 0, max: 1 },
  probe_radius: { min: 0, max: 10 },
  force_limit: { min: 0.5, max: 20 },
  gain: { min: 0.1, max: 10 },
} as const satisfies Readonly<Record<string, Range>>;

/** A sliding probe is held back by this share of what holds a resting one. */
const slidingShare = 0.8;

/** Both coefficients from one: the kinetic one follows the static one. */
export function frictionOf(coefficient: number): { friction_static: number; friction_kinetic: number } {
  return { friction_static: coefficient, friction_kinetic: Number((slidingShare * coefficient).toPrecision(6)) };
}

/** Ends of the controls of stiffness and force: those of the device, where it bears less. */
export function offeredBy(limits: DeviceLimits | null): { readonly stiffness: Range; readonly force_limit: Range } {
  const { stiffness, force_limit } = offered;
  return {
    stiffness: { min: stiffness.min, max: Math.min(stiffness.max, limits?.stiffness ?? Infinity) },
    force_limit: { min: force_limit.min, max: Math.min(force_limit.max, limits?.force ?? Infinity) },
  };
}

/** A stiffness `steps` steps stiffer (or softer, < 0), within what is offered. */
export function stiffer(stiffness: number, steps: number, limits: DeviceLimits | null): number {
  const { min, max } = offeredBy(limits).stiffness;
  return Number(Math.min(max, Math.max(min, stiffness * 1.25 ** steps)).toPrecision(3));
}

/** A radius `steps` half millimetres larger (or smaller, < 0), within what is offered. */
export function larger(radius: number, steps: number): number {
  const { min, max } = offered.probe_radius;
  return Math.min(max, Math.max(min, Math.round(2 * radius + steps) / 2));
}

/** Shorter than what the controls show [mm]. */
const noDifference = 0.05;

/**
 * What to say of a radius that is not the one asked for; none where it is.
 * @param soft whether soft tissue is pressed, which needs a ball at least as large as a small fingertip.
 */
export function heldRadiusNote(asked: number, admitted: number, soft: boolean): string | null {
  const size = formatFixed(admitted, 1, "mm");
  if (asked - admitted >= noDifference) {
    return `held at ${size}: no room here`;
  }
  return soft && admitted - asked >= noDifference ? `${size}, to press soft tissue` : null;
}

export interface ModelChoice {
  readonly model: Settings["model"];
  readonly name: string;
  /** What a person must know who chooses it. */
  readonly warning: string | null;
}

const printed = "As printed in the thesis, to compare with: it promises nothing.";

export const modelChoices: readonly ModelChoice[] = [
  { model: "exact", name: /* @text */ "exact", warning: null },
  {
    model: "thesis-improved",
    name: "thesis, improved (4.8)",
    warning: `${printed} Thin walls can be crossed, and the force trembles at rest.`,
  },
  {
    model: "thesis-original",
    name: "thesis, original (4.3)",
    warning: `${printed} Thin walls can be crossed, the probe can stick, and the force trembles.`,
  },
];

/** Where the force comes from, as it is offered. */
export const smoothingChoices: readonly { readonly smoothing: Settings["smoothing"]; readonly name: string }[] = [
  { smoothing: "intensities", name: "Smooth (image)" },
  { smoothing: "bits", name: "Smooth (mask)" },
  { smoothing: "off", name: "Voxel steps" },
];

// --- what outlives a visit --------------------------------------------------------------

/** Form of what is kept; another number means that nothing kept before is read. */
export const memoryVersion = 1;

/** What is kept: only what a person has set differently from the defaults. */
export interface Memory {
  readonly version: number;
  readonly settings: Partial<Settings>;
}

/** What to keep of settings. */
export function remembered(settings: Settings, defaults: Settings): Memory {
  const changed = Object.entries(settings).filter(([name, value]) => value !== defaults[name as keyof Settings]);
  return { version: memoryVersion, settings: Object.fromEntries(changed) };
}

/**
 * The settings that something kept stands for, over the defaults. Anything may have been
 * written there: what is not a setting within its range is left out.
 */
export function recalled(memory: unknown, defaults: Settings): Settings {
  const { version, settings } = asMap(memory);
  const kept = version === memoryVersion ? asMap(settings) : {};
  const numbers = (Object.keys(taken) as NumberSetting[]).flatMap((name) => {
    const value = kept[name];
    const { min, max } = taken[name];
    return typeof value === "number" && value >= min && value <= max ? [[name, value] as const] : [];
  });
  const model = modelChoices.find((choice) => choice.model === kept["model"])?.model ?? defaults.model;
  const chosen = smoothingChoices.find((choice) => choice.smoothing === kept["smoothing"]);
  const smoothing = chosen?.smoothing ?? defaults.smoothing;
  const settled = { ...defaults, ...Object.fromEntries(numbers), model, smoothing };
  // sliding never takes more than resting
  return { ...settled, friction_kinetic: Math.min(settled.friction_kinetic, settled.friction_static) };
}

function asMap(value: unknown): Readonly<Record<string, unknown>> {
  return typeof value === "object" && value !== null && !Array.isArray(value) ? { ...value } : {};
}

export function sameSettings(a: Settings, b: Settings): boolean {
  return (Object.keys(a) as (keyof Settings)[]).every((name) => a[name] === b[name]);
}

// --- segments ---------------------------------------------------------------------------

/** A feel with its own stiffness, or that of touch where null. */
export function withStiffness(feel: Feel, stiffness: number | null): Feel {
  return { ...feel, stiffness };
}

/** The coefficient of a segment without one of its own: of what it is made of, else of touch. */
export function frictionWithoutOwn({ material }: Pick<Segment, "material">, settings: Settings): number {
  if (material === null) {
    return settings.friction_static;
  }
  return Math.min(taken.friction_static.max, (material.low.friction + material.high.friction) / 2);
}

/** A feel with its own friction, or that of its material or of touch where null. */
export function withFriction(feel: Feel, coefficient: number | null): Feel {
  const none = { friction_static: null, friction_kinetic: null };
  return { ...feel, ...(coefficient === null ? none : frictionOf(coefficient)) };
}
