/**
 * Marks in a person's hand: they are set point by point, dragged, named and taken back. Every change
 * is one step of the page's own history; each mark is kept with the scan, and goes into its scene.
 */
import { areaBetween, isArea, type AreaAxes } from "../../../core/marks/area";
import {
  changedMark,
  lineOf,
  markChanges,
  pointsOf,
  saneMark,
  withMark,
  withoutMark,
  withPointAt,
  type Mark,
  type MarkKind,
} from "../../../core/marks/measure";
import type { Vec3 } from "../../../core/geometry/vector";
import { PageState } from "../../state/page_state.svelte";
import type { PageSteps } from "../../state/page_steps.svelte";
import type { ScanMemory } from "../../state/scan_memory";

/** Parts of what is kept with a scan: a mark each, by its number. */
const kind = "mark";

export class MarkControl {
  /** What is being set, with the points that it has by now. */
  placing = $state.raw<{ readonly kind: MarkKind; readonly points: readonly Vec3[] } | null>(null);
  /** The first corner of an area that is being set, and along what it is set. */
  private corner: { readonly point: Vec3; readonly axes: AreaAxes } | null = null;

  private readonly state: PageState<readonly Mark[]>;

  constructor(
    steps: PageSteps,
    private readonly memory: ScanMemory,
  ) {
    this.state = new PageState<readonly Mark[]>([], steps, this.keep.bind(this));
    memory.onChange((name, value) => {
      const [part, number = ""] = name.split(".");
      if (part === kind) {
        this.take(parseInt(number, 16), value);
      }
    });
  }

  /** Takes up a scan with the marks that were set on it. */
  open(): void {
    this.cancel();
    this.state.open(this.memory.all(kind).flatMap(([number, mark]) => saneMark(mark, parseInt(number, 16))));
  }

  get all(): readonly Mark[] {
    return this.state.now;
  }

  /** Points along each mark that is seen, and of what is being set. */
  readonly lines = $derived.by((): readonly (readonly Vec3[])[] => {
    const seen = this.all.filter(({ visible }) => visible).map(lineOf);
    return this.placing === null ? seen : [...seen, lineOf(this.placing)];
  });

  /** Whether an area waits for its corners, which are set in slices alone. */
  get drawsArea(): boolean {
    return this.placing !== null && isArea(this.placing.kind);
  }

  /** Waits for the points of a mark. */
  start(kind: MarkKind): void {
    this.corner = null;
    this.placing = { kind, points: [] };
  }

  cancel(): void {
    this.corner = null;
    this.placing = null;
  }

  /** A corner of the area that is being set, in a slice with these axes; the opposite one makes the mark. */
  putCorner(point: Vec3, axes: AreaAxes): void {
    const { corner, placing } = this;
    if (placing === null) {
      return;
    }
    if (corner === null) {
      this.corner = { point, axes };
      this.placing = { ...placing, points: [point] };
      return;
    }
    const points = areaBetween(corner.point, point, corner.axes);
    if (points !== null) {
      this.cancel();
      this.add(placing.kind, points);
    }
  }

  /** Shows the area that is being set as it would be with this corner. */
  showCorner(point: Vec3): void {
    if (this.corner !== null && this.placing !== null) {
      const points = areaBetween(this.corner.point, point, this.corner.axes) ?? [this.corner.point];
      this.placing = { ...this.placing, points };
    }
  }

  /** A point of what is being set; its last one makes the mark. An area takes corners, and no points. */
  put(point: Vec3): void {
    if (this.placing === null || this.drawsArea) {
      return;
    }
    const { kind } = this.placing;
    const points = [...this.placing.points, point];
    if (points.length < pointsOf[kind]) {
      this.placing = { kind, points };
    } else {
      this.placing = null;
      this.add(kind, points);
    }
  }

  /** A point of what is being set; a mark of its own where nothing is. */
  set(point: Vec3): void {
    if (this.placing === null) {
      this.start("point");
    }
    this.put(point);
  }

  add(kind: MarkKind, points: readonly Vec3[]): void {
    this.change(withMark(this.all, kind, points));
  }

  /** Has a point of a mark stand elsewhere while it is dragged. */
  drag(id: number, index: number, point: Vec3): void {
    this.change(withPointAt(this.all, id, index, point), true);
  }

  rename(id: number, name: string): void {
    this.change(changedMark(this.all, id, { name }));
  }

  show(id: number, visible: boolean): void {
    this.change(changedMark(this.all, id, { visible }));
  }

  remove(id: number): void {
    this.change(withoutMark(this.all, id));
  }

  removeAll(): void {
    this.change([]);
  }

  private change(marks: readonly Mark[], dragging = false): void {
    this.state.change("marks", marks, dragging);
  }

  /** Keeps what is another than before, and nothing else: other pages have marks too. */
  private keep(marks: readonly Mark[], before: readonly Mark[]): void {
    for (const [id, mark] of markChanges(before, marks)) {
      this.memory.keep(`${kind}.${id.toString(16)}`, mark);
    }
  }

  /** A mark was set, changed or removed on another page. */
  private take(id: number, value: object | null): void {
    const [mark] = value === null ? [] : saneMark(value, id);
    const isHere = this.all.some((each) => each.id === id);
    const others = this.all.flatMap((each) => (each.id !== id ? [each] : mark === undefined ? [] : [mark]));
    this.state.take(isHere || mark === undefined ? others : [...others, mark]);
  }
}
