/**
 * Marks in a person's hand: they are set point by point, dragged, named and taken back. Every change
 * is one step of the page's own history; marks are remembered with the scan and go into its scene.
 */
import { areaBetween, isArea, type AreaAxes } from "../../../core/marks/area";
import {
  changedMark,
  lineOf,
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
  /** The first corner of an area that is being set, and along what it is set. */
  private corner: { readonly point: Vec3; readonly axes: AreaAxes } | null = null;

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
    this.cancel();
    this.state.open(saneMarks(recall<{ list: unknown }>(this.key, { list: [] }).list));
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

  private get key(): string {
    return `marks.${this.scanName}`;
  }
}
