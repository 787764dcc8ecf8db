/** Runs in the browser: the picture by which software GL is told from a GPU. */
import { timeToDraw } from "../../src/gl/base/cpu_draws";

export interface Timed {
  readonly milliseconds: number;
  readonly error: number;
  /** In its middle. */
  readonly pixel: readonly number[];
}

export function timed(): Timed {
  const gl = document.createElement("canvas").getContext("webgl2", { preserveDrawingBuffer: true });
  if (gl === null) {
    throw new Error("no WebGL2");
  }
  const milliseconds = timeToDraw(gl);
  const pixel = new Uint8Array(4);
  gl.readPixels(gl.drawingBufferWidth / 2, gl.drawingBufferHeight / 2, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
  return { milliseconds, error: gl.getError(), pixel: Array.from(pixel) };
}
