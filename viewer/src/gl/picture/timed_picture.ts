/**
 * Draws a view once at a size and a step of its own, away from the screen, and tells how long the GPU took:
 * for `palpate bench render`.
 */
import * as THREE from "three";
import { PictureTarget } from "../base/picture_target";
import type { RayMarcher } from "../march/ray_marcher";
import { mostLayers } from "../textures/surface_layers";
import type { Surfaces } from "../surfaces/surfaces";

export interface TimedWish {
  /** Of the picture [pixels]. */
  readonly width: number;
  readonly height: number;
  /** Steps per smallest voxel edge. */
  readonly stepsPerVoxel: number;
}

export interface TimedPicture {
  /** From the first command until a pixel could be read. */
  readonly milliseconds: number;
  /** Linear RGB over black, three numbers a pixel, rows from the bottom. */
  readonly colours: Float32Array;
}

/** Draws what ray caster and surfaces are aimed at; without jitter. */
export function drawTimed(
  renderer: THREE.WebGLRenderer,
  marcher: RayMarcher,
  surfaces: Surfaces,
  wish: TimedWish,
): TimedPicture {
  const { width, height, stepsPerVoxel } = wish;
  const drawn = new PictureTarget(true);
  drawn.resize(width, height);
  drawn.useLevel(1);
  drawn.useRows(0, height);
  const read = (w: number, h: number): Uint16Array => {
    const halves = new Uint16Array(4 * w * h);
    renderer.readRenderTargetPixels(drawn.target, 0, 0, w, h, halves);
    return halves;
  };
  renderer.initRenderTarget(drawn.target);
  read(1, 1);
  const begun = performance.now();
  surfaces.draw(renderer, drawn, { divisor: 1, stepsPerVoxel, shift: [0, 0, 0], depth: mostLayers, detail: "all" });
  marcher.draw(renderer, drawn, { stepsPerVoxel, jitter: false }, [0, 0, 0]);
  read(1, 1);
  const milliseconds = performance.now() - begun;
  const halves = read(width, height);
  drawn.dispose();
  const colours = Float32Array.from({ length: 3 * width * height }, (_, i) =>
    THREE.DataUtils.fromHalfFloat(halves[4 * Math.floor(i / 3) + (i % 3)] ?? 0),
  );
  return { milliseconds, colours };
}
