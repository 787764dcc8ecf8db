/** The life of a canvas that is drawn on: its size, its frames, and graphics that are lost and come back. */

interface Drawing {
  /** The size of the canvas on the page has changed. */
  readonly resized: () => void;
  /** Draws a frame; `now` [ms]. */
  readonly frame: (now: number) => void;
  readonly lost: () => void;
  readonly restored: () => void;
}

/** Calls back until the returned function is called. */
export function drawOn(canvas: HTMLCanvasElement, { resized, frame, lost, restored }: Drawing): () => void {
  const observer = new ResizeObserver(resized);
  observer.observe(canvas);
  const lose = (event: Event): void => {
    // the browser gives the graphics back; until then the last picture stays
    event.preventDefault();
    lost();
  };
  canvas.addEventListener("webglcontextlost", lose);
  canvas.addEventListener("webglcontextrestored", restored);
  let running = true;
  const loop = (now: number): void => {
    if (running) {
      frame(now);
      requestAnimationFrame(loop);
    }
  };
  requestAnimationFrame(loop);
  return () => {
    running = false;
    observer.disconnect();
    canvas.removeEventListener("webglcontextlost", lose);
    canvas.removeEventListener("webglcontextrestored", restored);
  };
}
