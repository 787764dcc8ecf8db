/**
 * How much of the picture to draw at once, so that a view that turns is seen to turn, and a page stays fluent.
 *
 * What pictures cost is learned from those that were drawn while the view moved. They are drawn as fine as the budget
 * of one allows, by resolution, step and detail of surfaces. At rest finer pictures follow in pieces.
 */
import { CostModel, type Workload } from "./cost_model";

/** Which triangles of surfaces are drawn. */
export type Detail = "all" | "few";

/** How fine a picture is. */
export interface Level {
  /** Of the resolution. */
  readonly divisor: number;
  /** Share of the steps that a ray takes at the finest. */
  readonly step: number;
}

/**
 * Pictures while the view moves, from fine to coarse. A half of all steps still leads a ray through each second voxel,
 * so that is given up before the last of the resolution is. The last one is the limit, however slow it is: below it
 * nobody sees any more what is turned.
 */
export const movingPictures: readonly [Level, ...Level[]] = [
  { divisor: 1, step: 1 },
  { divisor: 2, step: 1 },
  { divisor: 3, step: 1 },
  { divisor: 4, step: 1 },
  { divisor: 4, step: 0.5 },
  { divisor: 6, step: 0.5 },
  { divisor: 8, step: 0.5 },
  { divisor: 8, step: 0.25 },
];

/** By how much the coarsest picture divides the resolution. */
export const coarsest = Math.max(...movingPictures.map(({ divisor }) => divisor));

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

/** Share of the steps in a picture at rest that finer ones follow. */
const restingStep = 0.5;

/** Most pieces that a picture at rest is drawn in, for each step per voxel edge. */
const mostPieces = 32;
/** Time for a piece at rest, at most: a view that is turned again waits for it [ms]. */
const mostOfPiece = 100;
/** From one piece to the next they change by these factors at most: of one there is air, of the next a skull. */
const [leastChange, mostChange] = [0.1, 2];

export class DrawBudget {
  private readonly moving: CostModel;
  private chosen: Detail = "all";
  /** The last picture that moved, as a place in `movingPictures`. */
  private moved: number | null = null;
  /** Pictures since then that were meant to be as fine, and how many of them there are until a trial. */
  private alike = 0;
  private pause = firstPause;
  /** Samples of a piece that takes its budget, and of the last picture that moved. */
  private fitting = 0;
  private movedSamples = 0;

  /**
   * @param frameBudget time for a picture while the view moves [ms].
   * @param guess of what is not known yet [ms each].
   */
  constructor(
    public frameBudget: number,
    guess: Workload,
  ) {
    this.moving = new CostModel(guess);
  }

  /** Learns from a picture that moved. */
  learnMoving(work: Workload, milliseconds: number): void {
    this.moving.learn(work, milliseconds);
    this.movedSamples = work.samples;
    this.fitting = (work.samples * this.pieceBudget) / Math.max(milliseconds, 1);
  }

  /** Learns from a piece of a picture at rest. */
  learnPiece(samples: number, milliseconds: number): void {
    const change = this.pieceBudget / Math.max(milliseconds, 1);
    if (samples < this.fitting / 2 && change > 1) {
      // the rest of a picture, which tells nothing of larger pieces
      return;
    }
    this.fitting = samples * Math.min(mostChange, Math.max(leastChange, change));
  }

  /** Time for a piece of what is drawn at rest [ms]. */
  get pieceBudget(): number {
    return Math.min(this.frameBudget, mostOfPiece);
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
  picture(samples: number, triangles = 0): Level {
    const { frameBudget, moving } = this;
    const taken = ({ divisor, step }: Level): number => (samples * step) / divisor ** 2;
    const times = movingPictures.map((one) => moving.expected({ waits: 1, samples: taken(one), triangles }));
    const most = Math.max(aimed * frameBudget, worthwhile * (times.at(-1) ?? 0));
    const place = Math.max(times.findIndex((time) => time <= most), (this.moved ?? 0) - 1);
    this.count(place);
    return movingPictures[this.tried(place, times)] ?? movingPictures[0];
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

  /**
   * Rows of a picture at rest, of so many pixels each, that are a piece of it. None is smaller than the last picture
   * that moved: a view that is turned waits as long for that.
   */
  pieceRows(width: number, height: number, stepsPerVoxel: number): number {
    const fitting = Math.floor(Math.max(this.fitting, this.movedSamples) / (width * stepsPerVoxel));
    return Math.min(height, Math.max(Math.ceil(height / (mostPieces * stepsPerVoxel)), fitting));
  }
}

/** The pictures still to draw, after one whose resolution was divided by `done`, when the view rests. */
export function levelsAfter(done: number): Level[] {
  return [4, 2, 1]
    .filter((divisor) => divisor === 1 || 1.5 * divisor <= done)
    .map((divisor) => ({ divisor, step: divisor > 1 ? restingStep : 1 }));
}
