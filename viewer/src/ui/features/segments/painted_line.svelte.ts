/**
 * A line that a person paints over the 3-D view, and what is asked of the engine about it then.
 */
import { vantage, type Camera, type Viewport } from "../../../core/geometry/camera";
import { freehandLine, underLine, type FreehandLine, type Place } from "../../../core/segments/cut_line";
import { scale, type Vec3 } from "../../../core/geometry/vector";

/** A line that was painted, as points of the scene under it and the eye that saw it. */
export interface SeenLine {
  readonly points: readonly Vec3[];
  readonly eye: Vec3;
  /** How far away it seemed [mm]. */
  readonly reach: number;
  readonly view: Vec3;
  readonly closed: boolean;
}

export abstract class PaintedLine {
  /** What is being painted [CSS pixels of the picture]. */
  painting = $state.raw<readonly Place[] | null>(null);
  /** What was painted. */
  line = $state.raw<SeenLine | null>(null);

  /** Whether the left button paints. */
  abstract get armed(): boolean;

  begin(place: Place): void {
    this.forget();
    this.painting = [place];
  }

  paint(place: Place): void {
    if (this.painting !== null) {
      this.painting = [...this.painting, place];
    }
  }

  /** The line is whole: the engine is asked what it would do. */
  finish(camera: Camera, viewport: Viewport): void {
    const painted = this.painting === null ? null : this.taken(freehandLine(this.painting));
    this.painting = null;
    if (painted === null || !this.armed) {
      return;
    }
    this.line = {
      points: underLine(painted.places, camera, viewport),
      eye: vantage(camera),
      reach: camera.distance,
      view: scale(camera.back, -1),
      closed: painted.closed,
    };
    this.ask();
  }

  /** The painted line as it is used; null where it cannot be. */
  protected taken(painted: FreehandLine | null): FreehandLine | null {
    return painted;
  }

  /** Asks what the line would do. */
  protected abstract ask(): void;

  protected forget(): void {
    this.line = null;
  }
}

/** The line that the left button paints now; null where it paints none. */
export function armedLine(lines: {
  readonly cutting: PaintedLine;
  readonly scissors: PaintedLine;
}): PaintedLine | null {
  return [lines.cutting, lines.scissors].find(({ armed }) => armed) ?? null;
}
