/**
 * Registration of the second scan: what can be chosen, pairs of points, and what is said of it.
 * Points of the first scan are scene [mm], those of the second its own patient [mm].
 */
import { invertAffine, transformPoint, type Affine } from "../geometry/affine";
import { capitalised, formatFixed, formatPercent, formatValue } from "../base/format";
import type { Mark } from "../marks/measure";
import type {
  FoundRegistration,
  PointPair,
  RegistrationKind,
  RegistrationLevel,
  RegistrationMetric,
  RegistrationStart,
} from "../protocol";
import { distance, isPoint, type Vec3 } from "../geometry/vector";

interface Choice<T> {
  readonly name: T;
  readonly label: string;
  readonly says: string;
}

export const kinds: readonly Choice<RegistrationKind>[] = [
  { name: "rigid", label: "rigid: turn and shift", says: "The same bones at another time, or by another scanner" },
  { name: "affine", label: "affine: scale and shear too", says: "Starts rigid; for scans whose sizes differ" },
  {
    name: "bspline",
    label: "B-spline: bent as well",
    says: "Starts affine; for what breathes or gives way. The scan is then laid on the first one's grid",
  },
];

export const metrics: readonly Choice<RegistrationMetric>[] = [
  {
    name: "automatic",
    label: "automatic, by modality",
    says: "Correlation of two scans by CT, else mutual information",
  },
  { name: "mutual-information", label: "mutual information", says: "Any two kinds of scan, such as CT and MR" },
  { name: "correlation", label: "correlation", says: "Values of one follow those of the other" },
  { name: "mean-squares", label: "mean squares", says: "Values are the same" },
];

export const starts: readonly Choice<RegistrationStart>[] = [
  { name: "as-it-stands", label: "current position", says: "Where the second scan is seen now" },
  { name: "centre", label: "centres of both grids", says: "Centre on centre, not turned" },
  {
    name: "moments",
    label: "centres of mass",
    says: "Where scans show different parts around the same body",
  },
  { name: "landmarks", label: "pairs of points", says: "Three or more places that are seen in both" },
];

/** Fewer pairs tell no turn. */
export const leastPairs = 3;
export const mostPairs = 100;

/** How far the second scan's point of a pair stands from the first's, as it lies now [mm]. */
export function apart([first, second]: PointPair, secondFromFirst: Affine): number {
  return distance(transformPoint(secondFromFirst, first), second);
}

/** Where a point of the second scan is seen [scene mm]. */
export function seenAt(second: Vec3, secondFromFirst: Affine): Vec3 {
  return transformPoint(invertAffine(secondFromFirst), second);
}

/** Pairs of measured distances: each from a place in the first scan to where it is seen in the second. */
export function pairsOfDistances(marks: readonly Mark[], secondFromFirst: Affine): readonly PointPair[] {
  return marks.flatMap(({ kind, points: [first, second] }) =>
    kind === "distance" && first !== undefined && second !== undefined
      ? [[first, transformPoint(secondFromFirst, second)] as const]
      : [],
  );
}

/** What was remembered, as far as it is pairs. */
export function sanePairs(given: unknown): readonly PointPair[] {
  const list: readonly unknown[] = Array.isArray(given) ? given : [];
  return list.flatMap((pair) => {
    const [first, second]: readonly unknown[] = Array.isArray(pair) ? pair : [];
    return isPoint(first) && isPoint(second) ? [[first, second] as const] : [];
  }).slice(0, mostPairs);
}

/**
 * The curve as columns for a chart: steps from 1 on, and a line of its own for every other level, so that they part.
 */
export function curveColumns(
  curve: readonly RegistrationLevel[],
): readonly [number[], (number | null)[], (number | null)[]] {
  const steps: number[] = [];
  const lines: [(number | null)[], (number | null)[]] = [[], []];
  curve.forEach(({ values }, level) => {
    for (const value of values) {
      steps.push(steps.length + 1);
      lines[level % 2 === 0 ? 0 : 1].push(value);
      lines[level % 2 === 0 ? 1 : 0].push(null);
    }
  });
  return [steps, ...lines];
}

/** What was found, in two sentences. */
export function saidOf({
  metric,
  before,
  after,
  overlap_before,
  overlap,
  start_kept,
  moved_mean,
  moved_most,
}: FoundRegistration): readonly [string, string] {
  const name = metrics.find((choice) => choice.name === metric)?.label ?? metric;
  const change = `${capitalised(name)} ${number(before)} → ${number(after)}, less is better`;
  const kept = start_kept ? " It lay right already and is kept." : "";
  const covered = `${formatPercent(overlap)} of the first scan covered, ${formatPercent(overlap_before)} at the start`;
  const alike = `${change}; ${covered}.${kept}`;
  return [alike, `Points moved by ${formatFixed(moved_mean, 1, "mm")}, at most ${formatFixed(moved_most, 1, "mm")}.`];
}

function number(value: number): string {
  return formatValue(Number(value.toPrecision(3)));
}
