/**
 * Runs in the browser: what shaders read of a scan that holds each of the 65 536 stored values once.
 */
import * as THREE from "three";
import { FieldTexture, type FieldFormat } from "../../src/gl/textures/field_texture";
import { FullscreenPass } from "../../src/gl/base/fullscreen_pass";
import { chooseFilter, filterError, type FieldFilter } from "../../src/gl/march/field_filter";
import { RayMarcher } from "../../src/gl/march/ray_marcher";
import displaced from "../../src/gl/shaders/scan/displacements.glsl?raw";
import field from "../../src/gl/shaders/scan/field.glsl?raw";
import { scanOf, volumeOf } from "../support/volumes";

const edge = 256;

const reader = `precision highp float;
precision highp sampler3D;
${displaced}
${field}
uniform vec3 aside;
layout(location = 0) out vec4 value;
void main() {
  value = vec4(biasedAt(vec3(gl_FragCoord.xy, 0.5) + aside));
}`;

export interface Reading {
  readonly format: FieldFormat;
  /** Away from the middles of the voxels along x [voxels]. */
  readonly aside: number;
}

/** Biased values as `field.glsl` reads them, x fastest; value x + 256 y stands in voxel (x, y). */
export function reading({ format, aside }: Reading): number[] {
  const renderer = new THREE.WebGLRenderer({ canvas: document.createElement("canvas") });
  renderer.autoClear = false;
  const volume = volumeOf(scanOf([edge, edge, 1], [1, 1, 1]), ([x, y]) => Math.floor(x) + edge * Math.floor(y) - 32768);
  const texture = new FieldTexture(volume, format);
  // as edits are sent, box by box
  texture.uploadBox(renderer, { low: [0, 0, 0], high: [100, edge, 1] });
  texture.uploadBox(renderer, { low: [100, 0, 0], high: [edge, edge, 1] });
  const marcher = new RayMarcher();
  marcher.setField(texture, volume.bricks);
  const pass = new FullscreenPass(reader, {
    ...marcher.fieldUniforms,
    aside: { value: new THREE.Vector3(aside, 0, 0) },
  });
  pass.material.defines = { ...marcher.fieldDefines };
  const target = new THREE.WebGLRenderTarget(edge, edge, { type: THREE.FloatType, depthBuffer: false });
  pass.draw(renderer, target);
  const texels = new Float32Array(4 * edge * edge);
  renderer.readRenderTargetPixels(target, 0, 0, edge, edge, texels);
  const error = renderer.getContext().getError();
  renderer.dispose();
  renderer.forceContextLoss();
  if (error !== 0) {
    throw new Error(`the GPU refused ${format} with ${String(error)}`);
  }
  return Array.from({ length: edge * edge }, (_, i) => texels[4 * i] ?? NaN);
}

/** How the page has this GPU filter a scan, as if it had none of these extensions. */
export function usualFilter(without: readonly string[]): FieldFilter {
  return onRenderer((renderer) => {
    const has = renderer.extensions.has.bind(renderer.extensions);
    renderer.extensions.has = (name) => !without.includes(name) && has(name);
    return chooseFilter(renderer);
  });
}

/** How far a format is off on this GPU [stored values]. */
export function errorOf(format: FieldFormat): number {
  return onRenderer((renderer) => filterError(renderer, format));
}

function onRenderer<T>(work: (renderer: THREE.WebGLRenderer) => T): T {
  const renderer = new THREE.WebGLRenderer({ canvas: document.createElement("canvas") });
  renderer.autoClear = false;
  const done = work(renderer);
  renderer.dispose();
  renderer.forceContextLoss();
  return done;
}
