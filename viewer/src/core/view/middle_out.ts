/**
 * Strips of rows of a picture in the order in which they are drawn: from the middle, where people look, to both ends.
 */

/** From the first row to before the last. */
export type Rows = readonly [number, number];

export class MiddleOut {
  /** Rows that were taken already. */
  private low: number;
  private high: number;
  private readonly middle: number;

  constructor(private readonly all: Rows) {
    this.middle = this.low = this.high = Math.floor((all[0] + all[1]) / 2);
  }

  /** All rows were taken. */
  get done(): boolean {
    return this.low <= this.all[0] && this.high >= this.all[1];
  }

  /** Takes the next rows, so many at most. */
  take(count: number): Rows {
    const [from, to] = this.all;
    const isUpper = this.low <= from || (this.high < to && this.high - this.middle <= this.middle - this.low);
    if (isUpper) {
      const begin = this.high;
      this.high = Math.min(to, begin + count);
      return [begin, this.high];
    }
    const end = this.low;
    this.low = Math.max(from, end - count);
    return [this.low, end];
  }
}
