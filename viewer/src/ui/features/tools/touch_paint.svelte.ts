/**
 * Painting by touch: the segment that is painted with, which is that of the brush in slices, and how.
 * Lengths [mm].
 */
import { canBePainted } from "../../../core/segments/brush";
import { changedProperties } from "../../../core/segments/segment_appearance";
import { fittingDepth, segmentsOf, type Works } from "../../../core/tools/tools";
import type { Vec3 } from "../../../core/geometry/vector";
import type { BrushControl } from "../segments/brush_control.svelte";
import { recall, remember } from "../../state/remembered";
import type { Session } from "../../state/session.svelte";

interface PaintHabits {
  /** Only a layer below the surface that the probe can reach. */
  readonly surface: boolean;
  readonly depth: number;
  /** Painted voxels stay in the segments that have them. */
  readonly overlaps: boolean;
}

const usual: PaintHabits = { surface: true, depth: 2, overlaps: false };

export class TouchPaint {
  habits = $state.raw<PaintHabits>(recall("touch_paint", usual));
  /** Told of changes, so that the engine can be. */
  private readonly listeners: (() => void)[] = [];

  constructor(
    private readonly session: Session,
    readonly brush: BrushControl,
  ) {}

  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }

  change(part: Partial<PaintHabits>): void {
    this.habits = { ...this.habits, ...part };
    remember("touch_paint", this.habits);
    for (const listener of this.listeners) listener();
  }

  depthIn(spacing: Vec3): number {
    return fittingDepth(spacing, this.habits.depth);
  }

  /** What is sent to the engine beside the segments: how deep, and whether they may overlap. */
  get how(): { readonly depth: number | null; readonly overlaps: boolean } {
    const { surface, overlaps } = this.habits;
    const spacing = this.session.scan?.spacing;
    return { depth: surface && spacing !== undefined ? this.depthIn(spacing) : null, overlaps };
  }

  /** Whether there is a segment to paint with. */
  get ready(): boolean {
    return this.brush.hasChosen;
  }

  /** Asks for a new segment to paint with, where none was ever chosen; whether there is one now. */
  prepare(): boolean {
    if (!this.ready && !this.brush.awaits) {
      this.brush.add();
    }
    return this.ready;
  }

  /** The segment to paint with and those that are painted; none before it is there, or without others. */
  worked(works: Works): readonly number[] {
    const { segment } = this.brush;
    if (segment === null || !this.ready) {
      return [];
    }
    const others = segmentsOf("painter", works, this.session.segments.filter(canBePainted), 0);
    const painted = others.filter((id) => id !== segment.id);
    return painted.length === 0 ? [] : [segment.id, ...painted];
  }

  /** Has the probe feel what is painted, so that it does not sink in where it paints. */
  makeTouchable(): void {
    const { segment } = this.brush;
    if (segment !== null && !segment.felt && !this.habits.overlaps) {
      this.session.send(changedProperties(segment, { touchable: true, visible: true }));
      this.session.notify("info", `${segment.name} can be touched now: else the probe would sink in where it paints.`);
    }
  }
}
