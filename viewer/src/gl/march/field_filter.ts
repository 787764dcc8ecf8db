/**
 * How exactly the GPU tells what lies between two voxels, measured before a scan is sent to it: no name of a GPU tells
 * that. Bytes are joined to values after they were filtered, so that a GPU that rounds what it filters to bytes is off
 * by up to 128 (Mesa's llvmpipe), and one that computes with half floats by 16.
 *
 * A place between two texels may be rounded to 8 bits, as GPUs do (NVIDIA, "CUDA C++ Programming Guide", linear
 * filtering): that moves what is seen by a 256th of a voxel at most, and is no fault here.
 */
import * as THREE from "three";
import type { Vec3 } from "../../core/geometry/vector";
import { biasedAt } from "../../core/scan/field";
import type { ScanVolume } from "../../core/scan/scan_volume";
import { FullscreenPass } from "../base/fullscreen_pass";
import { shaders } from "../shaders/shaders";
import { FieldTexture, formatDefines, type FieldFormat } from "../textures/field_texture";
import { marchUniforms, standAt } from "./march_uniforms";

/** A format that is farther off is not taken: as much as if values were rounded once more [stored values]. */
export const mostError = 1;

export interface FieldFilter {
  readonly format: FieldFormat;
  /** How far each format that was tried was off at most, in the order in which they were [stored values]. */
  readonly errors: Readonly<Partial<Record<FieldFormat, number>>>;
}

/**
 * Chooses the format in which the GPU tells a scan's values well: the smallest and quickest of those that do.
 *
 * @param renderer of the very context that will draw: another one may have another GPU.
 */
export function chooseFilter(renderer: THREE.WebGLRenderer): FieldFilter {
  const errors: Partial<Record<FieldFormat, number>> = {};
  const has = (name: string): boolean => renderer.extensions.has(name);
  const tried: readonly FieldFormat[] = [
    ...(has("EXT_texture_norm16") ? ["r16" as const] : []),
    "rg8",
    ...(has("OES_texture_float_linear") ? ["r32f" as const] : []),
  ];
  for (const format of tried) {
    const error = filterError(renderer, format);
    errors[format] = error;
    if (error <= mostError) {
      return { format, errors };
    }
  }
  return { format: "texels", errors };
}

/** How far the GPU's values of a small scan are off at most [stored values]; what is due to their place is no fault. */
export function filterError(renderer: THREE.WebGLRenderer, format: FieldFormat): number {
  const places = somePlaces();
  const told = toldAt(renderer, format, places);
  let most = 0;
  for (let i = 0; i < edge * edge; ++i) {
    const grid: Vec3 = [places[4 * i] ?? 0, places[4 * i + 1] ?? 0, places[4 * i + 2] ?? 0];
    const isBetweenPairs = Math.floor(grid[0] - 0.5) % 2 !== 0;
    const allowed = isBetweenPairs ? pairStep * mostAside : 0;
    most = Math.max(most, Math.abs((told[i] ?? NaN) - biasedAt(probe, grid)) - allowed);
  }
  return most;
}

/** Farther aside no place may be seen [voxels]. */
const mostAside = 1 / 256;

/** Places along each edge of the picture that tells of them. */
const edge = 64;

const size: Vec3 = [62, 7, 5];
const pairStep = 2048;

/** Around one carry from the low byte to the high one in each pair of planes, so that each value there needs both. */
const probe: ScanVolume = {
  dimensions: size,
  values: Uint16Array.from({ length: size[0] * size[1] * size[2] }, (_, i) => {
    const [x, y, z] = [i % size[0], Math.floor(i / size[0]) % size[1], Math.floor(i / (size[0] * size[1]))];
    return pairStep * Math.floor(x / 2) + pairStep / 2 + ((5 * x + 3 * y + 7 * z) % 8) - 4;
  }),
  step: 1,
  frame: {
    dimensions: size,
    spacing: [1, 1, 1],
    axes: [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    sceneFromGrid: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0],
    gridFromScene: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0],
    rescale: { slope: 1, intercept: 0 },
  },
};

/** Places of the probe, spread evenly, as texels; their last number means nothing. */
function somePlaces(): Float32Array<ArrayBuffer> {
  // Roberts, "The unreasonable effectiveness of quasirandom sequences" (2018), in three dimensions
  const steps = [0.8191725, 0.6710436, 0.5497005];
  return Float32Array.from({ length: 4 * edge * edge }, (_, i) => {
    const axis = i % 4;
    return ((Math.floor(i / 4) * (steps[axis] ?? 0)) % 1) * (size[axis] ?? 0);
  });
}

/** Values that the GPU tells at these places. */
function toldAt(renderer: THREE.WebGLRenderer, format: FieldFormat, places: Float32Array<ArrayBuffer>): number[] {
  const field = new FieldTexture(probe, format);
  while (!field.uploadSlab(renderer));
  const uniforms = marchUniforms();
  standAt(uniforms, probe);
  uniforms.fieldTexture.value = field.texture;
  const asked = new THREE.DataTexture(places, edge, edge, THREE.RGBAFormat, THREE.FloatType);
  asked.needsUpdate = true;
  const pass = new FullscreenPass(shaders.toldValues, { ...uniforms, places: { value: asked } });
  pass.material.defines = { [formatDefines[format]]: "" };
  const target = new THREE.WebGLRenderTarget(edge, edge, { depthBuffer: false });
  pass.draw(renderer, target);
  const bytes = new Uint8Array(4 * edge * edge);
  renderer.readRenderTargetPixels(target, 0, 0, edge, edge, bytes);
  renderer.setRenderTarget(null);
  for (const thing of [field, asked, pass, target]) {
    thing.dispose();
  }
  return Array.from({ length: edge * edge }, (_, i) => {
    const [high = 0, low = 0, parts = 0] = bytes.subarray(4 * i, 4 * i + 3);
    return 256 * high + low + parts / 256;
  });
}
