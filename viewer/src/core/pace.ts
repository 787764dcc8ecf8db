/**
 * How much of the picture to draw at once, so that the page stays smooth on any renderer.
 *
 * What a piece costs is learned from what was drawn: a fixed part, which every piece waits
 * for, and a part per sample, where samples are pixels times steps per voxel edge. While the view
 * moves, the picture is drawn as fine as the budget of one frame allows, by resolution and step; at
 * rest it is refined level by level, in strips of rows that each fit into that budget too.
 */

/** A picture while the view moves. */
export interface MovingPicture {
  /** Of the resolution. */
  readonly divisor: number;
  /** Share of the steps that a ray takes at the finest. */
  readonly step: number;
}

/**
 * From fine to coarse. A half of all steps still leads a ray through each second voxel, so that is given up
 * before the last of the resolution is. The last one is the limit, however slow it is: below it nobody sees any
 * more what is turned.
 */
export const movingPictures: readonly [MovingPicture, ...MovingPicture[]] = [
  { divisor: 1, step: 1 },
  { divisor: 2, step: 1 },
  { divisor: 3, step: 1 },
  { divisor: 4, step: 1 },
  { divisor: 4, step: 0.5 },
  { divisor: 6, step: 0.5 },
  { divisor: 8, step: 0.5 },
];

/** Share of what is known that each new measurement replaces. */
const learning = 0.15;
/** Least spread of the pieces' sizes that tells fixed cost from that of samples, as a share of their mean. */
const leastSpread = 0.15;
/** No renderer is believed to be quicker [ms per sample]. */
const leastCost = 1e-9;
/** Share of a frame that samples have at least: fewer of them would not make the fixed part less. */
const leastShare = 0.5;

/** Most strips that a level is cut into, for each step per voxel edge. */
const mostStrips = 32;

export class Pace {
  private fixedCost = 0;
  /** Averages of samples, time, samples², samples·time over the last pieces. */
  private means: Means | null = null;

  /**
   * @param frameBudget time for a picture while the view moves, and for a strip at rest [ms].
   * @param sampleCost first guess of the cost of a sample [ms].
   */
  constructor(
    public frameBudget: number,
    private sampleCost: number,
  ) {}

  /** Learns from samples that took `milliseconds`: a straight line through the last pieces. */
  learn(samples: number, milliseconds: number): void {
    if (samples <= 0 || milliseconds <= 0) {
      return;
    }
    const newest = [samples, milliseconds, samples * samples, samples * milliseconds] as const;
    const [x, y, xx, xy] = (this.means = mixed(this.means ?? newest, newest));
    const spread = xx - x * x;
    if (spread > (leastSpread * x) ** 2) {
      this.sampleCost = Math.max(leastCost, (xy - x * y) / spread);
      this.fixedCost = Math.max(0, y - x * this.sampleCost);
    } else {
      // pieces of one size tell only the sum
      this.sampleCost = Math.max(leastCost, (y - Math.min(this.fixedCost, 0.5 * y)) / x);
    }
  }

  /** Expected time for samples, without the fixed part [ms]. */
  expected(samples: number): number {
    return samples * this.sampleCost;
  }

  /** The finest picture that is done within a frame, else the coarsest; of `samples` at its finest. */
  moving(samples: number): MovingPicture {
    const time = Math.max(leastShare * this.frameBudget, this.frameBudget - this.fixedCost);
    const fits = ({ divisor, step }: MovingPicture): boolean => this.expected((samples * step) / divisor ** 2) <= time;
    return movingPictures.find(fits) ?? movingPictures.at(-1) ?? movingPictures[0];
  }

  /** Rows of a level that are drawn within a frame. */
  stripRows(width: number, height: number, stepsPerVoxel: number): number {
    const fitting = Math.floor(this.frameBudget / Math.max(1e-12, this.expected(width * stepsPerVoxel)));
    return Math.min(height, Math.max(Math.ceil(height / (mostStrips * stepsPerVoxel)), fitting));
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
