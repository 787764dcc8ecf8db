/**
 * Which marks something stands before. Lines are tested by the picture, pixel by pixel; labels as a whole, once the
 * view rests.
 */
import type { Vec3 } from "../../../core/geometry/vector";
import type { MarkControl } from "./mark_control.svelte";

export class MarkVisibility {
  /** Marks of which no point is seen. */
  hidden = $state.raw<readonly number[]>([]);
  private rested = false;
  private lines: MarkControl["lines"] | null = null;

  /** @param hides whether something stands before a point of the scene. */
  constructor(
    private readonly marks: MarkControl,
    private readonly hides: (point: Vec3) => boolean,
  ) {}

  /** Looks again where the picture has come to rest, or marks have moved since. */
  follow(rests: boolean): void {
    const { all, lines } = this.marks;
    if (rests && (!this.rested || lines !== this.lines)) {
      this.lines = lines;
      this.hidden = all.filter(({ points, visible }) => visible && points.every(this.hides)).map(({ id }) => id);
    }
    this.rested = rests;
  }
}
