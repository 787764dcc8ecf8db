/**
 * A copy of the last picture that was as fine as it gets: a canvas whose graphics are lost shows nothing any more, and
 * one that was not drawn in this frame has nothing to be printed.
 */
export class LastPicture {
  private readonly copy = document.createElement("canvas");
  private kept: unknown = null;

  /**
   * Keeps what stands on a canvas; to be called in the frame that has drawn it.
   *
   * @param shown what is shown there, compared by identity; null while that is not finished.
   */
  keep(canvas: HTMLCanvasElement, shown: unknown): void {
    if (shown !== null && shown !== this.kept) {
      copy(canvas, this.copy);
    }
    this.kept = shown;
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
