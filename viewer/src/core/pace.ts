/**
 * How much of the picture to draw at once, so that the page stays smooth on any renderer.
 *
 * What a piece costs is learned from what was drawn: a fixed part, which every piece waits
 * for, and a part per pixel. While the view moves, the picture is drawn as fine as the budget
 * of one frame allows; at rest it is refined level by level, in strips of rows that each fit
 * into a slice of time.
 */

/** Divisors of the resolution, coarse to fine. */
export const divisors = [8, 6, 4, 3, 2, 1] as const;

export interface PaceOptions {
  /** Time for a picture while the view moves [ms]. */
  readonly frameBudget: number;
  /** Time for a strip while it is refined [ms]. */
  readonly stripBudget: number;
  /** First guess of the cost of a pixel [ms]. */
  readonly pixelCost: number;
}

/** Share of what is known that each new measurement replaces. */
const learning = 0.15;
/** Least spread of the pieces' sizes that tells fixed from pixel cost, as a share of their mean. */
const leastSpread = 0.15;
/** No renderer is believed to be quicker [ms per pixel]. */
const leastCost = 1e-9;

/** Most strips that a level is cut into. */
const mostStrips = 32;

export class Pace {
  private pixelCost: number;
  private fixedCost = 0;
  /** Averages of pixels, time, pixels², pixels·time over the last pieces. */
  private means: Means | null = null;

  constructor(private readonly options: PaceOptions) {
    this.pixelCost = options.pixelCost;
  }

  /** Learns from pixels that took `milliseconds`: a straight line through the last pieces. */
  learn(pixels: number, milliseconds: number): void {
    if (pixels <= 0 || milliseconds <= 0) {
      return;
    }
    const newest = [pixels, milliseconds, pixels * pixels, pixels * milliseconds] as const;
    const [x, y, xx, xy] = (this.means = mixed(this.means ?? newest, newest));
    const spread = xx - x * x;
    if (spread > (leastSpread * x) ** 2) {
      this.pixelCost = Math.max(leastCost, (xy - x * y) / spread);
      this.fixedCost = Math.max(0, y - x * this.pixelCost);
    } else {
      // pieces of one size tell only the sum
      this.pixelCost = Math.max(leastCost, (y - Math.min(this.fixedCost, 0.5 * y)) / x);
    }
  }

  /** Expected time for pixels, without the fixed part [ms]. */
  expected(pixels: number): number {
    return pixels * this.pixelCost;
  }

  /** Divisor for a picture of `pixels` that must be done within a frame. */
  movingDivisor(pixels: number): number {
    const fits = (divisor: number): boolean => this.expected(pixels / divisor ** 2) <= this.options.frameBudget;
    return [...divisors].reverse().find(fits) ?? divisors[0];
  }

  /** Rows of a level that fit into a slice of time. */
  stripRows(width: number, height: number): number {
    const fitting = Math.floor(this.options.stripBudget / Math.max(1e-12, width * this.pixelCost));
    return Math.min(height, Math.max(Math.ceil(height / mostStrips), fitting));
  }
}

type Means = readonly [number, number, number, number];

function mixed(old: Means, newest: Means): Means {
  const mix = (i: 0 | 1 | 2 | 3): number => old[i] + learning * (newest[i] - old[i]);
  return [mix(0), mix(1), mix(2), mix(3)];
}

/** The divisors still to draw after `done` when the view rests: halving down to 1. */
export function levelsAfter(done: number): number[] {
  return done > 2 ? [2, 1] : [1];
}
