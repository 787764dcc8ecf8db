/**
 * What of a scan is sent to the GPU, and when; what it looks like there is tested with the picture.
 */
import type * as THREE from "three";
import { expect, test } from "vitest";
import type { Vec3 } from "../../src/core/geometry/vector";
import { frameOf } from "../../src/core/scan/scan_volume";
import { FieldTexture } from "../../src/gl/textures/field_texture";
import { scanOf } from "../support/volumes";

/** Planes that were sent, as from and up to, but without. */
function watched(): { readonly renderer: THREE.WebGLRenderer; readonly sent: [number, number][] } {
  const sent: [number, number][] = [];
  const copyTextureToTexture = (_source: unknown, _texture: unknown, { min, max }: THREE.Box3): void => {
    sent.push([min.z, max.z]);
  };
  return { renderer: { copyTextureToTexture } as unknown as THREE.WebGLRenderer, sent };
}

test("planes that have arrived since are sent again slab by slab, all others once", () => {
  // planes of 2 MiB: four are sent at once
  const frame = frameOf(scanOf([1024, 1024, 10], [1, 1, 1]));
  const volume = { frame, step: 1, dimensions: frame.dimensions, values: new Uint16Array(1024 * 1024 * 10) };
  const field = new FieldTexture(volume, "rg8");
  const { renderer, sent } = watched();
  field.follow(3);
  expect([field.uploadSlab(renderer), field.uploadSlab(renderer)]).toEqual([false, false]);
  expect(field.progress).toBeCloseTo(2 / 3);
  // two more have arrived: the first slab is there, and the second not as it is now
  field.follow(5);
  while (!field.uploadSlab(renderer));
  expect(sent).toEqual([[0, 4], [4, 8], [8, 10], [0, 4], [4, 8]]);
  expect(field.progress).toBe(1);

  field.follow(10);
  while (!field.uploadSlab(renderer));
  expect(sent.slice(5)).toEqual([[4, 8], [8, 10]]);
  expect(field.uploadSlab(renderer)).toBe(true);
  expect(sent.length).toBe(7);
});

test("values that are sent as floats are those of the box, and come to its place", () => {
  const frame = frameOf(scanOf([5, 4, 3], [1, 1, 1]));
  const values = Uint16Array.from({ length: 60 }, (_, i) => i);
  const volume = { frame, step: 1, dimensions: frame.dimensions, values };
  const sent: unknown[] = [];
  const copyTextureToTexture = (source: THREE.Data3DTexture, _: unknown, { min, max }: THREE.Box3, to: Vec3): void => {
    sent.push([[...(source.image.data ?? [])], [...min], [...max], [...to]]);
  };
  const renderer = { copyTextureToTexture } as unknown as THREE.WebGLRenderer;
  new FieldTexture(volume, "r32f").uploadBox(renderer, { low: [1, 2, 1], high: [3, 4, 3] });
  expect(sent).toEqual([[[31, 32, 36, 37, 51, 52, 56, 57], [0, 0, 0], [2, 2, 2], [1, 2, 1]]]);
});
