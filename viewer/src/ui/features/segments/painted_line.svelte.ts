/**
 * A line that a person paints over the 3-D view, and what is asked of the engine about it then.
 */
import { vantage, type Camera, type Viewport } from "../../../core/geometry/camera";
import { freehandLine, underLine, type FreehandLine, type Place } from "../../../core/segments/cut_line";
import type { CutSheet, SeenLine } from "../../../core/segments/cut_sheet";
import { scale } from "../../../core/geometry/vector";

export abstract class PaintedLine {
  /** What is being painted [CSS pixels of the picture]. */
  painting = $state.raw<readonly Place[] | null>(null);
  /** What was painted. */
  line = $state.raw<SeenLine | null>(null);

  /** Whether a line is waited for, or shown. */
  abstract get armed(): boolean;

  /** Whether the left button paints. */
  get paints(): boolean {
    return this.armed;
  }

  /** The surface that would be cut along; null where none is to be shown. */
  get sheet(): CutSheet | null {
    return null;
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

  /** The line is whole: the engine is asked what it would do. */
  finish(camera: Camera, viewport: Viewport): void {
    const painted = this.painting === null ? null : this.taken(freehandLine(this.painting));
    this.painting = null;
    if (painted === null || !this.armed) {
      return;
    }
    this.see({ points: underLine(painted.places, camera, viewport), closed: painted.closed }, camera);
  }

  /** Takes a line as the eye sees it. */
  protected see({ points, closed }: Pick<SeenLine, "points" | "closed">, camera: Camera): void {
    this.line = { points, eye: vantage(camera), view: scale(camera.back, -1), closed };
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

interface Lines {
  readonly cutting: PaintedLine;
  readonly scissors: PaintedLine;
}

/** The line that is waited for or shown; null where there is none. */
export function armedLine({ cutting, scissors }: Lines): PaintedLine | null {
  return [cutting, scissors].find(({ armed }) => armed) ?? null;
}

/** The line that the left button paints now; null where it paints none. */
export function paintedLine({ cutting, scissors }: Lines): PaintedLine | null {
  return [cutting, scissors].find(({ paints }) => paints) ?? null;
}
