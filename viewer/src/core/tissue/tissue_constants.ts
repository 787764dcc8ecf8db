/**
 * Constants of tissue as a person reads and types them: names, units, what is allowed, and why
 * something else is refused.
 */
import { afterNumber } from "../base/format";
import type { Constants } from "../protocol";

/** How one constant is written. */
export interface WrittenConstant {
  readonly key: keyof Constants;
  readonly label: string;
  /** What it stands for. */
  readonly title: string;
  /** "" for a number without one. */
  readonly unit: string;
  /** One of this unit in that of `Constants`. */
  readonly scale: number;
  /** What may be typed [unit]; the engine's own bounds are as wide or wider. */
  readonly min: number;
  readonly max: number;
  /** What a field without a number means; null where there must be one. */
  readonly none: string | null;
}

export const writtenConstants: readonly WrittenConstant[] = [
  {
    key: "young",
    label: "Modulus E",
    title: "Young's modulus: how stiff it is against pulling",
    unit: "kPa",
    scale: 1000,
    min: 0.001,
    max: 2e9,
    none: null,
  },
  {
    key: "poisson",
    label: "Poisson's ν",
    title:
      "Poisson's ratio: how much it goes aside where it is pressed: near 0.5 it keeps its volume. The lattice takes " +
      "0.25 to 0.49, and the nearest of these beyond; particles have that of their lattice",
    unit: "",
    scale: 1,
    min: -0.99,
    max: 0.499,
    none: null,
  },
  {
    key: "density",
    label: "Density ρ",
    title:
      "Mass by volume: kept with the material. No model reads it: tissue is brought to rest, where mass counts for " +
      "nothing",
    unit: "g/cm³",
    scale: 1000,
    min: 0.0001,
    max: 23,
    none: null,
  },
  {
    key: "fracture_energy",
    label: "Fracture energy",
    title: "The energy that a tear takes for its area; without a number the tissue never tears",
    unit: "J/m²",
    scale: 1,
    min: 0.01,
    max: 1e6,
    none: "never",
  },
  {
    key: "friction",
    label: "Friction",
    title:
      "How much of the pressing force holds a tool back sideways, four fifths of it where the tool slides; more " +
      "than 200\u202f% counts as that. A segment's own friction, under Segments, goes before it",
    unit: "%",
    scale: 0.01,
    min: 0,
    max: 1000,
    none: null,
  },
  {
    key: "stiffening",
    label: "Stiffening b",
    title:
      "How much stiffer it gets with strain: shear grows with exp(b (I₁ − 3)), which pressed by a fifth is about " +
      "exp(0.12 b), up to 20 times. 0 is none. Only the lattice stiffens",
    unit: "",
    scale: 1,
    min: 0,
    max: 100,
    none: null,
  },
];

/** What a segment begins with that was rigid and gets constants of a person's own: as soft as muscle. */
export const customTissue: Constants = {
  young: 12_000,
  poisson: 0.45,
  density: 1050,
  fracture_energy: null,
  friction: 0.2,
  stiffening: 0,
};

/** The number of a constant in its unit, as text; "" where it has none. */
export function written({ key, scale }: WrittenConstant, constants: Constants): string {
  const value = constants[key];
  return value === null ? "" : plain(value / scale);
}

/** What was typed for a constant: the constants with it, or why it is refused. */
export function typed(
  constant: WrittenConstant,
  text: string,
  constants: Constants,
): { readonly constants: Constants } | { readonly refused: string } {
  const { key, label, unit, scale, min, max, none } = constant;
  const value = Number(text.trim() === "" ? NaN : text);
  if (text.trim() === "" && none !== null) {
    return { constants: { ...constants, [key]: null } };
  }
  if (value >= min && value <= max) {
    // 34 % is 0.34 and not 0.34 and a little
    return { constants: { ...constants, [key]: Number((value * scale).toPrecision(12)) } };
  }
  const entered = text.trim() === "" ? "no number was entered" : `it cannot be ${text.trim()}`;
  const range = `${grouped(min)} to ${grouped(max)}${afterNumber(unit)}`;
  return { refused: `${label}: ${entered}. Enter ${range}${none === null ? "" : `, or nothing for ${none}`}.` };
}

/** "1.06 g/cm³", "0.45", "never" */
export function described(constant: WrittenConstant, constants: Constants): string {
  const text = written(constant, constants);
  return text === ""
    ? (constant.none ?? "")
    : `${grouped(Number(text))}${afterNumber(constant.unit)}`;
}

/** With six digits at most, and no exponent. */
function plain(value: number): string {
  const rounded = Number(value.toPrecision(6));
  return Math.abs(rounded) < 1e-6 ? rounded.toFixed(9).replace(/\.?0+$/, "") : rounded.toString();
}

/** Thin spaces between groups of three digits before the point. */
function grouped(value: number): string {
  const [whole = "", rest] = plain(value).split(".");
  const shown = whole.replace("-", "\u2212").replace(/\B(?=(\d{3})+$)/g, "\u2009");
  return [shown, ...(rest === undefined ? [] : [rest])].join(".");
}
