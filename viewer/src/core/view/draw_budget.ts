/**
 * How much of the picture to draw at once, so that the page stays smooth on any renderer.
 *
 * What pictures cost is learned from those that were drawn, apart for those that move and those at rest: rays of large
 * pictures lie closer together, and are cheaper. Only whole pictures tell: of one strip there is air, of the next one a
 * skull. While the view moves, the picture is drawn as fine as the budget of one frame allows, by resolution, step and
 * detail of surfaces; at rest it is refined level by level, in strips of rows that each fit into that budget too.
 */
import { CostModel, type Workload } from "./cost_model";

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
  { divisor: 16, step: 0.25 },
  { divisor: 20, step: 0.25 },
];

/** By how much the coarsest picture divides the resolution. */
export const coarsest = Math.max(...movingPictures.map(({ divisor }) => divisor));

/** What is drawn with fewer samples is not divided by more than this. A view of 1366×768 has 656 at its coarsest. */
const leastSamples = 600;
const divisorOfFew = 12;

/** A picture that takes this many times as long as the coarsest is not much slower. */
const worthwhile = 1.15;
/** Share of a frame that pictures are meant to take: one that is late by little waits for the screen's next refresh. */
const aimed = 0.9;
/** Share of a frame that triangles have at least, whatever samples would take at their finest. */
const leastShare = 0.5;
/** All triangles are taken up again where this share of their time would do: else they would come and go. */
const margin = 0.8;

/**
 * After so many pictures that were all as fine, a finer one is tried, or a coarser one where they take too long: those
 * of one size do not tell what is fixed of their costs, and with a wrong belief could remain coarser or slower than
 * they need be.
 */
const firstPause = 24;
/** Budgets that a trial is expected to take at most, or times of the pictures before it. */
const mostOfTrial = 2;

/** Most strips that a level is cut into, for each step per voxel edge. */
const mostStrips = 32;

export class DrawBudget {
  private readonly moving: CostModel;
  private readonly resting: CostModel;
  private chosen: Detail = "all";
  /** The last picture that moved, as a place in `movingPictures`. */
  private moved: number | null = null;
  /** Pictures since then that were meant to be as fine, and how many of them there are until a trial. */
  private alike = 0;
  private pause = firstPause;

  /**
   * @param frameBudget time for a picture while the view moves, and for a strip at rest [ms].
   * @param guess of what is not known yet [ms each].
   */
  constructor(
    public frameBudget: number,
    guess: Workload,
  ) {
    this.moving = new CostModel(guess);
    this.resting = new CostModel(guess);
  }

  /** Learns from a picture that moved. */
  learnMoving(work: Workload, milliseconds: number): void {
    this.moving.learn(work, milliseconds);
  }

  /** Learns from a whole picture at rest, which was waited for with each of its strips. */
  learnResting(work: Workload, milliseconds: number): void {
    this.resting.learn(work, milliseconds);
  }

  /**
   * Whether all triangles of surfaces can be drawn within a frame, beside `samples` at their finest or beside their
   * least share.
   */
  detail(samples: number, triangles: number): Detail {
    const time = Math.max(
      leastShare * this.frameBudget,
      this.frameBudget - this.moving.expected({ waits: 1, samples }),
    );
    const room = this.chosen === "few" ? margin * time : time;
    this.chosen = this.moving.expected({ triangles }) <= room ? "all" : "few";
    return this.chosen;
  }

  /**
   * The finest picture that is done within a frame beside so many triangles, or takes not much longer than the
   * coarsest; of `samples` at its finest. From one to the next it becomes finer by one at most: so none is many times
   * as slow as the one before, whatever was learned of another view.
   */
  picture(samples: number, triangles = 0): MovingPicture {
    const { frameBudget, moving } = this;
    const taken = ({ divisor, step }: MovingPicture): number => (samples * step) / divisor ** 2;
    const useful = movingPictures.filter((one) => one.divisor <= divisorOfFew || taken(one) >= leastSamples);
    const times = useful.map((one) => moving.expected({ waits: 1, samples: taken(one), triangles }));
    const most = Math.max(aimed * frameBudget, worthwhile * (times.at(-1) ?? 0));
    const place = Math.min(useful.length - 1, Math.max(times.findIndex((time) => time <= most), (this.moved ?? 0) - 1));
    this.count(place);
    return useful[this.tried(place, times)] ?? movingPictures[0];
  }

  /** Counts pictures that are meant to be as fine as the last one. */
  private count(place: number): void {
    if (place === this.moved) {
      this.alike += 1;
    } else {
      this.moved = place;
      this.alike = 0;
      this.pause = firstPause;
    }
  }

  /**
   * The place to be drawn instead of what is meant, where a trial is due. Each one that leads to nothing doubles the
   * time to the next.
   */
  private tried(place: number, times: readonly number[]): number {
    const { frameBudget } = this;
    const meant = times[place] ?? 0;
    const other = meant > aimed * frameBudget ? place + 1 : place - 1;
    if (this.alike < this.pause || (times[other] ?? Infinity) > mostOfTrial * Math.max(frameBudget, meant)) {
      return place;
    }
    this.pause += this.alike;
    return other;
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
