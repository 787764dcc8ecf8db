/**
 * Small textures that the ray caster looks things up in: the transfer function, how far
 * empty space reaches, and the segments' ids with their colours.
 */
import * as THREE from "three";
import { linearFromSrgb } from "../core/colour";
import type { Segment } from "../core/protocol";
import { drawnFromVoxels, shownByValue } from "../core/shown_segments";
import { bakeTransferFunction, type TransferFunction } from "../core/transfer_function";
import type { Vec3 } from "../core/vector";

/** The transfer function as a row of half floats: linear colour, extinction [1/mm]. */
export function transferTexture(transferFunction: TransferFunction): THREE.DataTexture {
  const row = bakeTransferFunction(transferFunction);
  const halves = Uint16Array.from(row, (value) => THREE.DataUtils.toHalfFloat(value));
  const texture = new THREE.DataTexture(halves, row.length / 4, 1, THREE.RGBAFormat, THREE.HalfFloatType);
  texture.minFilter = THREE.LinearFilter;
  texture.magFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

/** One byte per cell of a 3-D grid, read without filtering. */
export function byteTexture(bytes: Uint8Array, dimensions: Vec3): THREE.Data3DTexture {
  const texture = new THREE.Data3DTexture(bytes as Uint8Array<ArrayBuffer>, ...dimensions);
  texture.format = THREE.RedFormat;
  texture.type = THREE.UnsignedByteType;
  texture.minFilter = THREE.NearestFilter;
  texture.magFilter = THREE.NearestFilter;
  texture.unpackAlignment = 1;
  texture.needsUpdate = true;
  return texture;
}

/**
 * Linear colour by segment id; alpha 1 where its voxels are `drawn`, 0.5 where its surface stands for
 * them, 0 where its values tell where it is.
 */
export function labelColours(
  segments: readonly Segment[],
  drawn: (segment: Segment) => boolean = drawnFromVoxels,
): THREE.DataTexture {
  const row = new Float32Array(4 * 256);
  const byValue = new Set(shownByValue(segments).map(({ id }) => id));
  for (const segment of segments) {
    const alpha = byValue.has(segment.id) ? 0 : drawn(segment) ? 1 : segment.visible ? 0.5 : 0;
    row.set([...linearFromSrgb(segment.colour), alpha], 4 * segment.id);
  }
  const texture = new THREE.DataTexture(row, 256, 1, THREE.RGBAFormat, THREE.FloatType);
  texture.needsUpdate = true;
  return texture;
}
