/**
 * Which of both draws the 3-D view quicker, browser or engine, where the browser's graphics are drawn by the CPU.
 *
 * The engine begins: it has nothing to compile. As long as its pictures come soon enough to turn the view by, the
 * browser is not even looked at. Where they do not, over a slow link or on a busy machine, one picture of the browser
 * is timed beside, once its programs are made; nothing waits for that. Whoever does not draw must be much quicker to
 * take over, so that the choice does not go back and forth.
 */
import { formatFixed } from "../base/format";

export type Drawer = "browser" | "engine";

/** Pictures that come within this time are soon enough [ms]. */
const enough = 200;
/** So many times as quick must one be to take over. */
const margin = 2;
/** The median of so many times counts, of so few at least: the first of a view are slower. */
const [mostTimes, fewestTimes] = [5, 3];
/** So long a time is believed of the one that does not draw, and of the browser [ms]. */
const believed = { engine: 30_000, browser: 60_000 } as const;

export class QuickerDrawer {
  drawer: Drawer = "engine";
  private engineTimes: readonly number[] = [];
  private engineAt = -Infinity;
  private browserTime: number | null = null;
  private browserAt = -Infinity;

  /** @param clock tells the time [ms]. */
  constructor(private readonly clock: () => number = () => performance.now()) {}

  /** Takes what a picture of the engine took from its request until it came [ms]. */
  learnEngine(milliseconds: number): void {
    this.engineTimes = [...this.engineTimes, milliseconds].slice(-mostTimes);
    this.engineAt = this.clock();
    this.decide();
  }

  /** Takes what a picture of the browser took, as fine as one of a view that turns should be [ms]. */
  learnBrowser(milliseconds: number): void {
    this.browserTime = milliseconds;
    this.browserAt = this.clock();
    this.decide();
  }

  /** Pictures are larger or smaller from now on, or drawn in another mode: what is known holds no more. */
  forget(): void {
    this.engineTimes = [];
    this.engineAt = -Infinity;
    this.browserTime = null;
    this.browserAt = -Infinity;
  }

  /** Whose picture is to be timed now; null where nobody's is. */
  get due(): Drawer | null {
    const now = this.clock();
    const isBrowserOld = now - this.browserAt > believed.browser;
    if (this.drawer === "browser") {
      const isEngineOld = now - this.engineAt > believed.engine || this.engineTimes.length < fewestTimes;
      return isBrowserOld ? "browser" : isEngineOld ? "engine" : null;
    }
    const { engine } = this;
    return engine !== null && engine > enough && isBrowserOld ? "browser" : null;
  }

  /** Why it is the one that it is. */
  get reason(): string {
    const { browserTime, engine } = this;
    if (engine === null) {
      return this.drawer === "engine" ? "this browser has no graphics card" : "it was quicker";
    }
    const other = browserTime === null ? "this browser has no graphics card" : `this browser ${told(browserTime)}`;
    // @texts
    const who = this.drawer === "engine" ? "it" : "the engine";
    return `${who} takes ${told(engine)} for a picture while the view turns, ${other}`;
  }

  private get engine(): number | null {
    const times = [...this.engineTimes].sort((a, b) => a - b);
    return times.length < fewestTimes ? null : (times[Math.floor(times.length / 2)] ?? null);
  }

  private decide(): void {
    const { browserTime, engine } = this;
    if (browserTime === null || engine === null) {
      return;
    }
    if (this.drawer === "engine" && engine > enough && margin * browserTime < engine) {
      this.drawer = "browser";
      // what is measured of the engine from now on is measured beside the browser's drawing
      this.engineTimes = [];
    } else if (this.drawer === "browser" && margin * engine < browserTime) {
      this.drawer = "engine";
    }
  }
}

/** A time as people read it. */
function told(milliseconds: number): string {
  const rounded = 10 * Math.round(milliseconds / 10);
  return rounded < 1000 ? formatFixed(rounded, 0, "ms") : formatFixed(milliseconds / 1000, 1, "s");
}
