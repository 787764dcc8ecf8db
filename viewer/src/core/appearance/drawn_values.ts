/**
 * Which values of the scan are drawn at all, for skipping empty space.
 *
 * A table of running sums over equal bins of the biased value answers for any range of
 * values whether something in it is drawn.
 */
import type { Appearance } from "./appearance";
import { drawsSolids, seenInGrey, usesTransferFunction } from "./optics";
import { sample, type TransferFunction } from "./transfer_function";
import { biasedOf, largest, physical, type Rescale } from "../scan/stored_values";

/** Tells of ranges of biased values, both ends included, whether any of them is drawn. */
export interface Drawn {
  readonly any: (low: number, high: number) => boolean;
}

/**
 * What an appearance draws; with the bodies that can stand for surfaces, so that these may come and go with each
 * picture.
 */
export function drawnBy(appearance: Appearance, rescale: Rescale): Drawn {
  const { optics, ranges, transferFunction } = appearance;
  const solids = drawsSolids(optics.blend)
    ? ranges.filter(({ body = 0, tinted, visible }) => body > 0 || (visible && tinted !== true))
    : [];
  if (usesTransferFunction(optics.blend)) {
    return new DrawnValues(transferFunction, rescale, solids.map(({ low, high }) => [low, high]));
  }
  return {
    any: (low, high) =>
      seenInGrey(optics, physical(low, rescale), physical(high, rescale)) ||
      solids.some((range) => range.low <= high && low <= range.high),
  };
}

const binShift = 4;
const bins = (largest + 1) >> binShift;

/** Extinction below which nothing can be seen, even through a metre of it [1/mm]. */
const clear = 1e-6;

export class DrawnValues implements Drawn {
  /** Number of drawn bins before each bin. */
  private readonly before = new Uint32Array(bins + 1);

  /** @param shown ranges of biased values that are drawn whatever the function says. */
  constructor(
    transferFunction: TransferFunction,
    rescale: Rescale,
    shown: readonly (readonly [number, number])[] = [],
  ) {
    const points = transferFunction.points.map((point) => ({
      biased: biasedOf(point.value, rescale),
      opaque: point.extinction > clear,
    }));
    const opaque = (biased: number): boolean =>
      sample(transferFunction.points, physical(biased, rescale)).extinction > clear;
    for (let bin = 0; bin < bins; ++bin) {
      const low = bin << binShift;
      const high = low + (1 << binShift);
      // the function is straight between its points: its ends and the points inside tell all
      const drawn =
        opaque(low) ||
        opaque(high) ||
        points.some((point) => point.opaque && low <= point.biased && point.biased <= high) ||
        shown.some(([from, to]) => from <= high && low <= to);
      this.before[bin + 1] = (this.before[bin] ?? 0) + (drawn ? 1 : 0);
    }
  }

  /** Whether any value from `low` to `high` (biased, both included) is drawn. */
  any(low: number, high: number): boolean {
    const first = this.before[low >> binShift] ?? 0;
    const last = this.before[(high >> binShift) + 1] ?? 0;
    return last > first;
  }
}
