/**
 * Seeded random numbers, so that a failing test fails again (mulberry32, Tommy Ettinger).
 */
import type { Vec3 } from "../../src/core/geometry/vector";

export class Random {
  constructor(private state: number) {}

  /** From `low` to `high`. */
  between(low: number, high: number): number {
    this.state = (this.state + 0x6d2b79f5) | 0;
    let mixed = Math.imul(this.state ^ (this.state >>> 15), 1 | this.state);
    mixed = (mixed + Math.imul(mixed ^ (mixed >>> 7), 61 | mixed)) ^ mixed;
    return low + (high - low) * (((mixed ^ (mixed >>> 14)) >>> 0) / 2 ** 32);
  }

  whole(low: number, high: number): number {
    return Math.floor(this.between(low, high + 1));
  }

  vector(size: number): Vec3 {
    return [this.between(-size, size), this.between(-size, size), this.between(-size, size)];
  }
}
