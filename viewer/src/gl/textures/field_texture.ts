/**
 * The scan's values on the GPU, uploaded slab by slab so that no frame waits for all of it, and again where
 * they have arrived since.
 *
 * R16 where the GPU has it; else RG8, the same bytes as two texels of 8 bits, which the
 * shader joins; R32F (twice the memory) where it is asked for. Keep the formats in sync with
 * `shaders/scan/field.glsl`.
 */
import * as THREE from "three";
import type { ScanVolume } from "../../core/scan/scan_volume";
import { forEachCell, type Box } from "../../core/scan/voxel_change";
import type { GpuSupport } from "../base/gpu_support";

export type FieldFormat = "r16" | "rg8" | "r32f";

/** The format that is exact and small on this GPU. */
export function fieldFormatFor(support: GpuSupport): FieldFormat {
  return support.norm16 ? "r16" : "rg8";
}

/** Bytes sent to the GPU at once. */
const slabBytes = 8 * 2 ** 20;

export class FieldTexture {
  readonly texture: THREE.Data3DTexture;
  private readonly source: THREE.Data3DTexture;
  private readonly slabPlanes: number;
  /** Slabs that are still to be sent. */
  private readonly waiting: Set<number>;
  /** Planes, from the first on, that were told to be there. */
  private arrived = 0;

  constructor(
    readonly volume: ScanVolume,
    readonly format: FieldFormat,
  ) {
    this.source = textureOf(volume, format, texelsOf(volume.values, format));
    this.texture = textureOf(volume, format, null);
    // allocated without a copy on the CPU; filled by `uploadSlab`
    this.texture.source.dataReady = false;
    this.texture.needsUpdate = true;
    const planeBytes = volume.dimensions[0] * volume.dimensions[1] * (format === "r32f" ? 4 : 2);
    this.slabPlanes = Math.max(1, Math.floor(slabBytes / planeBytes));
    this.waiting = new Set(Array(this.slabs).keys());
  }

  /** Share of the scan that is on the GPU as it is by now. */
  get progress(): number {
    return 1 - this.waiting.size / this.slabs;
  }

  /** Planes up to, but without, `arrived` have their own values by now: those that had not are sent again. */
  follow(arrived: number): void {
    for (let slab = Math.floor(this.arrived / this.slabPlanes); slab * this.slabPlanes < arrived; ++slab) {
      this.waiting.add(slab);
    }
    this.arrived = arrived;
  }

  /** Sends the next planes; true once all are there. */
  uploadSlab(renderer: THREE.WebGLRenderer): boolean {
    const [width, height, depth] = this.volume.dimensions;
    const [slab] = this.waiting;
    if (slab !== undefined) {
      this.waiting.delete(slab);
      const from = slab * this.slabPlanes;
      this.uploadBox(renderer, { low: [0, 0, from], high: [width, height, Math.min(depth, from + this.slabPlanes)] });
    }
    return this.waiting.size === 0;
  }

  /** Sends the values of a box, and only those. */
  uploadBox(renderer: THREE.WebGLRenderer, box: Box): void {
    if (this.format === "r32f") {
      refill(this.source.image.data as unknown as Float32Array, this.volume, box);
    }
    copyBox(renderer, this.source, this.texture, box);
  }

  private get slabs(): number {
    return Math.ceil(this.volume.dimensions[2] / this.slabPlanes);
  }

  dispose(): void {
    this.texture.dispose();
    this.source.dispose();
  }
}

/** Copies a box of texels from an array that is never drawn itself into a texture. */
export function copyBox(
  renderer: THREE.WebGLRenderer,
  source: THREE.Data3DTexture,
  texture: THREE.Data3DTexture,
  { low, high }: Box,
): void {
  const from = new THREE.Vector3(...low);
  renderer.copyTextureToTexture(source, texture, new THREE.Box3(from, new THREE.Vector3(...high)), from);
}

/** Floats are a copy of the scan's values: those of the box are made when they are sent. */
function refill(floats: Float32Array, { values, dimensions }: ScanVolume, box: Box): void {
  forEachCell(box, dimensions, (i) => {
    floats[i] = values[i] ?? 0;
  });
}

function texelsOf(values: Uint16Array, format: FieldFormat): Uint16Array | Uint8Array | Float32Array {
  switch (format) {
    case "r16":
      return values;
    case "rg8":
      return new Uint8Array(values.buffer, values.byteOffset, values.byteLength);
    case "r32f":
      return new Float32Array(values.length);
  }
}

function textureOf(
  volume: ScanVolume,
  format: FieldFormat,
  texels: Uint16Array | Uint8Array | Float32Array | null,
): THREE.Data3DTexture {
  // the types of three know no unsigned 16-bit texels, its code does
  const texture = new THREE.Data3DTexture(texels as Uint8Array<ArrayBuffer> | null, ...volume.dimensions);
  texture.format = format === "rg8" ? THREE.RGFormat : THREE.RedFormat;
  texture.type = { r16: THREE.UnsignedShortType, rg8: THREE.UnsignedByteType, r32f: THREE.FloatType }[format];
  texture.normalized = format === "r16";
  texture.minFilter = THREE.LinearFilter;
  texture.magFilter = THREE.LinearFilter;
  texture.unpackAlignment = 1;
  return texture;
}
