/**
 * Small textures that the ray caster looks things up in: the transfer function, how far
 * empty space reaches, and the segments' ids with their colours.
 */
import * as THREE from "three";
import { linearFromSrgb } from "../../core/base/colour";
import type { Segment } from "../../core/protocol";
import {
  bodyOpacity,
  drawnFromVoxels,
  shownByValue,
  surfaceInPlace,
  type InsideMode,
  type InsideModes,
} from "../../core/segments/shown_segments";
import { bakeTransferFunction, integrateRow, type TransferFunction } from "../../core/appearance/transfer_function";
import type { Vec3 } from "../../core/geometry/vector";

/** The transfer function as rows: linear colour with extinction [1/mm], and their running integrals. */
export interface TransferTextures {
  readonly values: THREE.DataTexture;
  readonly integrals: THREE.DataTexture;
  /** What is integrated, at the row's first and at its last texel: colour times extinction, and extinction. */
  readonly ends: readonly [THREE.Vector4, THREE.Vector4];
}

export function transferTextures(transferFunction: TransferFunction): TransferTextures {
  const row = bakeTransferFunction(transferFunction);
  const size = row.length / 4;
  const halves = Uint16Array.from(row, (value) => THREE.DataUtils.toHalfFloat(value));
  const values = new THREE.DataTexture(halves, size, 1, THREE.RGBAFormat, THREE.HalfFloatType);
  values.minFilter = THREE.LinearFilter;
  values.magFilter = THREE.LinearFilter;
  values.needsUpdate = true;
  // differences of sums need all of 32 bits; the shader interpolates itself
  const integrals = new THREE.DataTexture(integrateRow(row), size, 1, THREE.RGBAFormat, THREE.FloatType);
  integrals.needsUpdate = true;
  return { values, integrals, ends: [weightedTexel(row, 0), weightedTexel(row, size - 1)] };
}

function weightedTexel(row: Float32Array, texel: number): THREE.Vector4 {
  const [red = 0, green = 0, blue = 0, extinction = 0] = row.subarray(4 * texel, 4 * texel + 4);
  return new THREE.Vector4(red * extinction, green * extinction, blue * extinction, extinction);
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

const alphaOf: Readonly<Record<InsideMode, number>> = { solid: 1, tinted: 0.75, plain: 0 };

/**
 * Linear colour by segment id; alpha 1 where its voxels are `drawn` as a body, 0.75 as tissue in its colour, 0.3 where
 * its surface stands for them, and up to 0.55 by how opaque that is, 0 where its values tell where it is. A second row
 * has its factors on ambient and specular light, and the opacity of the body that can stand for its surface where
 * labels tell of that.
 */
export function labelColours(
  segments: readonly Segment[],
  drawn: (segment: Segment) => boolean = drawnFromVoxels,
  modes: InsideModes = {},
): THREE.DataTexture {
  const rows = new Float32Array(2 * 4 * 256);
  const byValue = new Set(shownByValue(segments).map(({ id }) => id));
  for (const segment of segments) {
    const mode = modes[segment.id] ?? "solid";
    const told = drawn(segment) ? alphaOf[mode] : leftOut(segment);
    const [alpha, body] = byValue.has(segment.id) ? [0, 0] : [told, bodyOpacity(segment, mode)];
    rows.set([...linearFromSrgb(segment.colour), alpha], 4 * segment.id);
    rows.set([segment.ambient, segment.specular, body], 4 * (256 + segment.id));
  }
  const texture = new THREE.DataTexture(rows, 256, 2, THREE.RGBAFormat, THREE.FloatType);
  texture.needsUpdate = true;
  return texture;
}

/** Alpha of a segment whose voxels are not drawn. */
function leftOut(segment: Segment): number {
  return segment.visible ? 0.3 + 0.25 * surfaceInPlace(segment) : 0;
}
