/**
 * How long nothing has come from the engine, which tells what is 60 times a second: what a page knows
 * is old soon after it falls silent.
 */

/** `short`: what is known is old; `long`: the engine stands still, and a person is told. */
export type Silence = "none" | "short" | "long";

/** From when on a silence counts [ms]. */
const shortest = 300;
const long = 4000;
/** How often it is looked [ms]. */
export const lookEvery = 100;

export class SilenceWatch {
  private heardAt: number | null = null;
  private lookedAt = 0;
  private last: Silence = "none";

  /** Something has come [ms, of the same clock as `look`]; gives the silence where it has changed. */
  heard(now: number): Silence | null {
    this.heardAt = now;
    return this.changed("none");
  }

  /** The connection has ended: no engine is waited for. */
  forget(): Silence | null {
    this.heardAt = null;
    return this.changed("none");
  }

  /** Looks how long it has been silent; gives the silence where it has changed. */
  look(now: number): Silence | null {
    const late = now - this.lookedAt > 2 * lookEvery;
    this.lookedAt = now;
    // who looks late may not have read yet what has come
    if (late || this.heardAt === null) {
      return null;
    }
    const silent = now - this.heardAt;
    return this.changed(silent > long ? "long" : silent > shortest ? "short" : this.last);
  }

  private changed(silence: Silence): Silence | null {
    if (silence === this.last) {
      return null;
    }
    this.last = silence;
    return silence;
  }
}
