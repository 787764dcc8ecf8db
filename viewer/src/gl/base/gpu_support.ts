/**
 * What the browser's WebGL2 can do, found out on a canvas of its own and let go again.
 */
import { cpuDraws, timeToDraw } from "./cpu_draws";

export interface GpuSupport {
  /** Name of the renderer, "" where the browser keeps it. */
  readonly renderer: string;
  /** Drawn by the CPU: everything works, at lower quality while moving. */
  readonly software: boolean;
  /** Largest edge of a 3-D texture [texels]. */
  readonly largestEdge: number;
  /** Rendering into half-float textures. */
  readonly halfFloatTarget: boolean;
}

/** Returns what WebGL2 offers; null where there is none. */
export function gpuSupport(): GpuSupport | null {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (gl === null) {
    return null;
  }
  const information = gl.getExtension("WEBGL_debug_renderer_info");
  const renderer = String(gl.getParameter(information?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER) ?? "");
  const support: GpuSupport = {
    renderer,
    software: cpuDraws(renderer, () => timeToDraw(gl)),
    largestEdge: Number(gl.getParameter(gl.MAX_3D_TEXTURE_SIZE)),
    halfFloatTarget:
      gl.getExtension("EXT_color_buffer_float") !== null || gl.getExtension("EXT_color_buffer_half_float") !== null,
  };
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return support;
}
