/**
 * An outline in a slice that is being drawn: by the live wire, from click to click along edges, or the
 * level under the pointer. What it encloses is painted with the brush's segment.
 *
 * One answer of the engine is awaited at a time: of pointers only the newest is asked for, clicks wait in
 * turn.
 */
import type { SliceName } from "../../../core/slices/slice_plane";
import { distance, dot, subtract, type Vec3 } from "../../../core/geometry/vector";
import type { BrushControl } from "./brush_control.svelte";
import type { Session } from "../../state/session.svelte";

/** A point farther from a slice than this is not in it [mm]. */
const aside = 0.05;

type Act = "show" | "keep" | "close" | "fill";

/** What is asked for at a point. */
interface Wanted {
  readonly point: Vec3;
  readonly act: Act;
}

export class OutlineControl {
  /** The slice that is drawn in; null where nothing is. */
  name = $state.raw<SliceName | null>(null);
  /** Pieces of the wire that are set, each from a click to the next. */
  pieces = $state.raw<readonly (readonly Vec3[])[]>([]);
  /** Where the wire, or the level, would go from there. */
  preview = $state.raw<readonly Vec3[]>([]);
  /** Where the wire began; null before its first click. */
  first = $state.raw<Vec3 | null>(null);

  private normal: Vec3 = [0, 0, 1];
  private wanted: readonly Wanted[] = [];
  private asked: { readonly number: number; readonly act: Act; readonly greetings: number } | null = null;
  private number = 0;

  constructor(
    private readonly session: Session,
    private readonly brush: BrushControl,
  ) {
    session.onOutline(({ number, points, problem }) => {
      this.take(number, points, problem);
    });
  }

  /** Whether a wire was begun. */
  get drawing(): boolean {
    return this.first !== null;
  }

  /** Whether a point lies in the slice that the wire was begun in; any does, where none was. */
  isIn(point: Vec3): boolean {
    return this.first === null || Math.abs(dot(subtract(point, this.first), this.normal)) < aside;
  }

  /** A click at a point of a slice: begins a wire, sets its next point, or fills a level. */
  click(name: SliceName, point: Vec3, normal: Vec3): void {
    if (this.name !== name || !this.isIn(point)) {
      this.cancel();
    }
    [this.name, this.normal] = [name, normal];
    if (this.brush.habits.way === "level") {
      this.want({ point, act: "fill" });
    } else if (this.first === null) {
      this.first = point;
    } else {
      this.want({ point, act: "keep" });
    }
  }

  /** The pointer is at a point of a slice. */
  point(name: SliceName, point: Vec3, normal: Vec3): void {
    const isLevel = this.brush.habits.way === "level";
    if (isLevel) {
      [this.name, this.normal] = [name, normal];
    }
    if (name === this.name && (isLevel || this.drawing) && this.isIn(point)) {
      this.want({ point, act: "show" });
    }
  }

  /** Closes the wire and paints what it encloses; false where there is none. */
  close(): boolean {
    if (this.first === null) {
      return false;
    }
    this.want({ point: this.pieces[0]?.[0] ?? this.first, act: "close" });
    return true;
  }

  /** Takes the last point of the wire back; false where there is none. */
  back(): boolean {
    if (this.first === null) {
      return false;
    }
    this.wanted = [];
    // an answer that comes still would be of what was before
    this.asked = null;
    this.preview = [];
    if (this.pieces.length > 0) {
      this.pieces = this.pieces.slice(0, -1);
    } else {
      this.cancel();
    }
    return true;
  }

  /** Draws no more; false where nothing was begun. */
  cancel(): boolean {
    const was = this.drawing;
    this.wanted = [];
    this.asked = null;
    this.name = this.first = null;
    this.pieces = this.preview = [];
    return was;
  }

  /** The pointer has left the slice: a level is shown no more. */
  leave(): void {
    if (!this.drawing) {
      this.cancel();
    }
  }

  private want(wanted: Wanted): void {
    // a pointer that has moved on is of no interest
    this.wanted = [...this.wanted.filter(({ act }) => act !== "show"), wanted];
    this.ask();
  }

  private ask(): void {
    const { greetings } = this.session;
    const [next, ...rest] = this.wanted;
    // what was asked on a connection that was lost is not answered any more
    if (this.asked?.greetings === greetings || next === undefined) {
      return;
    }
    this.wanted = rest;
    this.number += 1;
    this.asked = { number: this.number, act: next.act, greetings };
    const { number, normal } = this;
    const begin = this.pieces.at(-1)?.at(-1) ?? this.first;
    if (this.brush.habits.way === "level" || begin === null) {
      this.session.send({ type: "trace_level", number, point: next.point, normal });
    } else {
      this.session.send({ type: "wire", number, begin, end: next.point, normal });
    }
  }

  private take(number: number, points: readonly Vec3[], problem: string | null): void {
    if (this.asked?.number !== number) {
      return;
    }
    const { act } = this.asked;
    this.asked = null;
    if (problem !== null && act !== "show") {
      this.session.notify("info", problem);
    }
    this.preview = act === "show" ? points : [];
    if (points.length > 0 && act === "keep") {
      this.pieces = [...this.pieces, points];
    } else if (points.length > 0 && act !== "show") {
      this.fill([...this.pieces, points].flat());
    }
    this.ask();
  }

  private fill(points: readonly Vec3[]): void {
    const { segment } = this.brush;
    const { normal } = this;
    this.cancel();
    const corners = points.filter((point, i) => i === 0 || distance(point, points[i - 1] ?? point) > 0);
    if (segment !== null && corners.length >= 3) {
      const { erases, values } = this.brush;
      this.session.send({ type: "fill_outline", id: segment.id, erases, points: corners, normal, values });
    }
  }
}
