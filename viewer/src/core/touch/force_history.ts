/**
 * The last seconds of the force, for the live plot: magnitudes [N] over time [s].
 * A ring of fixed size; nothing is allocated while it runs.
 */

/** Tick time and force components, as `State.samples` carries them. */
export type ForceSample = readonly [number, number, number, number];

export class ForceHistory {
  private readonly times: Float64Array;
  private readonly magnitudes: Float64Array;
  private next = 0;
  private held = 0;

  /** @param seconds shown. @param capacity samples kept, at most. */
  constructor(
    readonly seconds: number,
    private readonly capacity: number,
  ) {
    this.times = new Float64Array(capacity);
    this.magnitudes = new Float64Array(capacity);
  }

  /** Adds samples of rising time; a time before the last one starts a new session. */
  add(samples: readonly ForceSample[]): void {
    for (const [time, x, y, z] of samples) {
      if (time < this.latest) {
        this.clear();
      }
      this.times[this.next] = time;
      this.magnitudes[this.next] = Math.hypot(x, y, z);
      this.next = (this.next + 1) % this.capacity;
      this.held = Math.min(this.held + 1, this.capacity);
    }
  }

  clear(): void {
    this.next = 0;
    this.held = 0;
  }

  /** Time of the last sample; -Infinity where there is none. */
  get latest(): number {
    const last = (this.next + this.capacity - 1) % this.capacity;
    return this.held > 0 ? (this.times[last] ?? -Infinity) : -Infinity;
  }

  /** Seconds before the last sample (negative) and magnitudes, the oldest first. */
  series(): readonly [number[], number[]] {
    const before: number[] = [];
    const magnitudes: number[] = [];
    const latest = this.latest;
    for (let i = 0; i < this.held; ++i) {
      const at = (this.next + this.capacity - this.held + i) % this.capacity;
      const time = (this.times[at] ?? 0) - latest;
      if (time >= -this.seconds) {
        before.push(time);
        magnitudes.push(this.magnitudes[at] ?? 0);
      }
    }
    return [before, magnitudes];
  }
}
