/**
 * The brush in slices, in a person's hand: what it paints, how large it is, and the stroke that is on.
 * Points go to the engine once a frame.
 */
import {
  brushRange,
  canBePainted,
  firstValues,
  fittingBrush,
  paintedName,
  resizedBrush,
  type BrushHabits,
} from "../../../core/segments/brush";
import type { Scan, Segment } from "../../../core/protocol";
import type { Vec3 } from "../../../core/geometry/vector";
import { OutlineControl } from "./outline_control.svelte";
import { recall, remember } from "../../state/remembered";
import type { Session } from "../../state/session.svelte";

/** As many points as one message holds. */
const mostPoints = 64;

const usual: BrushHabits = { erases: false, way: "brush", radius: 5, ball: false, within: false, low: 0, high: 0 };

export class BrushControl {
  /** Whether slices are painted where the left button is held. */
  armed = $state(false);
  habits = $state.raw<BrushHabits>(recall("brush", usual));
  /** Whether a stroke is on. */
  painting = $state(false);

  private chosen = $state.raw<number | null>(null);
  /** The name of a segment that was asked for, and is chosen once it is there. */
  private awaited = $state.raw<string | null>(null);
  /** The segments that there were when it was asked for. */
  private before: readonly Segment[] = [];
  /** The live wire, or a level: what is painted where no stroke is. */
  readonly outline: OutlineControl;
  private readonly session: Session;
  /** Path that was not sent to the engine yet; its first point is the last one sent. */
  private way: Vec3[] = [];
  private normal: Vec3 = [0, 0, 1];
  private worked: number | null = null;

  constructor(session: Session) {
    this.session = session;
    this.outline = new OutlineControl(session, this);
  }

  /** Segments that can be painted. */
  readonly segments = $derived.by((): readonly Segment[] => this.session.segments.filter(canBePainted));

  /** The segment that is painted; null where there is none. */
  readonly segment = $derived.by((): Segment | null => {
    const { segments, awaited, chosen } = this;
    const found = segments.find(({ name }) => name === awaited) ?? segments.find(({ id }) => id === chosen);
    return found ?? segments[0] ?? null;
  });

  /** Whether a person has said which segment is painted, by choosing it or by a new one. */
  readonly hasChosen = $derived.by((): boolean => {
    const { segments, awaited, chosen } = this;
    return segments.some(({ id, name }) => id === chosen || name === awaited);
  });

  /** Whether a new segment was asked for and is not there yet. */
  get awaits(): boolean {
    return this.awaited !== null && !this.hasChosen && this.session.segments === this.before;
  }

  /** Whether a press in a slice paints. */
  readonly ready = $derived.by((): boolean => this.armed && this.segment !== null);

  /** Its radius in this scan [mm]. */
  readonly radius = $derived.by((): number => {
    const { scan } = this.session;
    return scan === null ? this.habits.radius : fittingBrush(this.habits.radius, scan.spacing);
  });

  get range(): ReturnType<typeof brushRange> {
    return brushRange(this.session.scan?.spacing ?? [1, 1, 1]);
  }

  /** Begins with another scan: its values are other ones. */
  open(scan: Scan): void {
    this.chosen = this.awaited = null;
    const first = { ...recall("brush", usual), within: false, ...firstValues(scan) };
    this.habits = this.session.memory.recall("brush", first);
  }

  change(part: Partial<BrushHabits>): void {
    if (part.way !== undefined) {
      this.outline.cancel();
    }
    this.habits = { ...this.habits, ...part };
    remember("brush", this.habits);
    if (this.session.scan !== null) {
      this.session.memory.keep("brush", this.habits);
    }
  }

  resize(steps: number): void {
    if (this.session.scan !== null) {
      this.change({ radius: resizedBrush(this.radius, steps, this.session.scan.spacing) });
    }
  }

  choose(id: number): void {
    this.end();
    this.chosen = id;
    this.awaited = null;
  }

  /** Adds a segment without voxels and chooses it. */
  add(): void {
    this.end();
    const name = paintedName(this.session.segments.map((segment) => segment.name));
    this.session.send({ type: "new_segment", name });
    this.awaited = name;
    this.before = this.session.segments;
  }

  /** Takes the brush, or puts it away. */
  arm(on: boolean): void {
    this.end();
    this.outline.cancel();
    this.armed = on;
  }

  get erases(): boolean {
    return this.habits.erases;
  }

  /** The values that alone are changed; null where all are. */
  get values(): [number, number] | null {
    const { within, low, high } = this.habits;
    return within ? [Math.min(low, high), Math.max(low, high)] : null;
  }

  /** Begins a stroke at a point of the slice with this normal. */
  begin(point: Vec3, normal: Vec3): void {
    this.end();
    if (this.segment === null) {
      return;
    }
    this.worked = this.segment.id;
    this.painting = true;
    this.normal = normal;
    this.way = [point];
    this.tell();
  }

  move(point: Vec3): void {
    if (!this.painting) {
      return;
    }
    const waits = this.way.length > 1;
    this.way.push(point);
    if (!waits) {
      requestAnimationFrame(() => {
        this.flush();
      });
    }
  }

  /** Ends the stroke: it is one step of undo. */
  end(): void {
    this.leave(true);
  }

  /** Takes the stroke back; false where none is on. */
  cancel(): boolean {
    return this.leave(false);
  }

  /** Takes the stroke or the outline back, or puts the brush away where none is on. */
  escape(): void {
    if (!this.cancel() && !this.outline.cancel()) {
      this.arm(false);
    }
  }

  private leave(keep: boolean): boolean {
    if (!this.painting) {
      return false;
    }
    this.flush();
    this.painting = false;
    this.session.send({ type: "end_paint", keep });
    return true;
  }

  private flush(): void {
    if (this.painting && this.way.length > 1) {
      this.tell();
    }
  }

  /** Tells the engine of the way; its last point begins the next one. */
  private tell(): void {
    const { erases, ball } = this.habits;
    while (this.worked !== null) {
      const points = this.way.slice(0, mostPoints);
      this.session.send({
        type: "paint",
        id: this.worked,
        erases,
        points,
        radius: this.radius,
        normal: ball ? null : this.normal,
        values: this.values,
      });
      this.way = this.way.slice(points.length - 1);
      if (this.way.length < 2) {
        return;
      }
    }
  }
}
