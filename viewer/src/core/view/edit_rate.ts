/**
 * Every how many frames of the picture voxels and surfaces follow edits: every one, or on slow
 * machines fewer, with the edits between them shown together.
 *
 * Source: thesis 5.2.2, where surfaces are updated every k-th picture frame on slow machines.
 */

/** What can be chosen; "auto" goes by the time that the page needs. */
export const editRates = ["auto", 1, 2, 4] as const;
export type EditRateChoice = (typeof editRates)[number];
export type Every = 1 | 2 | 4;

/** A frame of the engine's picture [ms]. */
const frame = 1000 / 60;
/** Share of what is known that each new frame replaces. */
const learning = 0.1;
/** A faster pace is taken up where this share of its time would do: else it would come and go. */
const margin = 0.8;
/** Longer ones tell of a page in the background [ms]. */
const longest = 1000;
/** One slow frame alone must not tell of a slow machine: none counts for more [ms]. */
const mostCounted = 5 * frame;

export class EditRate {
  /** From a frame with an edit in it to the next frame [ms]. */
  private needed = frame;
  private current: Every = 1;

  /** Every how many frames, by the time that the page needs. */
  get every(): Every {
    return this.current;
  }

  /** Learns how long a frame with an edit in it took until the next one began [ms]. */
  learn(milliseconds: number): void {
    if (milliseconds <= 0 || milliseconds > longest) {
      return;
    }
    this.needed += learning * (Math.min(milliseconds, mostCounted) - this.needed);
    const fits = (every: Every): boolean => {
      // a frame is never shorter than the screen's, and may begin a little late
      const time = (every + 0.5) * frame;
      return this.needed <= (every < this.current ? margin * time : time);
    };
    this.current = ([1, 2] as const).find(fits) ?? 4;
  }
}
