/**
 * Marks in a person's hand: they are set point by point, dragged, named and taken back. Every change
 * is one step of the page's own history; marks are remembered with the scan and go into its scene.
 */
import {
  changedMark,
  pointsOf,
  saneMarks,
  withMark,
  withoutMark,
  withPointAt,
  type Mark,
  type MarkKind,
} from "../../../core/marks/measure";
import type { Scan } from "../../../core/protocol";
import type { Vec3 } from "../../../core/geometry/vector";
import { PageState } from "../../state/page_state.svelte";
import type { PageSteps } from "../../state/page_steps.svelte";
import { recall, remember } from "../../state/remembered";

export class MarkControl {
  /** What is being set, with the points that it has by now. */
  placing = $state.raw<{ readonly kind: MarkKind; readonly points: readonly Vec3[] } | null>(null);

  private readonly state: PageState<readonly Mark[]>;
  private scanName = "";

  constructor(steps: PageSteps) {
    this.state = new PageState<readonly Mark[]>([], steps, (list) => {
      remember(this.key, { list });
    });
  }

  /** Takes up a scan with the marks that were set on it. */
  open(scan: Scan): void {
    this.scanName = scan.name;
    this.placing = null;
    this.state.open(saneMarks(recall<{ list: unknown }>(this.key, { list: [] }).list));
  }

  get all(): readonly Mark[] {
    return this.state.now;
  }

  /** Points of each mark that is seen, and of what is being set. */
  readonly lines = $derived.by((): readonly (readonly Vec3[])[] => {
    const seen = this.all.filter(({ visible }) => visible).map(({ points }) => points);
    return this.placing === null ? seen : [...seen, this.placing.points];
  });

  /** Waits for the points of a mark. */
  start(kind: MarkKind): void {
    this.placing = { kind, points: [] };
  }

  cancel(): void {
    this.placing = null;
  }

  /** A point of what is being set; its last one makes the mark. */
  put(point: Vec3): void {
    if (this.placing === null) {
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

  private get key(): string {
    return `marks.${this.scanName}`;
  }
}
