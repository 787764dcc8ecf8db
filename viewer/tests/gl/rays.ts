/** The rays of a small picture's pixels, for what a model says of each. */
import { transformPoint, transformVector } from "../../src/core/geometry/affine";
import { rayThrough } from "../../src/core/geometry/camera";
import { throughBox } from "../../src/core/picking/pick_surface";
import type { ScanFrame } from "../../src/core/scan/scan_volume";
import type { Vec3 } from "../../src/core/geometry/vector";
import type { MarchResult } from "./scenes_page";

/** Pixels along each side of the picture. */
export const edge = 96;

/** Rays of all pixels, rows from the bottom: where they are inside the scan [mm], in its grid. */
export function raysOf(
  { camera }: MarchResult,
  frame: ScanFrame,
): { origin: Vec3; direction: Vec3; span: readonly [number, number] | null }[] {
  return Array.from({ length: edge * edge }, (_, i) => {
    const [x, y] = [i % edge, edge - 1 - Math.floor(i / edge)];
    const ray = rayThrough(camera, x + 0.5, y + 0.5, { width: edge, height: edge });
    const origin = transformPoint(frame.gridFromScene, ray.origin);
    const direction = transformVector(frame.gridFromScene, ray.direction);
    return { origin, direction, span: throughBox(origin, direction, frame.dimensions) };
  });
}

export function channel({ pixels }: MarchResult, c: number): number[] {
  return pixels.filter((_, i) => i % 4 === c);
}

/** Light of an uncovered surface: the same as in `light.glsl`, written again. */
export function litSurface(colour: Vec3, normal: Vec3, toEye: Vec3, up: Vec3, key: Vec3): Vec3 {
  const along = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const half: Vec3 = [key[0] + toEye[0], key[1] + toEye[1], key[2] + toEye[2]];
  const sky = 0.5 + 0.5 * along(normal, up);
  const lambert = Math.max(0, along(normal, key));
  const shine = 0.16 * Math.max(0, along(normal, half) / Math.hypot(...half)) ** 28;
  const facing = Math.max(0, along(normal, toEye));
  const of = (c: 0 | 1 | 2, ground: number, above: number, direct: number): number =>
    colour[c] * (ground + (above - ground) * sky + direct * 0.82 * lambert + 0.04 * (1 - facing)) + shine;
  return [of(0, 0.14, 0.36, 1.06), of(1, 0.11, 0.38, 1.0), of(2, 0.1, 0.42, 0.92)];
}
