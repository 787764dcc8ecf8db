/**
 * A copy of the last picture that was as fine as it gets: a canvas whose graphics are lost shows nothing any more.
 */
export class LastPicture {
  private readonly copy = document.createElement("canvas");
  private kept: unknown = null;

  /** Whether it is a copy of this drawing, by identity. */
  isOf(drawing: unknown): boolean {
    return drawing === this.kept;
  }

  /** Keeps a drawing that stands on a canvas. */
  keep(canvas: HTMLCanvasElement, drawing: unknown): void {
    copy(canvas, this.copy);
    this.kept = drawing;
  }

  /** Draws it into a canvas, which gets its size. */
  draw(canvas: HTMLCanvasElement): void {
    copy(this.copy, canvas);
  }
}

function copy(from: HTMLCanvasElement, to: HTMLCanvasElement): void {
  to.width = from.width;
  to.height = from.height;
  if (from.width > 0) {
    to.getContext("2d")?.drawImage(from, 0, 0);
  }
}
