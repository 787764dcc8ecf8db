/**
 * The scan's values on the GPU, uploaded slab by slab so that no frame waits for all of it, and again where
 * they have arrived since.
 *
 * R16; or RG8, the same bytes as two texels of 8 bits, which the shader joins; or R32F (twice the memory); or RG8 that
 * the shader filters itself ("texels"). `march/field_filter.ts` chooses. Keep the formats in sync with
 * `shaders/scan/field.glsl`.
 */
import * as THREE from "three";
import { subtract, type Vec3 } from "../../core/geometry/vector";
import type { ScanVolume } from "../../core/scan/scan_volume";
import { forEachCell, type Box } from "../../core/scan/voxel_change";

export type FieldFormat = "r16" | "rg8" | "r32f" | "texels";

/** What shaders that read the scan are told of its format. */
export const formatDefines: Readonly<Record<FieldFormat, string>> = {
  r16: "FIELD_R16",
  rg8: "FIELD_RG8",
  r32f: "FIELD_R32F",
  texels: "FIELD_TEXELS",
};

/** Bytes sent to the GPU at once. */
const slabBytes = 8 * 2 ** 20;

export class FieldTexture {
  readonly texture: THREE.Data3DTexture;
  /** The scan's own values, of which boxes are copied; null where these are made floats first. */
  private readonly source: THREE.Data3DTexture | null;
  private readonly slabPlanes: number;
  /** Slabs that are still to be sent. */
  private readonly waiting: Set<number>;
  /** Planes, from the first on, that were told to be there. */
  private arrived = 0;

  constructor(
    readonly volume: ScanVolume,
    readonly format: FieldFormat,
  ) {
    this.source = format === "r32f" ? null : textureOf(volume.dimensions, format, texelsOf(volume.values, format));
    this.texture = textureOf(volume.dimensions, format, null);
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
    if (this.source !== null) {
      copyBox(renderer, this.source, this.texture, box);
      return;
    }
    const [size, floats] = floatsOf(this.volume, box);
    const source = textureOf(size, this.format, floats);
    copyBox(renderer, source, this.texture, { low: [0, 0, 0], high: size }, box.low);
    source.dispose();
  }

  private get slabs(): number {
    return Math.ceil(this.volume.dimensions[2] / this.slabPlanes);
  }

  dispose(): void {
    this.texture.dispose();
    this.source?.dispose();
  }
}

/** Copies a box of texels from an array that is never drawn itself into a texture, there or elsewhere. */
export function copyBox(
  renderer: THREE.WebGLRenderer,
  source: THREE.Data3DTexture,
  texture: THREE.Data3DTexture,
  { low, high }: Box,
  to: Vec3 = low,
): void {
  const box = new THREE.Box3(new THREE.Vector3(...low), new THREE.Vector3(...high));
  renderer.copyTextureToTexture(source, texture, box, new THREE.Vector3(...to));
}

/** The size of a box, and its values, x fastest: no whole copy of the scan is held for them. */
function floatsOf({ values, dimensions }: ScanVolume, box: Box): readonly [Vec3, Float32Array] {
  const size = subtract(box.high, box.low);
  const floats = new Float32Array(size[0] * size[1] * size[2]);
  let next = 0;
  forEachCell(box, dimensions, (i) => {
    floats[next++] = values[i] ?? 0;
  });
  return [size, floats];
}

function texelsOf(values: Uint16Array, format: "r16" | "rg8" | "texels"): Uint16Array | Uint8Array {
  return format === "r16" ? values : new Uint8Array(values.buffer, values.byteOffset, values.byteLength);
}

function textureOf(
  dimensions: Vec3,
  format: FieldFormat,
  texels: Uint16Array | Uint8Array | Float32Array | null,
): THREE.Data3DTexture {
  // the types of three know no unsigned 16-bit texels, its code does
  const texture = new THREE.Data3DTexture(texels as Uint8Array<ArrayBuffer> | null, ...dimensions);
  const filter = format === "texels" ? THREE.NearestFilter : THREE.LinearFilter;
  texture.format = format === "rg8" || format === "texels" ? THREE.RGFormat : THREE.RedFormat;
  texture.type = typeOf[format];
  texture.normalized = format === "r16";
  texture.minFilter = filter;
  texture.magFilter = filter;
  texture.unpackAlignment = 1;
  return texture;
}

const typeOf: Readonly<Record<FieldFormat, THREE.TextureDataType>> = {
  r16: THREE.UnsignedShortType,
  rg8: THREE.UnsignedByteType,
  r32f: THREE.FloatType,
  texels: THREE.UnsignedByteType,
};
