/**
 * A copy of the last picture that was as fine as it gets: a canvas whose graphics are lost shows nothing any more.
 */
export class LastPicture {
  private readonly copy = document.createElement("canvas");
  private isFinished = false;

  /** Keeps what stands on a canvas once it is finished; to be called in the frame that has drawn it. */
  keep(canvas: HTMLCanvasElement, finished: boolean): void {
    if (finished && !this.isFinished) {
      copy(canvas, this.copy);
    }
    this.isFinished = finished;
  }

  /** Draws it into a canvas of any size. */
  draw(canvas: HTMLCanvasElement): void {
    copy(this.copy, canvas);
  }
}

function copy(from: HTMLCanvasElement, to: HTMLCanvasElement): void {
  to.width = from.width;
  to.height = from.height;
  to.getContext("2d")?.drawImage(from, 0, 0);
}
