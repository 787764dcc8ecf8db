/**
 * A planned way of a needle, how far the needle is off it, and what lies along a line. Frame: scene [mm]; angles [rad].
 */
import { addScaled, distance, dot, length, normalize, subtract, type Vec3 } from "../geometry/vector";

/** Target and entry. */
export type NeedlePlan = readonly [target: Vec3, entry: Vec3];

export interface Deviation {
  /** From the tip to the planned line. */
  readonly lateral: number;
  /** Between the needle and the planned line; null as long as the needle has no direction. */
  readonly angle: number | null;
  /** From the tip to the target along the planned line; negative beyond it. */
  readonly ahead: number;
}

/** How far a needle is off its plan. @param direction of the needle, inward; null where none is known. */
export function deviationFrom([target, entry]: NeedlePlan, tip: Vec3, direction: Vec3 | null): Deviation {
  const planned = normalize(subtract(target, entry));
  const toTarget = subtract(target, tip);
  const ahead = dot(toTarget, planned);
  // rounding can lead out of what has an arc cosine
  const angle = direction === null ? null : Math.acos(Math.min(1, Math.max(-1, dot(direction, planned))));
  return { lateral: length(addScaled(toTarget, planned, -ahead)), angle, ahead };
}

/** From the skin to the tip of a needle that is about to go in [mm]. */
const standoff = 5;
/** Farther outward than this from a planned entry nothing free is looked for [mm]. */
const farthest = 100;

/**
 * Where the tip stands before it goes in: on the planned line, in what is free, a little outside of the entry.
 *
 * @param isFree whether a place is none of what is touched.
 * @returns null where nothing near the entry is free.
 */
export function beforeEntry([target, entry]: NeedlePlan, isFree: (point: Vec3) => boolean): Vec3 | null {
  const outward = normalize(subtract(entry, target));
  for (let away = 0; away <= farthest; away += 1) {
    if (isFree(addScaled(entry, outward, away))) {
      const point = addScaled(entry, outward, away + standoff);
      return isFree(point) ? point : addScaled(entry, outward, away);
    }
  }
  return null;
}

/** What a line leads through, and for how long. */
export interface Passage {
  readonly name: string;
  readonly length: number;
}

/** What a place is: a segment, or by the scan's value alone. */
export interface PlaceName {
  readonly name: string;
  readonly isSegment: boolean;
}

/** Most places along a line that are looked at. */
const mostSteps = 1000;
/** At a border values are mixed: what they alone tell for so few steps is none of what lies there. */
const mixedSteps = 3;

/**
 * What lies along a line, in its order.
 *
 * @param step from place to place that is looked at, at least.
 * @param nameAt what a place is; null ends the line.
 */
export function passagesAlong(
  from: Vec3,
  to: Vec3,
  step: number,
  nameAt: (point: Vec3) => PlaceName | null,
): readonly Passage[] {
  const whole = distance(from, to);
  const steps = Math.min(mostSteps, Math.ceil(whole / step));
  const found: { name: string; isSegment: boolean; steps: number }[] = [];
  for (let i = 0; i < steps; ++i) {
    const place = nameAt(addScaled(from, subtract(to, from), (i + 0.5) / steps));
    if (place === null) {
      break;
    }
    const last = found.at(-1);
    if (last?.name === place.name) {
      last.steps += 1;
    } else {
      found.push({ ...place, steps: 1 });
    }
  }
  return withoutMixed(found).map(({ name, steps: count }) => ({ name, length: (count * whole) / steps }));
}

/** Borders of mixed values count to what lies before them, the first one to what lies behind it. */
function withoutMixed<Run extends PlaceName & { readonly steps: number }>(runs: readonly Run[]): readonly Run[] {
  const isMixed = ({ isSegment, steps }: Run): boolean => !isSegment && steps <= mixedSteps;
  const kept: Run[] = [];
  let waiting = 0;
  for (const run of runs) {
    const last = kept.at(-1);
    if (last !== undefined && (isMixed(run) || run.name === last.name)) {
      kept[kept.length - 1] = { ...last, steps: last.steps + run.steps };
    } else if (isMixed(run)) {
      waiting += run.steps;
    } else {
      kept.push({ ...run, steps: run.steps + waiting });
      waiting = 0;
    }
  }
  // a way of nothing else is told as it is
  return kept.length === 0 ? runs : kept;
}
