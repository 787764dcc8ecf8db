/**
 * A cut along a painted line: from the wish to cut a segment, through the line that is painted and
 * what the engine says of its parts, to the cut.
 */
import { vantage, type Camera, type Viewport } from "../../../core/geometry/camera";
import { freehandLine, underLine, type Place } from "../../../core/segments/cut_line";
import type { CutPreview, Segment } from "../../../core/protocol";
import { scale, type Vec3 } from "../../../core/geometry/vector";
import type { Session } from "../../state/session.svelte";

/** A line that was painted, as points of the scene under it and the eye that saw it. */
export interface SeenLine {
  readonly points: readonly Vec3[];
  readonly eye: Vec3;
  /** How far away it seemed [mm]. */
  readonly reach: number;
  readonly view: Vec3;
  readonly closed: boolean;
}

export class CutControl {
  /** The segment that is to be cut; null where none is. */
  id = $state.raw<number | null>(null);
  /** What is being painted [CSS pixels of the picture]. */
  painting = $state.raw<readonly Place[] | null>(null);
  /** What was painted. */
  line = $state.raw<SeenLine | null>(null);

  constructor(private readonly session: Session) {}

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
    this.id = id;
  }

  cancel(): void {
    this.id = null;
    this.painting = null;
    this.forget();
  }

  begin(place: Place): void {
    this.forget();
    this.painting = [place];
  }

  paint(place: Place): void {
    if (this.painting !== null) {
      this.painting = [...this.painting, place];
    }
  }

  /** The line is whole: the engine is asked what it would part. */
  finish(camera: Camera, viewport: Viewport): void {
    const painted = this.painting === null ? null : freehandLine(this.painting);
    this.painting = null;
    if (painted === null || this.id === null) {
      return;
    }
    this.line = {
      points: underLine(painted.places, camera, viewport),
      eye: vantage(camera),
      reach: camera.distance,
      view: scale(camera.back, -1),
      closed: painted.closed,
    };
    this.send(true);
  }

  /** Cuts along the line. */
  cut(): void {
    if (this.ready) {
      this.send(false);
      this.cancel();
    }
  }

  private forget(): void {
    this.line = null;
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
