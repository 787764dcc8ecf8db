/**
 * Ways to change the shape of a segment, as the page offers them. Lengths [mm], volumes [ml].
 */
import type { ShapeKind } from "../protocol";

/** A number that goes with a change. */
export interface Amount {
  readonly label: string;
  readonly unit: string;
  readonly usual: number;
  readonly min: number;
  readonly max: number;
  readonly step: number;
}

export interface ShapeChoice {
  readonly kind: ShapeKind;
  readonly name: string;
  /** What it does, in a sentence. */
  readonly does: string;
  readonly amount: Amount | null;
  /** It takes another segment. */
  readonly withOther: boolean;
}

const lengthOf = (label: string, usual: number): Amount => ({
  label,
  unit: "mm",
  usual,
  min: 0.1,
  max: 100,
  step: 0.5,
});
const alone = { amount: null, withOther: false } as const;
const withOther = { amount: null, withOther: true } as const;

export const shapeChoices: readonly ShapeChoice[] = [
  {
    kind: "keep-largest",
    name: "Keep largest islands",
    does: "Removes all parts but the largest ones",
    amount: { label: "Islands", unit: "", usual: 1, min: 1, max: 1000, step: 1 },
    withOther: false,
  },
  {
    kind: "drop-small",
    name: "Remove small islands",
    does: "Removes parts that are smaller",
    amount: { label: "Smaller than", unit: "ml", usual: 1, min: 0, max: 100_000, step: 0.1 },
    withOther: false,
  },
  { kind: "fill-holes", name: "Fill holes", does: "Fills what it encloses", ...alone },
  {
    kind: "between-slices",
    name: "Fill between painted slices",
    does: "Fills empty slices between painted ones by their shapes",
    ...alone,
  },
  { kind: "grow", name: "Grow", does: "Moves its border outward", amount: lengthOf("By", 2), withOther: false },
  { kind: "shrink", name: "Shrink", does: "Moves its border inward", amount: lengthOf("By", 2), withOther: false },
  {
    kind: "smooth",
    name: "Smooth",
    does: "Rounds its border by a Gaussian",
    amount: lengthOf("Deviation", 2),
    withOther: false,
  },
  {
    kind: "median",
    name: "Smooth by median",
    does: "Takes small steps away and keeps large ones",
    amount: lengthOf("Reach", 3),
    withOther: false,
  },
  {
    kind: "joint",
    name: "Smooth with all shown",
    does: "Rounds the borders of all shown segments together: neighbours still meet",
    amount: lengthOf("Deviation", 2),
    withOther: false,
  },
  {
    kind: "open",
    name: "Remove bridges",
    does: "Takes away what a ball does not fit into (opening)",
    amount: lengthOf("Ball's radius", 3),
    withOther: false,
  },
  {
    kind: "close",
    name: "Close gaps",
    does: "Fills gaps that a ball does not fit into (closing)",
    amount: lengthOf("Ball's radius", 3),
    withOther: false,
  },
  {
    kind: "hollow-inside",
    name: "Hollow, wall inside",
    does: "Keeps a wall within its border",
    amount: lengthOf("Wall", 3),
    withOther: false,
  },
  {
    kind: "hollow-outside",
    name: "Hollow, wall outside",
    does: "Becomes a wall around its border",
    amount: lengthOf("Wall", 3),
    withOther: false,
  },
  { kind: "unite", name: "Unite with", does: "Adds the voxels of another segment", ...withOther },
  { kind: "subtract", name: "Subtract", does: "Takes the voxels of another segment away", ...withOther },
  { kind: "intersect", name: "Intersect with", does: "Keeps what another segment has too", ...withOther },
];

/** The choice of a kind; the first one where a kind is not known. */
export function choiceOf(kind: string): ShapeChoice {
  const found = shapeChoices.find((choice) => choice.kind === kind) ?? shapeChoices[0];
  if (found === undefined) throw new Error("no way to change a shape");
  return found;
}

/** A number as far as its change takes it; the usual one where it is none. */
export function allowedAmount(amount: Amount | null, given: number | undefined): number {
  if (amount === null) return 0;
  const number = given === undefined || !Number.isFinite(given) ? amount.usual : given;
  const held = Math.min(amount.max, Math.max(amount.min, number));
  return amount.unit === "" ? Math.round(held) : held;
}
