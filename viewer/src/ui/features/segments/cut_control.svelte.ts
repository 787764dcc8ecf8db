/**
 * A cut along a painted line: from the wish to cut a segment, through the line that is painted and
 * what the engine says of its parts, to the cut.
 */
import type { CutPreview, Segment } from "../../../core/protocol";
import type { Session } from "../../state/session.svelte";
import { PaintedLine } from "./painted_line.svelte";

export class CutControl extends PaintedLine {
  /** The segment that is to be cut; null where none is. */
  id = $state.raw<number | null>(null);

  /** @param begins ends what else waits for a line. */
  constructor(
    private readonly session: Session,
    private readonly begins: () => void,
  ) {
    super();
  }

  get armed(): boolean {
    return this.segment !== null;
  }

  /** The segment that is to be cut, as long as it is there. */
  get segment(): Segment | null {
    return this.session.segments.find(({ id }) => id === this.id) ?? null;
  }

  /** What the engine says of the line's parts; null before it has. */
  get parts(): CutPreview | null {
    const { cutPreview } = this.session;
    return this.line !== null && cutPreview?.id === this.id ? cutPreview : null;
  }

  /** Whether there is a line that parts the segment. */
  get ready(): boolean {
    return this.parts !== null && this.parts.smaller_ml !== null;
  }

  /** Waits for a line over a segment. */
  start(id: number): void {
    this.cancel();
    this.begins();
    this.id = id;
  }

  cancel(): void {
    this.id = null;
    this.painting = null;
    this.forget();
  }

  /** Cuts along the line. */
  cut(): void {
    if (this.ready) {
      this.send(false);
      this.cancel();
    }
  }

  protected override ask(): void {
    this.send(true);
  }

  protected override forget(): void {
    super.forget();
    this.session.cutPreview = null;
  }

  private send(preview: boolean): void {
    const { id, line } = this;
    if (id !== null && line !== null) {
      const { points, eye, view, closed } = line;
      this.session.send({ type: "cut_along", id, line: points, eye, view, closed, preview });
    }
  }
}
