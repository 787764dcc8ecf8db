/**
 * The segment of each voxel on the GPU, one byte each; edits send only their box.
 */
import type * as THREE from "three";
import type { Box, LabelVolume } from "../../core/scan/voxel_change";
import { copyBox } from "./field_texture";
import { byteTexture } from "./lookup_textures";

export class LabelTexture {
  readonly texture: THREE.Data3DTexture;
  /** The same array, never uploaded as a whole: three.js then copies boxes straight from it. */
  private readonly source: THREE.Data3DTexture;

  constructor(readonly volume: LabelVolume) {
    this.texture = byteTexture(volume.ids, volume.dimensions);
    this.source = byteTexture(volume.ids, volume.dimensions);
  }

  /** Sends the labels of a box again, and only those. */
  uploadBox(renderer: THREE.WebGLRenderer, box: Box): void {
    copyBox(renderer, this.source, this.texture, box);
  }

  dispose(): void {
    this.texture.dispose();
    this.source.dispose();
  }
}
