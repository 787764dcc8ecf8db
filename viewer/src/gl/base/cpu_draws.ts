/**
 * Whether the CPU draws what WebGL is asked to. Most browsers name what draws; some keep that, WebKit for one, whose
 * "Apple GPU" is a program on Linux: there a small picture is timed.
 */

/** Programs that draw on a CPU. */
const programs = /swiftshader|llvmpipe|softpipe|software|basic render/i;
/** What stands where a browser keeps the name. */
const kept = /^$|^apple gpu$|^webkit webgl$|^mozilla$|generic renderer/i;

/** Edge of the picture, and how often each pixel reads the texture. */
const [edge, reads] = [128, 128] as const;
/** Edge of the texture [texels]. */
const texels = 32;
const runs = 3;
/**
 * Between two million filtered reads on a CPU and on a GPU [ms]: two cores take 40 and more, a GPU of a phone less than
 * five. Many cores that are as quick are as good.
 */
const slowest = 15;

const vertex = `#version 300 es
void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}`;

const fragment = `#version 300 es
precision highp float;
precision highp sampler3D;
uniform sampler3D field;
out vec4 colour;
void main() {
  vec3 place = vec3(gl_FragCoord.xy / ${edge.toFixed(1)}, 0.0);
  for (int i = 0; i < ${String(reads)}; i++) {
    // each read waits for the one before
    place = fract(place + vec3(0.013, 0.007, 0.031) + 0.01 * texture(field, place).rrr);
  }
  colour = vec4(place, 1.0);
}`;

/**
 * @param renderer its name, as WebGL tells it.
 * @param time how long it takes to draw the small picture [ms], where the name tells nothing.
 */
export function cpuDraws(renderer: string, time: () => number): boolean {
  return programs.test(renderer) || (kept.test(renderer) && time() > slowest);
}

/** Draws a picture of many reads; the shortest of several times [ms], 0 where the shader is refused. */
export function timeToDraw(gl: WebGL2RenderingContext): number {
  const program = gl.createProgram();
  for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]] as const) {
    const shader = gl.createShader(type);
    if (shader === null) {
      return 0;
    }
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  gl.bindTexture(gl.TEXTURE_3D, gl.createTexture());
  gl.texImage3D(gl.TEXTURE_3D, 0, gl.R8, texels, texels, texels, 0, gl.RED, gl.UNSIGNED_BYTE, null);
  for (const side of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) {
    gl.texParameteri(gl.TEXTURE_3D, side, gl.LINEAR);
  }
  gl.canvas.width = gl.canvas.height = edge;
  gl.viewport(0, 0, edge, edge);
  gl.useProgram(program);
  const pixel = new Uint8Array(4);
  const times = Array.from({ length: runs }, () => {
    const began = performance.now();
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    // what is read has been drawn
    gl.readPixels(edge / 2, edge / 2, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    return performance.now() - began;
  });
  return Math.min(...times);
}
