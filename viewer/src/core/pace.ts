/**
 * How much of the picture to draw at once, so that the page stays smooth on any renderer.
 *
 * What a picture costs is learned from what was drawn: a fixed part, which every picture waits
 * for, a part per sample, where samples are pixels times steps per voxel edge, and a part per triangle
 * of surfaces. Only whole pictures tell: of one strip there is air, of the next one a skull. While the view moves, the picture is drawn as fine as the budget of one frame allows, by resolution, step
 * and detail of surfaces; at rest it is refined level by level, in strips of rows that each fit into that budget too.
 */

/** Which triangles of surfaces are drawn. */
export type Detail = "all" | "few";

/** First guesses [ms]. */
export interface Costs {
  readonly sample: number;
  readonly triangle: number;
}

/** A picture while the view moves. */
export interface MovingPicture {
  /** Of the resolution. */
  readonly divisor: number;
  /** Share of the steps that a ray takes at the finest. */
  readonly step: number;
}

/**
 * From fine to coarse. A half of all steps still leads a ray through each second voxel, so that is given up
 * before the last of the resolution is; where a pixel is as wide as eight, so are steps of four voxels, about. The last
 * one is the limit, however slow it is: below it nobody sees any more what is turned.
 */
export const movingPictures: readonly [MovingPicture, ...MovingPicture[]] = [
  { divisor: 1, step: 1 },
  { divisor: 2, step: 1 },
  { divisor: 3, step: 1 },
  { divisor: 4, step: 1 },
  { divisor: 4, step: 0.5 },
  { divisor: 6, step: 0.5 },
  { divisor: 8, step: 0.5 },
  { divisor: 8, step: 0.25 },
  { divisor: 12, step: 0.25 },
];

/** Share of what is known that each new measurement replaces. */
const learning = 0.15;
/** One slow picture alone tells little: no more than so many times the expected time is laid to samples and triangles. */
const mostWrong = 4;
/** Least spread of the pictures' sizes that tells fixed cost from that of samples, as a share of their mean. */
const leastSpread = 0.15;
/** No renderer is believed to be quicker [ms per sample or triangle]. */
const leastCost = 1e-9;
/** Share of a frame that samples have at least: fewer of them would not make the other parts less. */
const leastShare = 0.5;
/** All triangles are taken up again where this share of their time would do: else they would come and go. */
const margin = 0.8;

/** Most strips that a level is cut into, for each step per voxel edge. */
const mostStrips = 32;

export class Pace {
  private fixedCost = 0;
  private sampleCost: number;
  private triangleCost: number;
  private chosen: Detail = "all";
  /** Averages of samples, time, samples², samples·time over the last pictures. */
  private means: Means | null = null;
  /** The last picture that moved, as a place in `movingPictures`. */
  private moved: number | null = null;

  /**
   * @param frameBudget time for a picture while the view moves, and for a strip at rest [ms].
   * @param guess of what is not known yet.
   */
  constructor(
    public frameBudget: number,
    guess: Costs,
  ) {
    this.sampleCost = guess.sample;
    this.triangleCost = guess.triangle;
  }

  /** Learns from a whole picture, at once or in strips, whose samples and triangles took `milliseconds`. */
  learn(samples: number, milliseconds: number, triangles = 0): void {
    if (samples <= 0 || milliseconds <= 0) {
      return;
    }
    if (triangles > 0) {
      this.scale(samples, milliseconds, triangles);
    } else {
      this.fit(samples, milliseconds);
    }
  }

  /** Expected time for samples, without the fixed part [ms]. */
  expected(samples: number): number {
    return samples * this.sampleCost;
  }

  /** Whether all triangles of surfaces can be drawn within a frame, beside `samples` at their finest or beside their least share. */
  detail(samples: number, triangles: number): Detail {
    const time = Math.max((1 - leastShare) * this.frameBudget, this.frameBudget - this.fixedCost - this.expected(samples));
    const room = this.chosen === "few" ? margin * time : time;
    this.chosen = triangles * this.triangleCost <= room ? "all" : "few";
    return this.chosen;
  }

  /**
   * The finest picture that is done within a frame beside so many triangles, else the coarsest; of `samples` at its finest.
   * From one to the next it becomes finer by one at most: so none is many times as slow as the one before, whatever
   * was learned of another view.
   */
  moving(samples: number, triangles = 0): MovingPicture {
    const others = this.fixedCost + triangles * this.triangleCost;
    const time = Math.max(leastShare * this.frameBudget, this.frameBudget - others);
    const fits = ({ divisor, step }: MovingPicture): boolean => this.expected((samples * step) / divisor ** 2) <= time;
    const fitting = movingPictures.findIndex(fits);
    this.moved = Math.max(fitting < 0 ? movingPictures.length - 1 : fitting, (this.moved ?? 0) - 1);
    return movingPictures[this.moved] ?? movingPictures[0];
  }

  /** Rows of a level that are drawn within a frame. */
  stripRows(width: number, height: number, stepsPerVoxel: number): number {
    const fitting = Math.floor(this.frameBudget / Math.max(1e-12, this.expected(width * stepsPerVoxel)));
    return Math.min(height, Math.max(Math.ceil(height / (mostStrips * stepsPerVoxel)), fitting));
  }

  /** Lays what was expected wrongly to samples and triangles, to each by its share of the time. */
  private scale(samples: number, milliseconds: number, triangles: number): void {
    const [ofSamples, ofTriangles] = [this.expected(samples), triangles * this.triangleCost];
    const expected = this.fixedCost + ofSamples + ofTriangles;
    const wrong = Math.min(mostWrong, milliseconds / expected - 1);
    this.sampleCost = Math.max(leastCost, this.sampleCost * (1 + (learning * wrong * ofSamples) / expected));
    this.triangleCost = Math.max(leastCost, this.triangleCost * (1 + (learning * wrong * ofTriangles) / expected));
  }

  /** A straight line through the last pictures without triangles. */
  private fit(samples: number, milliseconds: number): void {
    const newest = [samples, milliseconds, samples * samples, samples * milliseconds] as const;
    const [x, y, xx, xy] = (this.means = mixed(this.means ?? newest, newest));
    const spread = xx - x * x;
    const slope = (xy - x * y) / spread;
    if (spread > (leastSpread * x) ** 2 && slope > 0) {
      this.sampleCost = Math.max(leastCost, slope);
      this.fixedCost = Math.max(0, y - x * this.sampleCost);
    } else {
      // pictures of one size tell only the sum, and so do those of which the larger ones were quicker
      this.sampleCost = Math.max(leastCost, (y - Math.min(this.fixedCost, 0.5 * y)) / x);
    }
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
