/**
 * Where the probe was in the last seconds, as a line that fades: points in the scene [mm].
 * A ring of fixed size; nothing is allocated while it runs.
 */
import { distance, type Vec3 } from "../geometry/vector";

/** Numbers of a drawn piece: from (x, y, z), to (x, y, z), and how fresh both ends are, 0..1. */
export const pieceNumbers = 8;

/** A probe that seems to move faster was placed elsewhere: no line leads there [mm/s]. */
const fastest = 2000;

export class PathTrail {
  /** Rows (x, y, z, time, 1 where a line leads here from the point before). */
  private readonly kept: Float64Array;
  private next = 0;
  private held = 0;
  private head: { readonly point: Vec3; readonly time: number } | null = null;

  /**
   * @param seconds a point stays.
   * @param capacity points kept, at most.
   * @param spacing of the points kept, at least [mm].
   */
  constructor(
    readonly seconds: number,
    private readonly capacity: number,
    private readonly spacing: number,
  ) {
    this.kept = new Float64Array(5 * capacity);
  }

  /** Adds where the probe is at a time [s]; a time before the last one starts a new session. */
  add(time: number, point: Vec3): void {
    const last = this.head;
    if (last !== null && time < last.time) {
      this.clear();
    }
    const jumped = last === null || distance(last.point, point) > fastest * Math.max(time - last.time, 1e-3);
    this.head = { point, time };
    if (this.held === 0 || jumped || distance(this.pointAt(this.held - 1), point) >= this.spacing) {
      const at = 5 * this.next;
      this.kept.set([point[0], point[1], point[2], time, this.held > 0 && !jumped ? 1 : 0], at);
      this.next = (this.next + 1) % this.capacity;
      this.held = Math.min(this.held + 1, this.capacity);
    }
  }

  clear(): void {
    this.next = 0;
    this.held = 0;
    this.head = null;
  }

  /** Something of the line can still be seen. */
  get alive(): boolean {
    return this.head !== null && this.held > 1 && this.freshness(this.held - 1) > 0;
  }

  /** The ends of the pieces that can be seen, the oldest first. */
  get points(): readonly Vec3[] {
    return Array.from({ length: this.held }, (_, i) => i)
      .filter((i) => this.freshness(i + 1 < this.held ? i + 1 : i) > 0)
      .map((i) => this.pointAt(i));
  }

  /** Writes the pieces that can be seen, `pieceNumbers` each; returns how many. */
  write(pieces: Float32Array): number {
    let count = 0;
    for (let i = 1; i < this.held && (count + 1) * pieceNumbers <= pieces.length; ++i) {
      const fresh = this.freshness(i);
      if (fresh > 0 && this.kept[5 * this.slot(i) + 4] === 1) {
        const ends = [...this.pointAt(i - 1), ...this.pointAt(i), this.freshness(i - 1), fresh];
        pieces.set(ends, count * pieceNumbers);
        count += 1;
      }
    }
    return count;
  }

  /** Place in the ring of the i-th oldest point. */
  private slot(i: number): number {
    return (this.next + this.capacity - this.held + i) % this.capacity;
  }

  private pointAt(i: number): Vec3 {
    const at = 5 * this.slot(i);
    return [this.kept[at] ?? 0, this.kept[at + 1] ?? 0, this.kept[at + 2] ?? 0];
  }

  /** 1 now, 0 once the point is as old as the line is long. */
  private freshness(i: number): number {
    const age = (this.head?.time ?? 0) - (this.kept[5 * this.slot(i) + 3] ?? 0);
    return Math.max(0, 1 - age / this.seconds);
  }
}
