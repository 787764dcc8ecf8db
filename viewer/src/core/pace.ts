/**
 * How much of the picture to draw at once, so that the page stays smooth on any renderer.
 *
 * What pictures cost is learned from those that were drawn, apart for those that move and those at rest: rays of large
 * pictures lie closer together, and are cheaper. Only whole pictures tell: of one strip there is air, of the next one a skull.
 * While the view moves, the picture is drawn as fine as the budget of one frame allows, by resolution, step
 * and detail of surfaces; at rest it is refined level by level, in strips of rows that each fit into that budget too.
 */
import { CostModel, type Work } from "./cost_model";

/** Which triangles of surfaces are drawn. */
export type Detail = "all" | "few";

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

/** Share of a frame that samples have at least: fewer of them would not make the other parts less. */
const leastShare = 0.5;
/** All triangles are taken up again where this share of their time would do: else they would come and go. */
const margin = 0.8;

/** Most strips that a level is cut into, for each step per voxel edge. */
const mostStrips = 32;

export class Pace {
  private readonly moving: CostModel;
  private readonly resting: CostModel;
  private chosen: Detail = "all";
  /** The last picture that moved, as a place in `movingPictures`. */
  private moved: number | null = null;

  /**
   * @param frameBudget time for a picture while the view moves, and for a strip at rest [ms].
   * @param guess of what is not known yet [ms each].
   */
  constructor(
    public frameBudget: number,
    guess: Work,
  ) {
    this.moving = new CostModel(guess);
    this.resting = new CostModel(guess);
  }

  /** Learns from a picture that moved. */
  learnMoving(work: Work, milliseconds: number): void {
    this.moving.learn(work, milliseconds);
  }

  /** Learns from a whole picture at rest, which was waited for with each of its strips. */
  learnResting(work: Work, milliseconds: number): void {
    this.resting.learn(work, milliseconds);
  }

  /** Whether all triangles of surfaces can be drawn within a frame, beside `samples` at their finest or beside their least share. */
  detail(samples: number, triangles: number): Detail {
    const time = Math.max((1 - leastShare) * this.frameBudget, this.frameBudget - this.moving.expected({ waits: 1, samples }));
    const room = this.chosen === "few" ? margin * time : time;
    this.chosen = this.moving.expected({ triangles }) <= room ? "all" : "few";
    return this.chosen;
  }

  /**
   * The finest picture that is done within a frame beside so many triangles, else the coarsest; of `samples` at its finest.
   * From one to the next it becomes finer by one at most: so none is many times as slow as the one before, whatever
   * was learned of another view.
   */
  picture(samples: number, triangles = 0): MovingPicture {
    const time = Math.max(leastShare * this.frameBudget, this.frameBudget - this.moving.expected({ waits: 1, triangles }));
    const fits = ({ divisor, step }: MovingPicture): boolean => this.moving.expected({ samples: (samples * step) / divisor ** 2 }) <= time;
    const fitting = movingPictures.findIndex(fits);
    this.moved = Math.max(fitting < 0 ? movingPictures.length - 1 : fitting, (this.moved ?? 0) - 1);
    return movingPictures[this.moved] ?? movingPictures[0];
  }

  /** Rows of a level that are drawn within a frame. */
  stripRows(width: number, height: number, stepsPerVoxel: number): number {
    const row = this.resting.expected({ samples: width * stepsPerVoxel });
    const fitting = row > 0 ? Math.floor(this.frameBudget / row) : height;
    return Math.min(height, Math.max(Math.ceil(height / (mostStrips * stepsPerVoxel)), fitting));
  }
}

/** The divisors still to draw after `done` when the view rests: halving down to 1. */
export function levelsAfter(done: number): number[] {
  return done > 2 ? [2, 1] : [1];
}
