/**
 * Marks in a person's hand: they are set point by point, dragged, named and taken back. Every change
 * is one step of the page's own history; marks are remembered with the scan and go into its scene.
 */
import { advance, back, begin, forth, type History } from "../core/history";
import {
  changedMark,
  pointsOf,
  saneMarks,
  withMark,
  withoutMark,
  withPointAt,
  type Mark,
  type MarkKind,
} from "../core/measure";
import type { Scan } from "../core/protocol";
import type { Vec3 } from "../core/vector";
import type { PageSteps } from "./page_steps.svelte";
import { recall, remember } from "./remembered";

export class MarkControl {
  /** What is being set, with the points that it has by now. */
  placing = $state.raw<{ readonly kind: MarkKind; readonly points: readonly Vec3[] } | null>(null);

  private history = $state.raw<History<readonly Mark[]>>(begin([]));
  private scanName = "";
  /** Marks as they were before a drag began: a drag is one step. */
  private dragged: readonly Mark[] | null = null;

  constructor(private readonly steps: PageSteps) {}

  /** Takes up a scan with the marks that were set on it. */
  open(scan: Scan): void {
    this.scanName = scan.name;
    this.placing = null;
    this.dragged = null;
    this.history = begin(saneMarks(recall<{ list: unknown }>(this.key, { list: [] }).list));
  }

  get all(): readonly Mark[] {
    return this.history.now;
  }

  /** Points of each mark that is seen, and of what is being set. */
  readonly lines = $derived.by((): readonly (readonly Vec3[])[] => {
    const seen = this.history.now.filter(({ visible }) => visible).map(({ points }) => points);
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
    this.step(withMark(this.all, kind, points));
  }

  /** Has a point of a mark stand elsewhere while it is dragged. */
  drag(id: number, index: number, point: Vec3): void {
    this.dragged ??= this.all;
    this.history = { ...this.history, now: withPointAt(this.all, id, index, point) };
  }

  /** Ends a drag: what it changed becomes one step. */
  drop(): void {
    if (this.dragged !== null) {
      const next = this.all;
      this.history = { ...this.history, now: this.dragged };
      this.dragged = null;
      this.step(next);
    }
  }

  rename(id: number, name: string): void {
    this.step(changedMark(this.all, id, { name }));
  }

  show(id: number, visible: boolean): void {
    this.step(changedMark(this.all, id, { visible }));
  }

  remove(id: number): void {
    this.step(withoutMark(this.all, id));
  }

  removeAll(): void {
    this.step([]);
  }

  undo(): void {
    this.take(back(this.history));
  }

  redo(): void {
    this.take(forth(this.history));
  }

  private step(next: readonly Mark[]): void {
    if (JSON.stringify(next) !== JSON.stringify(this.all)) {
      this.take(advance(this.history, next));
      this.steps.add(this);
    }
  }

  private take(history: History<readonly Mark[]>): void {
    this.dragged = null;
    this.history = history;
    remember(this.key, { list: history.now });
  }

  private get key(): string {
    return `marks.${this.scanName}`;
  }
}
